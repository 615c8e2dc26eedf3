"""``imagechain photon-transfer``: files of numpy's frames, and of a simulated camera's."""

import json

import numpy as np
import pytest
from PIL import Image as Pillow

from picture_samples import envi

GAIN, READ_E, WELL_E, OFFSET = 3.0, 20.0, 30_000.0, 150.0
LEVELS = (1000, 4000, 8000, 14_000, 20_000, 60_000)


def frames(electrons, seed, count=30):
    random = np.random.default_rng(seed)
    n = random.poisson(electrons, (count, 60, 80)) + READ_E * random.standard_normal(
        (count, 60, 80)
    )
    return np.clip(np.rint(np.minimum(n, WELL_E) / GAIN + OFFSET), 0, 65535).astype(np.uint16)


@pytest.fixture
def flats(tmp_path):
    """A file of each kind for the levels, and one in the dark."""
    names = []
    for number, level in enumerate(LEVELS):
        made, name = frames(level, number), f"flat{number}"
        if number % 3 == 0:
            np.save(tmp_path / f"{name}.npy", made)
            names.append(f"{name}.npy")
        elif number % 3 == 1:
            first, *others = (Pillow.fromarray(one) for one in made)
            first.save(tmp_path / f"{name}.tif", save_all=True, append_images=others)
            names.append(f"{name}.tif")
        else:
            envi(tmp_path / f"{name}.bsq", made.transpose(1, 2, 0), "bsq")
            names.append(f"{name}.bsq")
    np.save(tmp_path / "dark.npy", frames(0, 77))
    return names


def test_gain_read_noise_and_full_well(works, flats, tmp_path):
    words = ("--dark", "dark.npy", "--output", "p.json", "--output", "p.csv")
    done = works("photon-transfer", *flats, *words)
    facts = json.loads((tmp_path / "p.json").read_text())
    figures = facts["figures"]
    assert figures["gain_e_per_dn"] == pytest.approx(GAIN, rel=0.02)
    assert figures["read_noise_e"] == pytest.approx(READ_E, rel=0.02)
    assert figures["full_well_e"] == pytest.approx(WELL_E, rel=0.02)
    assert figures["offset_dn"] == pytest.approx(OFFSET, abs=0.2)
    assert [level["saturated"] for level in facts["levels"]] == [*[False] * 5, True]
    assert f"gain_e_per_dn,{figures['gain_e_per_dn']!r},e-/DN," in (tmp_path / "p.csv").read_text()
    assert "gain_e_per_dn" in done.stdout
    assert "saturated" in done.stdout


def test_frames_of_a_simulated_camera(works, small, write, tmp_path):
    """Focal Plane's own gain, read noise, well and patterns, through multi-page TIFFs."""
    small["nodes"]["scene"]["params"] |= {
        "kind": "uniform", "cut_on_um": 3.7, "cut_off_um": 4.8, "width": 80, "height": 60,
    }  # fmt: skip
    small["nodes"]["init"]["params"] |= {
        "detector_x_um": 15.0, "detector_y_um": 15.0, "f_number": 4.0, "platform": "array",
    }  # fmt: skip
    camera = {
        "read_noise_e": 300.0, "full_well_e": 1e6, "gain_e_per_dn": 80.0, "bits": 14,
        "offset_dn": 100.0, "prnu_percent": 0.5, "dsnu_e": 200.0, "bad_pixel_percent": 0.3,
    }  # fmt: skip
    small["nodes"]["camera"] = {"module": "focal_plane", "params": camera}
    small["links"] += [["init.context", "camera.context"], ["scene.image", "camera.image"]]
    net, files = write(small), []
    for number, seconds in enumerate((1e-9, 1e-4, 5e-4, 1e-3, 2e-3, 4e-3, 2e-2)):
        # A frame's noise goes by its number: another seed gives others; patterns go with it too.
        works(
            "run", net, "--frames", 40, "--set", f"camera.integration_time_s={seconds}",
            "--seed", number, "--save", f"camera.image=f{number}.tif",
        )  # fmt: skip
        files.append(f"f{number}.tif")
    works("photon-transfer", *files[1:], "--dark", files[0], "--output", "p.json")
    figures = json.loads((tmp_path / "p.json").read_text())["figures"]
    assert figures["gain_e_per_dn"] == pytest.approx(80.0, rel=0.02)
    assert figures["read_noise_e"] == pytest.approx(300.0, rel=0.02)
    assert figures["full_well_e"] == pytest.approx(1e6, rel=0.02)
    assert figures["prnu_percent"] == pytest.approx(0.5, rel=0.1)
    assert figures["dsnu_e"] == pytest.approx(200.0, rel=0.1)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("one.npy", "dark.npy"), "one.npy: contains a single frame; a flat field needs 2 or more"),
        (
            ("flat0.npy", "other.npy"),
            "other.npy: contains frames of 5 × 6 samples, but flat0.npy has 60 × 80: give files "
            "from the same camera",
        ),
        (
            ("flat0.npy", "--offset-dn", "much"),
            "--offset-dn 'much' is not allowed: must be a number",
        ),
        (
            ("flat0.npy",),
            "levels below 0.7 times saturation: 1 of 1. A photon transfer curve needs 2 or more "
            "different signal levels, or one level and dark frames that are not clipped at "
            "zero",
        ),
    ],
)  # fmt: skip
def test_what_is_refused(imagechain, flats, tmp_path, words, line):
    np.save(tmp_path / "one.npy", np.zeros((60, 80)))
    np.save(tmp_path / "other.npy", np.zeros((3, 5, 6)))
    done = imagechain("photon-transfer", *words)
    assert (done.returncode, done.stderr) == (2, f"imagechain: {line}\n")
