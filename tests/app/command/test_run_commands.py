"""Commands on a network whose parameters follow others: as if the numbers were written out."""

import json

import numpy as np
import pytest

from app.run.shipped import find_network
from core.editing.macros import expose, group
from core.network.file import load_network, save_network
from nodes.library import standard_library

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


# --- networks with macros ---

LIBRARY = standard_library()
MEMBERS = ("init", "pupil", "optics", "aberration", "detector", "charge", "charge_phase", "back")


@pytest.fixture
def networks(tmp_path):
    """The KIR-310 on a small scene, plain and with its camera as one node; the file names."""
    network = load_network(find_network("kodak_kir310").path, library=LIBRARY)
    for side in ("width", "height"):
        network = network.with_parameter("scene", side, 64)
    save_network(network, tmp_path / "plain.json", library=LIBRARY)
    members = (*MEMBERS, "pixels", "electronics", "frame_grabber")
    network = group(network, LIBRARY, members, "camera")[1].apply(network)
    network = expose(network, "camera/init", "f_number").apply(network)
    save_network(network, tmp_path / "grouped.json", library=LIBRARY)
    return "plain.json", "grouped.json"


@pytest.mark.parametrize("given", ["camera.f_number=3", "camera/init.f_number=3"])
def test_a_run_gives_the_same_picture_and_figures(given, networks, imagechain, tmp_path):
    plain, grouped = networks
    inner = "init.f_number=3"
    one = imagechain(
        *("run", plain, "--set", inner, "--save", "frame_grabber.image=one.npy"),
        *("--output-dir", "a"),
    )
    other = imagechain(
        *("run", grouped, "--set", given, "--save", "camera.image=other.npy"),
        *("--save", "camera/frame_grabber.image=third.npy", "--output-dir", "b"),
    )
    assert (one.returncode, other.returncode) == (0, 0), other.stderr
    first = np.load(tmp_path / "one.npy")
    assert np.array_equal(first, np.load(tmp_path / "other.npy"))
    assert np.array_equal(first, np.load(tmp_path / "third.npy"))
    assert (tmp_path / "a/final.png").read_bytes() == (tmp_path / "b/final.png").read_bytes()
    figures, others = (json.loads((tmp_path / each / "readouts.json").read_text()) for each in "ab")
    assert {name.removeprefix("camera/"): value for name, value in others.items()} == figures | {
        key: value for key, value in others.items() if key == "imagechain.warnings"
    }


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            "camera.f_numbr=2",
            "the macro has no such parameter on its panel; did you mean f_number?",
        ),
        ("camera/init.f_numbr=2", "Init & Trans has no parameter f_numbr; did you mean f_number?"),
        (
            "camera.f_number=-2",
            "camera/init: f_number = -2 is not allowed: must be a number of at least 0",
        ),
    ],
)
def test_bad_settings(given, message, networks, fails):
    assert message in fails("run", networks[1], "--set", given)


# --- which picture is the output ---

LINE = (
    "this network ends in 2 pictures (pixels.image, noisy.image) and none is marked as the output: "
    "select the node whose picture is the output and press O, or give --final NODE.PORT"
)


def test_run_does_not_choose_among_two(two, write, works, tmp_path):
    write(two)
    done = works("run", "net.json", "--output-dir", "out", "--save", "noisy.image=noisy.npy")
    assert f"no final.png: {LINE}" in done.stdout.splitlines()
    assert "no total MTF in mtf.csv: this network ends in 2 pictures" in done.stdout
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {"mtf.csv", "readouts.json"}
    assert (tmp_path / "noisy.npy").is_file()


def test_final_on_the_command_line(two, write, imagechain, works, tmp_path):
    write(two)
    done = works("run", "net.json", "--final", "pixels.image", "--output-dir", "one")
    assert "total" not in done.stdout
    assert "total.mtf_x" in (tmp_path / "one" / "mtf.csv").read_text()
    done = works("run", "net.json", "--final", "noisy.image", "--output-dir", "other")
    told = "no total MTF in mtf.csv: no Back Transform comes before the output, noisy.image"
    assert told in done.stdout.splitlines()
    assert "total.mtf_x" not in (tmp_path / "other" / "mtf.csv").read_text()
    shapes = [(tmp_path / name / "final.png").read_bytes()[16:24] for name in ("one", "other")]
    assert [int.from_bytes(s[:4]) for s in shapes] == [24, 16]  # columns, from the PNG's header
    assert imagechain("check", "net.json", "--final", "noisy.image").returncode == 0


@pytest.mark.parametrize(
    ("port", "told"),
    [
        ("noisy.imag", "noisy has no picture imag; did you mean image?"),
        ("init.context", "init has no picture context; its pictures: none"),
    ],
)
def test_a_wrong_final_is_one_line(two, write, fails, port, told):
    write(two)
    line = fails("run", "net.json", "--final", port)
    assert line.startswith(f"imagechain: --final {port}: ")
    assert told in line
