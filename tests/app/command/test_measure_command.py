"""``imagechain measure``: pictures of known edges and noise, and what cannot be measured."""

import json
import math

import numpy as np
import pytest
from PIL import Image as Pillow

from edge_truth import gaussian_edge

SIGMA_X, SIGMA_Y, NOISE, LOW, STEP = 0.8, 1.1, 0.4, 100.0, 60.0
MTF50 = math.sqrt(math.log(2.0) / 2.0) / math.pi  # of a Gaussian, times its sigma


def edge(angle_deg, sigma, seed, shape=(160, 200)):
    """An edge of Gaussian blur, in closed form, with white noise; its normal at that angle."""
    middle, levels = (shape[1] / 2 - 0.3, shape[0] / 2), (LOW, LOW + STEP)
    return gaussian_edge(
        angle_deg=angle_deg, sigma=(sigma, sigma), shape=shape, levels=levels, points=1,
        middle=middle, noise=NOISE, seed=seed,
    )  # fmt: skip


def gaussian(frequency, sigma):
    return np.exp(-2.0 * (np.pi * sigma * np.asarray(frequency)) ** 2)


@pytest.fixture
def pictures(tmp_path):
    """One with an edge across, one along, of one camera, as double and as single precision."""
    np.save(tmp_path / "across.npy", edge(6.0, SIGMA_X, 1))
    picture = Pillow.fromarray(edge(84.0, SIGMA_Y, 2).astype(np.float32))
    picture.save(tmp_path / "along.tif")
    return "across.npy", "along.tif"


def test_mtf_and_noise_of_known_pictures(works, pictures, tmp_path):
    words = ("--json", "m.json", "--csv", "mtf.csv", "--fov-x-deg", "2")
    done = works("measure", *pictures, *words)
    facts = json.loads((tmp_path / "m.json").read_text())
    for direction, sigma in (("x", SIGMA_X), ("y", SIGMA_Y)):
        curve = facts["mtf"][direction]
        frequency = np.array(curve["frequency_cyc_per_sample"])
        low = frequency <= 0.4
        # Along the normal of an edge 6° aside: the blur is round, so that it is that of the axis.
        truth = gaussian(frequency, sigma)
        away = np.abs(np.array(curve["mtf"]) - truth)[low]
        assert np.all(away <= 4.0 * np.array(curve["sigma"])[low] + 0.002)
        assert curve["mtf50"] == pytest.approx(MTF50 / sigma, abs=4.0 * curve["mtf50_sigma"])
        mrad = curve["frequency_cyc_per_mrad"][-1] / curve["frequency_cyc_per_sample"][-1]
        assert mrad == pytest.approx(200 / (2000.0 * math.tan(math.radians(1.0))), rel=1e-3)
    noise = facts["noise"]
    assert noise["sigma"] == pytest.approx(NOISE, rel=0.03)
    assert noise["reason"]
    assert noise["levels"]
    used = [one for one in facts["edges"] if one["used"]]
    assert {one["picture"] for one in used} == {0, 1}
    assert {round(one["angle_deg"]) for one in used} == {6, 84}
    assert all(one["sigma"] > 0.0 and one["why_not"] == "" for one in used)
    assert "mtf50_x" in done.stdout


def test_units_of_the_detector_and_the_mtf_at_nyquist(fails, works, pictures, tmp_path):
    """0.5 cycles/sample of a pitch of 15 µm are 33.3 cycles/mm; a Gaussian in closed form there."""
    done = works("measure", *pictures, "--pitch-um", "15", "--json", "m.json")
    facts = json.loads((tmp_path / "m.json").read_text())
    assert facts["pitch_um"] == 15.0
    rows = [line.split() for line in done.stdout.splitlines()]
    for direction, sigma in (("x", SIGMA_X), ("y", SIGMA_Y)):
        curve = facts["mtf"][direction]
        per_mm = np.array(curve["frequency_cyc_per_mm"])
        assert per_mm == pytest.approx(np.array(curve["frequency_cyc_per_sample"]) / 0.5 * 33.33333)
        [row] = [row for row in rows if row[0] == f"mtf50_{direction}" and "cyc/mm" in row]
        assert float(row[1]) == pytest.approx(MTF50 / sigma / 0.015, abs=4.0 * float(row[3]))
        [row] = [row for row in rows if row[0] == f"mtf_nyquist_{direction}"]
        assert float(row[1]) == pytest.approx(gaussian(0.5, sigma), abs=4.0 * float(row[3]) + 0.001)
    line = fails("measure", *pictures, "--pitch-um", "0")
    assert (
        line
        == "imagechain: --pitch-um = 0.0 µm is not allowed: must be above 0 and at most 10000\n"
    )


def test_the_module_mtf_file_reads_the_table(works, pictures, small, write, tmp_path):
    works("measure", *pictures, "--csv", "mtf.csv")
    small["nodes"]["init"]["params"] |= {"detector_x_um": 20.0, "detector_y_um": 20.0}
    small["nodes"]["blur"] = {"module": "mtf_file", "params": {"path": "mtf.csv"}}
    works("run", write(small), "--save", "blur.mtf=h.npy", "--precision", "double")
    made = np.load(tmp_path / "h.npy")
    # 100 mm of focal length over 20 µm are 5 cycles/mrad for each a pixel; 48 samples in 3°, 40
    # in 2.5°. The tail of a spread leaves a standard error of 0.018; unlike blurs are not to mix.
    for values, degrees, sigma in ((made[0], 3.0, SIGMA_X), (made[:, 0], 2.5, SIGMA_Y)):
        mrad = 1000.0 * math.radians(degrees) / len(values)
        frequency = np.abs(np.fft.fftfreq(len(values), mrad)) / 5.0
        assert values == pytest.approx(gaussian(frequency, sigma), abs=0.03)


def test_frames_of_one_scene_give_gain_and_components_and_others_do_not(imagechain, tmp_path):
    random = np.random.default_rng(6)
    electrons = 20.0 * edge(6.0, SIGMA_X, 0, (96, 120)) * random.uniform(0.5, 1.0, (96, 120))
    drawn = [random.poisson(electrons) for _ in range(16)]
    still = [frame + 15.0 * random.standard_normal((96, 120)) for frame in drawn]
    np.save(tmp_path / "still.npy", np.rint(np.stack(still) / 4.0).astype(np.uint16))
    moved = [edge(6.0, SIGMA_X, 9, (64, 80)), edge(84.0, SIGMA_X, 10, (64, 80))]
    np.save(tmp_path / "moved.npy", np.stack(moved))
    assert imagechain("measure", "still.npy", "--json", "s.json").returncode == 0
    facts = json.loads((tmp_path / "s.json").read_text())
    truth = math.sqrt((electrons.mean() + 15.0**2) / 4.0**2 + 1.0 / 12.0)
    assert facts["frames"]["sigma_tvh"] == pytest.approx(truth, rel=0.03)
    assert facts["noise"]["sigma"] == pytest.approx(truth, rel=0.03)
    error = facts["noise"]["gain_error"]
    assert facts["noise"]["gain_e_per_dn"] == pytest.approx(4.0, abs=4.0 * error)
    assert imagechain("measure", "moved.npy", "--json", "m.json").returncode == 0
    assert (
        "the scene or the camera moved"
        in json.loads((tmp_path / "m.json").read_text())["frames"]["reason"]
    )


def test_a_picture_without_an_edge_says_so(fails, works, tmp_path):
    flat = LOW + NOISE * np.random.default_rng(4).standard_normal((120, 120))
    np.save(tmp_path / "flat.npy", flat)
    done = works("measure", "flat.npy", "--json", "m.json")
    facts = json.loads((tmp_path / "m.json").read_text())
    assert set(facts["mtf"]["x"]) == set(facts["mtf"]["y"]) == {"reason"}
    assert not any(one["used"] for one in facts["edges"])
    assert facts["noise"]["sigma"] == pytest.approx(NOISE, rel=0.03)
    assert "no horizontal MTF: " in done.stdout
    line = fails("measure", "flat.npy", "--json", "n.json", "--csv", "n.csv")
    assert line.startswith("imagechain: there is no MTF to write (horizontal: ")
    assert not (tmp_path / "n.json").exists()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("a.npy", "b.npy"),
         "b.npy has 20 × 30 samples, but a.npy has 200 × 160. Give pictures from one camera"),
        (("whole.npy", "bytes.npy"),
         "bytes.npy stores whole numbers from 0 to 255, but whole.npy from 0 to 65535. Give "
         "pictures from one camera, stored the same way"),
        (("nan.npy",), "nan.npy: 1 sample is not finite (NaN or infinite), the first (nan)"
         " at row 3, column 4; replace these samples with one number, such as 0; constant areas "
         "are not measured"),
        (("far.npy",), "far.npy: samples from 0 to 1e+300 cannot be measured. Scale the samples: "
         "no sample may exceed ±1e+60, and their range must be at least 1e-60"),
        (("a.npy", "--dark", "light.npy"), "a.npy: the mean level, 130, is not above the dark "
         "level, 500. Check the dark frames (--dark) or the dark level (--offset-dn)"),
        (("a.npy", "--dark", "small.npy"),
         "small.npy has 20 × 9 samples, but a.npy has 200 × 160. Give frames from one camera"),
    ],
)  # fmt: skip
def test_what_is_refused(imagechain, tmp_path, words, line):
    a = edge(6.0, SIGMA_X, 1)
    np.save(tmp_path / "a.npy", a + 130.0 - a.mean())
    np.save(tmp_path / "light.npy", np.full((2, *a.shape), 500.0))
    np.save(tmp_path / "b.npy", np.zeros((30, 20)))
    for name, kind in (("whole", np.uint16), ("bytes", np.uint8)):
        np.save(tmp_path / f"{name}.npy", np.rint(edge(6.0, SIGMA_X, 1)).astype(kind))
    np.save(tmp_path / "small.npy", np.zeros((9, 20)))
    bad = np.zeros((30, 20))
    bad[3, 4] = 1e300
    np.save(tmp_path / "far.npy", bad)
    bad[3, 4] = np.nan
    np.save(tmp_path / "nan.npy", bad)
    done = imagechain("measure", *words)
    assert (done.returncode, done.stderr) == (2, f"imagechain: {line}\n")
    assert not (tmp_path / "a.npy.json").exists()
