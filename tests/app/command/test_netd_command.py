"""``imagechain netd``: frames that numpy has drawn, and those of a simulated camera."""

import json

import numpy as np
import pytest

SITF, OFFSET, SIGMA = 50.0, -12_000.0, 3.0
ROWS, COLUMNS = 48, 64


def frames(kelvin, seed, count=40):
    random = np.random.default_rng(seed)
    shape = (count, ROWS, COLUMNS)
    rows = 1.5 * random.standard_normal((count, ROWS, 1))
    numbers = SITF * kelvin + OFFSET + SIGMA * random.standard_normal(shape) + rows
    numbers[:, 5, 7] = 15_000  # a pixel that is stuck
    return np.rint(numbers).astype(np.uint16)


@pytest.fixture
def fields(tmp_path):
    for name, kelvin, seed in (("cold", 293.15, 1), ("middle", 298.15, 2), ("hot", 303.15, 3)):
        np.save(tmp_path / f"{name}.npy", frames(kelvin, seed))
    np.save(tmp_path / "small.npy", np.ones((3, 20, 20)))
    random = np.random.default_rng(7)
    np.save(tmp_path / "huge.npy", 1e200 * random.standard_normal((3, ROWS, COLUMNS)))
    np.save(tmp_path / "same.npy", np.repeat(frames(300.0, 4)[:1], 5, axis=0))
    np.save(tmp_path / "full.npy", np.minimum(frames(310.0, 5), 3502))
    return tmp_path


def test_sitf_netd_and_components(works, fields):
    """σ_tvh and rounding, √(9 + 1/12), over 50 numbers of a kelvin; known to 1/√(2·120,000)."""
    done = works(
        "netd", "hot.npy=303.15K", "cold.npy=20C", "middle.npy=25°C",
        "--output", "n.json", "--output", "n.csv",
    )  # fmt: skip
    facts = json.loads((fields / "n.json").read_text())
    figures = facts["figures"]
    netd = (SIGMA**2 + 1 / 12) ** 0.5 / SITF
    assert figures["temperature_K"] == 298.15
    assert figures["sitf"] == pytest.approx(SITF, abs=4 * figures["sitf_error"])
    assert figures["sitf_error"] < 0.002 * SITF
    assert figures["netd_K"] == pytest.approx(netd, abs=4 * figures["netd_error_K"])
    assert figures["temporal_K"] == pytest.approx((netd**2 + 0.03**2) ** 0.5, rel=0.01)
    assert [level["temperature_K"] for level in facts["levels"]] == [293.15, 298.15, 303.15]
    assert [level["file"] for level in facts["levels"]] == ["cold.npy", "middle.npy", "hot.npy"]
    for level in facts["levels"]:
        assert level["sigma_tv_K"] == pytest.approx(0.03, rel=0.1)
        assert level["bad_pixels"] == 1
        assert abs(level["sigma_vh_K"]) < 0.01
    assert f"netd_K,{figures['netd_K']!r},K," in (fields / "n.csv").read_text()
    assert "1 bad pixel is left out" in done.stdout
    assert "netd_K" in done.stdout


def test_the_camera_that_is_simulated_has_the_netd_it_predicts(works, tmp_path):
    """Focal Plane's own NETD, of the photons of a black body; σ is known to 0.5 %."""
    words, predicted = [], {}
    for number, kelvin in enumerate((290.15, 293.15, 296.15)):
        works(
            "run", "mwir_camera", "--set", "scene.kind=uniform", "--set", "scene.width=64",
            "--set", "scene.height=64", "--set", "camera.pixels_x=32",
            "--set", "camera.pixels_y=32",
            "--set", f"scene.temperature_K={kelvin}", "--frames", 24, "--seed", number,
            "--save", f"focal_plane.image=f{number}.tif", "--output-dir", f"o{number}",
        )  # fmt: skip
        readouts = json.loads((tmp_path / f"o{number}" / "readouts.json").read_text())
        predicted[kelvin] = readouts["focal_plane"]["netd_K"]
        words.append(f"f{number}.tif={kelvin}K")
    works("netd", *words, "--output", "n.json")
    levels = json.loads((tmp_path / "n.json").read_text())["levels"]
    for level in levels:
        expected = predicted[level["temperature_K"]]
        assert level["netd_K"] == pytest.approx(expected, abs=4 * level["netd_error_K"])
        assert level["netd_error_K"] < 0.006 * expected


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("huge.npy=3K", "hot.npy=9K"),
         "huge.npy: the samples are too large for their variance to be computed"),
        (("hot.npy=300K", "small.npy=310K"),
         "small.npy: contains frames of 20 × 20 samples, but hot.npy has 48 × 64: give files "
         "from the same camera"),
        (("hot.npy=300", "cold.npy=20C"),
         "netd 'hot.npy=300' is not allowed: must be a file and the temperature of its "
         "black body, such as FILE=293.15K or FILE=20C"),
        (("hot.npy=-300C",), "netd 'hot.npy=-300C': -26.85 K is not a possible temperature; "
         "allowed: above 0 K and up to 10000 K"),
        (("hot.npy=300K", "same.npy=290K"),
         "same.npy: all frames are the same. The field is saturated, rounding hides the noise, or "
         "the file repeats one frame"),
    ],
)  # fmt: skip
def test_what_is_refused(imagechain, fields, words, line):
    done = imagechain("netd", *words)
    assert (done.returncode, done.stderr) == (2, f"imagechain: {line}\n")


def test_a_saturated_field_is_refused(fails, fields):
    line = fails("netd", "full.npy=310K", "cold.npy=293K")
    assert "full.npy: " in line
    assert "samples are 3502. The field is saturated" in line
