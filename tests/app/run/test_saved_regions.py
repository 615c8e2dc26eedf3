"""``--save NODE.PORT[TOP:BOTTOM,LEFT:RIGHT]=FILE``: rows and columns of an image."""

import json

import numpy as np
import pytest

ROWS, COLUMNS = 40, 48
BOUNDS = {
    "5:21,8:19": (slice(5, 21), slice(8, 19)),
    ":21,8:": (slice(0, 21), slice(8, COLUMNS)),
    "39:,:1": (slice(39, ROWS), slice(0, 1)),
    "007:9,00:48": (slice(7, 9), slice(None)),
}
FORM = (
    "must be NODE.PORT[TOP:BOTTOM,LEFT:RIGHT]=FILE, where each bound is a whole number or left out"
)
FAULTS = {
    "beyond right": (
        "back.image[:,40:49]=a.npy",
        "--save back.image[:,40:49]=a.npy: the region exceeds the picture, which has 40 rows",
    ),
    "of the smaller picture": ("pixels.image[0:21,:]=a.npy", "has 20 rows and 24 columns"),
    "no columns": ("back.image[:,48:]=a.npy", "the region is empty: rows 0:40, columns 48:48"),
    "negative": ("back.image[-3:,:]=a.npy", FORM),
    "a step": ("back.image[0:9:2,:]=a.npy", FORM),
    "too many digits": (f"back.image[{'9' * 5000}:,:]=a.npy", FORM),
    "no image": (
        "init.magnitude[:,:]=a.npy",
        "--save init.magnitude[:,:]=a.npy: a region needs an image, not a magnitude",
    ),
    "no such port": ("back.imag[0:9,:]=a.npy", "mean image?"),
    "one file twice": ("back.image[0:9,:]=./b.npy", "two outputs"),
}


@pytest.fixture(autouse=True)
def _network(write, small):
    write(small)


def test_is_the_crop_of_the_whole(works, tmp_path):
    port = "back.image"
    words = ["run", "net.json", "--save", f"{port}=whole.npy"]
    for number, bounds in enumerate(BOUNDS):
        words += ["--save", f"{port}[{bounds}]={number}.npy"]
    done = works(*words)
    assert "also whole.npy, 0.npy, 1.npy" in done.stdout
    works("run", "net.json", "--save", f"{port}[5:21,8:19]=alone.npy")
    whole = np.load(tmp_path / "whole.npy")
    assert whole.shape == (ROWS, COLUMNS)
    for number, slices in enumerate(BOUNDS.values()):
        np.testing.assert_array_equal(np.load(tmp_path / f"{number}.npy"), whole[slices])
    np.testing.assert_array_equal(np.load(tmp_path / "alone.npy"), whole[5:21, 8:19])


@pytest.mark.parametrize(("save", "told"), FAULTS.values(), ids=FAULTS.keys())
def test_faults(save, told, fails):
    assert told in fails("run", "net.json", "--save", "pixels.image=b.npy", "--save", save)


def test_the_report_tells_what_a_region_saved(imagechain, tmp_path):
    words = ["--save", "back.image[3:8,12:36]=a.npy", "--report", "r.json", "--report", "r.html"]
    imagechain("run", "net.json", *words)
    report = json.loads((tmp_path / "r.json").read_text())
    (fact,) = [each for each in report["skipped"]["back"] if each["kind"] == "region"]
    assert fact["share"] == pytest.approx(0.5 + 0.5 * 24 / 48)
    page = (tmp_path / "r.html").read_text()
    assert "pictures outside a region" in page
    assert "back (75 % computed)" in page
    imagechain("run", "net.json", "--save", "pixels.image[3:8,12:24]=a.npy", *words[2:4])
    report = json.loads((tmp_path / "r.json").read_text())
    (fact,) = [each for each in report["skipped"]["back"] if each["kind"] == "region"]
    assert fact["share"] == 1  # the final picture is made whole in any case
