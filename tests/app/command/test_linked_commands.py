"""Commands on a network whose parameters follow others: as if the numbers were written out."""

import json

import numpy as np
import pytest

LINKED = {"expression": "jitter.sigma_mrad * 2.5"}


@pytest.fixture
def linked(small):
    """Sigma across is 2.5 × 0.2 = 0.5 as in the network with plain values."""
    small["version"] = 2
    small["nodes"]["blur"]["params"]["sigma_x_mrad"] = LINKED
    return small


def test_a_run_gives_the_bits_of_the_values(works, write, small, linked, tmp_path):
    plain = json.loads(json.dumps(small))
    plain["nodes"]["blur"]["params"]["sigma_x_mrad"] = 0.5
    for name, document in (("plain", plain), ("linked", linked)):
        works("run", write(document, f"{name}.json"), "--save", f"back.image={name}.npy")
    assert np.array_equal(np.load(tmp_path / "plain.npy"), np.load(tmp_path / "linked.npy"))


def test_a_set_value_is_followed_and_a_set_expression_follows(works, write, linked, tmp_path):
    def readouts(*words):
        works("run", write(linked), "--output-dir", "out", *words)
        return json.loads((tmp_path / "out" / "readouts.json").read_text())["blur"]

    plain = json.loads(json.dumps(linked))
    plain["nodes"]["blur"]["params"]["sigma_x_mrad"] = 1.0
    plain["nodes"]["jitter"]["params"]["sigma_mrad"] = 0.4
    works("run", write(plain, "plain.json"), "--output-dir", "plain")
    expected = json.loads((tmp_path / "plain" / "readouts.json").read_text())["blur"]
    assert readouts("--set", "jitter.sigma_mrad=0.4") == expected
    words = ("--set", "jitter.sigma_mrad=0.4", "--set", "blur.sigma_x_mrad== jitter.sigma_mrad+0.6")
    assert readouts(*words) == expected


def test_a_varied_parameter_takes_its_followers_along(works, write, linked, tmp_path):
    def figures(document, values):
        words = ("--vary", f"jitter.sigma_mrad={values}", "--figure", "total.mtf_nyquist_x")
        works("tradeoff", write(document), *words, "--output", "t.json")
        points = json.loads((tmp_path / "t.json").read_text())["curves"][0]["points"]
        return [point["figures"]["total.mtf_nyquist_x"] for point in points]

    expected = []
    for sigma_mrad in (0.1, 0.15):
        plain = json.loads(json.dumps(linked))
        plain["nodes"]["blur"]["params"]["sigma_x_mrad"] = 2.5 * sigma_mrad
        expected += figures(plain, str(sigma_mrad))
    assert figures(linked, "0.1,0.15") == pytest.approx(expected, rel=1e-12)
