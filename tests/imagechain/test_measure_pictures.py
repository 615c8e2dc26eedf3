"""`ic.measure`: arrays and files, as the command measures them."""

import json
import math

import numpy as np
import pytest

import imagechain as ic
from edge_truth import gaussian_edge

SIGMA = 0.9
MTF50 = math.sqrt(math.log(2.0) / 2.0) / math.pi / SIGMA


def edge(seed):
    return gaussian_edge(
        angle_deg=5.73, sigma=(SIGMA, SIGMA), shape=(100, 120), levels=(60.0, 100.0), points=1,
        middle=(60.2, 50.0), noise=0.2, seed=seed,
    )  # fmt: skip


def test_arrays_and_files(tmp_path):
    frames = np.stack([edge(1), edge(2)])
    measured = ic.measure(frames, fov_x_deg=1.0)
    assert measured.x.mtf50 == pytest.approx(MTF50, abs=4.0 * measured.x.mtf50_sigma)
    assert (measured.y, measured.x.edges) == (None, 2)
    assert "vertical" in measured.reason_y
    assert measured.noise.sigma == pytest.approx(0.2, rel=0.03)
    assert "mtf50_x" in repr(measured)
    on_detector = ic.measure(frames, pitch_um=10.0).to_dict()["mtf"]["x"]
    per_mm = np.array(on_detector["frequency_cyc_per_mm"])
    assert per_mm == pytest.approx(100.0 * np.array(on_detector["frequency_cyc_per_sample"]))
    np.save(tmp_path / "frames.npy", frames)
    of_file = ic.measure(tmp_path / "frames.npy", fov_x_deg=1.0)
    assert of_file.to_dict()["mtf"] == measured.to_dict()["mtf"]
    measured.save(tmp_path / "m.json")
    assert json.loads((tmp_path / "m.json").read_text()) == measured.to_dict()
    fewer = measured.without(0)
    assert fewer.x.edges == 1
    assert fewer.edges[0].why_not == "removed by you"
    assert measured.x.edges == 2
    with pytest.raises(ic.ParameterError, match="edge = 7"):
        measured.without(7)
    with pytest.raises(ic.UsageError, match=r"must end in \.json, \.csv or \.html"):
        measured.save(tmp_path / "m.txt")


def test_what_is_no_picture():
    with pytest.raises(ic.UsageError, match="needs a picture"):
        ic.measure()
    with pytest.raises(ic.DataError, match="picture 1 is an array of complex128"):
        ic.measure(np.zeros((20, 20), complex))
    with pytest.raises(ic.DataError, match=r"array 2 has .* but array 1 has"):
        ic.measure(np.zeros((20, 20)), np.zeros((20, 30)))
    with pytest.raises(ic.UsageError, match="apply to files only"):
        ic.measure(np.zeros((20, 20)), band=1)


def test_whole_numbers_have_ends_at_which_they_are_clipped():
    """As those of a file do: an edge whose bright side is all 255 shows no blur."""
    clipped = np.clip(np.rint(4.0 * edge(3) - 60.0), 0, 255).astype(np.uint8)
    measured = ic.measure(clipped)
    assert measured.x is None
    assert measured.edges[0].why_not.startswith("clipped: ")
