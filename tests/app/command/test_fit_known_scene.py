"""``imagechain fit --known-scene``: spots in closed form, blurred, moved and scaled."""

import json

import numpy as np
import pytest

from edge_truth import blur_network

SIZE = 96


def spots(*, blur=(0.0, 0.0), shift=(0.0, 0.0), scale=1.0, seed=4):
    """Gaussian spots, with what a Gaussian blur in samples of the picture makes of them."""
    rng = np.random.default_rng(seed)
    middle = (SIZE - 1) / 2
    y, x = np.mgrid[0:SIZE, 0:SIZE].astype(float)
    total = np.zeros((SIZE, SIZE))
    for cx, cy, width, height in zip(
        rng.uniform(15, 80, 7), rng.uniform(15, 80, 7), rng.uniform(1.6, 2.5, 7),
        rng.uniform(0.5, 2.0, 7), strict=True,
    ):  # fmt: skip
        # Blurred first, as the chain does, then scaled about the middle and moved.
        sx, sy = (scale * np.hypot(width, b) for b in blur)
        lower = width**2 / (np.hypot(width, blur[0]) * np.hypot(width, blur[1]))
        dx = x - (middle + scale * (cx - middle) + shift[0])
        dy = y - (middle + scale * (cy - middle) + shift[1])
        total += lower * height * np.exp(-0.5 * ((dx / sx) ** 2 + (dy / sy) ** 2))
    return total


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    folder = tmp_path_factory.mktemp("known")
    network = blur_network(
        size=SIZE, blur=("gaussian_mtf", {"sigma_x_mrad": 0.04, "sigma_y_mrad": 0.04})
    )
    network["nodes"]["detector"]["disabled"] = True
    fov = network["nodes"]["scene"]["params"]["fov_x_deg"]
    network["nodes"]["scene"] = {
        "module": "read_image",
        "params": {"path": "scene.npy", "fov_x_deg": fov, "fov_y_deg": fov},
    }
    (folder / "net.json").write_text(json.dumps(network), encoding="utf-8")
    np.save(folder / "scene.npy", 10.0 + spots())
    taken = 10.0 + spots(blur=(0.7, 1.1), shift=(3.3, -1.6), scale=1.004)
    noise = np.random.default_rng(8).normal(0.0, 1.0, taken.shape)
    np.save(folder / "taken.npy", 250.0 * taken + 40.0 + noise)
    np.save(folder / "other.npy", np.random.default_rng(9).normal(100.0, 3.0, (SIZE, SIZE)))
    unlike = 250.0 * (10.0 + spots(blur=(0.7, 1.1), seed=5)) + 40.0 + noise
    np.save(folder / "unlike.npy", unlike)
    np.save(folder / "small.npy", np.random.default_rng(9).normal(100.0, 3.0, (64, SIZE)))
    return folder


def test_blur_and_registration_are_recovered(works, scene):
    works(
        "fit", scene / "net.json", "--to", scene / "taken.npy", "--known-scene",
        "--free", "blur.sigma_x_mrad", "blur.sigma_y_mrad",
        "--json", scene / "fit.json", "--report", scene / "fit.html",
    )  # fmt: skip
    result = json.loads((scene / "fit.json").read_text(encoding="utf-8"))
    assert result["warnings"] == []
    assert result["chi2_per_degree"] == pytest.approx(1.0, abs=0.08)
    for axis, truth in (("x", 0.07), ("y", 0.11)):
        fitted = result["parameters"][f"blur.sigma_{axis}_mrad"]
        assert fitted["value"] == pytest.approx(truth, abs=3 * fitted["sigma"])
        assert fitted["sigma"] < 0.02 * truth
    note = next(line for line in result["notes"] if line.startswith("registered"))
    assert "shift of 3.30" in note
    assert "-1.60" in note
    assert "scale of 1.00" in note
    page = (scene / "fit.html").read_text(encoding="utf-8")
    assert "pictures compared" in page
    assert page.count("data:image/png") == 1


@pytest.mark.parametrize(
    ("pictures", "why"),
    [
        (("other.npy",), "does not show the network's scene"),
        (("unlike.npy",), "% of its contrast (variance) is left"),
        (("small.npy",), "the picture has 96 × 64 samples"),
        (("taken.npy", "other.npy"), "fitted to one picture, not 2"),
    ],
)
def test_what_is_no_picture_of_the_scene_is_refused(fails, scene, pictures, why):
    line = fails(
        "fit", scene / "net.json", "--to", *(scene / name for name in pictures), "--known-scene",
        "--free", "blur.sigma_x_mrad",
    )  # fmt: skip
    assert why in line
