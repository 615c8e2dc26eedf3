"""``imagechain fit`` on pictures that direct sums have made."""

from __future__ import annotations

import json

import numpy as np
import pytest

from edge_truth import blur_network, gaussian_edge


@pytest.fixture
def files(tmp_path):
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.05}))
    network["notes"] = "kept"
    (tmp_path / "net.json").write_text(json.dumps(network), encoding="utf-8")
    picture = gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), levels=(1000, 4000), noise=20.0, seed=5
    )
    np.save(tmp_path / "edge.npy", picture)
    return tmp_path


def test_a_blur_is_recovered_from_an_edge_with_its_error(imagechain, files):
    done = imagechain(
        "fit", "net.json", "--to", "edge.npy", "--free", "blur.sigma_x_mrad",
        "--json", "fit.json", "--output", "fitted.json",
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    result = json.loads((files / "fit.json").read_text(encoding="utf-8"))
    fitted = result["parameters"]["blur.sigma_x_mrad"]
    # 0.1 mrad a sample; sin²(6°) of the blur is along.
    assert fitted["value"] == pytest.approx(0.06, abs=3 * fitted["sigma"])
    assert 1e-4 < fitted["sigma"] < 1e-3
    assert result["correlation"] == [[1.0]]
    assert result["chi2_per_degree"] == pytest.approx(1.0, abs=0.1)
    network = json.loads((files / "fitted.json").read_text(encoding="utf-8"))
    assert network["nodes"]["blur"]["params"] == {
        "sigma_x_mrad": fitted["value"], "sigma_y_mrad": 0.05,
    }  # fmt: skip
    assert network["notes"] == "kept"
    assert done.stdout.startswith("blur.sigma_x_mrad")


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("--free", "blur.sigma"), "Gaussian MTF has no parameter sigma"),
        (("--free", "blur.sigma_x_mrad=2:1"), "LOW below HIGH"),
        (("--free", "blur.sigma_x_mrad=-1:1"), "a number of at least 0"),
        (("--free", "init.platform"), "only a number that may lie between others"),
        (("--free", "blur.sigma_x_mrad", "blur.sigma_x_mrad"), "given more than once"),
    ],
)
def test_what_cannot_be_free_is_refused_in_one_line(imagechain, files, words, why):
    done = imagechain("fit", "net.json", "--to", "edge.npy", *words)
    assert done.returncode == 2
    assert why in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_picture_without_an_edge_is_refused(imagechain, files):
    np.save(files / "flat.npy", np.random.default_rng(1).normal(100.0, 3.0, (64, 64)))
    done = imagechain("fit", "net.json", "--to", "flat.npy", "--free", "blur.sigma_x_mrad")
    assert done.returncode == 2
    assert "flat.npy: no edge can be used" in done.stderr
