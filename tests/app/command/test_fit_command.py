"""``imagechain fit`` on pictures that direct sums have made."""

import json

import numpy as np
import pytest

from edge_truth import blur_network, gaussian_edge


@pytest.fixture
def files(tmp_path):
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.05}))
    (tmp_path / "net.json").write_text(json.dumps(network), encoding="utf-8")
    picture = gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), levels=(1000, 4000), noise=20.0, seed=5
    )
    np.save(tmp_path / "edge.npy", picture)
    return tmp_path


@pytest.fixture(scope="module")
def crossed(tmp_path_factory):
    """Edges across and down, and a chain with two Gaussian blurs in it and one beside it."""
    folder = tmp_path_factory.mktemp("crossed")
    network = blur_network(
        blur=("gaussian_mtf", {"sigma_x_mrad": 0.04, "sigma_y_mrad": 0.04}),
        jitter=("jitter_mtf", {"sigma_mrad": 0.03}),
    )
    network["notes"] = "kept"
    network["nodes"]["beside"] = {"module": "jitter_mtf", "params": {}}
    network["links"] += [
        ["init.context", "beside.context"], ["init.magnitude", "beside.magnitude"]
    ]  # fmt: skip
    (folder / "net.json").write_text(json.dumps(network), encoding="utf-8")
    for name, angle in (("across", 7.0), ("down", 98.0)):
        picture = gaussian_edge(
            angle_deg=angle, sigma=(0.6, 0.8), shape=(64, 64), noise=15.0, seed=int(angle)
        )
        np.save(folder / f"{name}.npy", picture)
    return folder


def fitted(folder, works, *free):
    done = works(
        "fit", folder / "net.json", "--to", folder / "across.npy", folder / "down.npy",
        "--free", *free, "--json", folder / "fit.json", "--output", folder / "fitted.json",
        "--report", folder / "fit.html",
    )  # fmt: skip
    return json.loads((folder / "fit.json").read_text(encoding="utf-8")), done.stdout


def test_parameters_with_one_effect_are_named_with_what_is_known(works, crossed):
    result, printed = fitted(
        crossed, works, "blur.sigma_x_mrad", "blur.sigma_y_mrad", "jitter.sigma_mrad"
    )
    for one in result["parameters"].values():
        assert (one["value"], one["sigma"]) == (None, None)
    known = {one["expression"]: one for one in result["combinations"]}
    assert set(known) == {
        "sqrt(blur.sigma_x_mrad² + jitter.sigma_mrad²)",
        "sqrt(blur.sigma_y_mrad² + jitter.sigma_mrad²)",
    }
    for one, truth in zip(known.values(), (0.06, 0.08), strict=True):
        assert one["value"] == pytest.approx(truth, abs=3 * one["sigma"])
        assert one["sigma"] < 0.02 * truth
    assert "cannot be separated" in result["warnings"][0]
    assert result["correlation"] == [[None] * 3] * 3
    assert "Correlation of errors" not in (crossed / "fit.html").read_text(encoding="utf-8")
    assert "cannot be separated" in printed
    # The network has values that belong together.
    network = json.loads((crossed / "fitted.json").read_text(encoding="utf-8"))
    assert network["notes"] == "kept"
    blur, jitter = network["nodes"]["blur"]["params"], network["nodes"]["jitter"]["params"]
    total = np.hypot(blur["sigma_x_mrad"], jitter["sigma_mrad"])
    assert total == pytest.approx(0.06, abs=3 * next(iter(known.values()))["sigma"])


def test_a_parameter_without_effect_gets_no_number(works, crossed):
    result, _ = fitted(crossed, works, "jitter.sigma_mrad", "beside.sigma_mrad")
    beside = result["parameters"]["beside.sigma_mrad"]
    assert (beside["value"], beside["sigma"]) == (None, None)
    assert any("has no effect on the edges" in line for line in result["warnings"])
    # Across and down differ by much more than noise, and one jitter cannot do that.
    assert result["parameters"]["jitter.sigma_mrad"]["value"] is None
    assert any("give edges of this shape" in line for line in result["warnings"])


def test_the_end_of_a_range_is_pointed_out(works, crossed):
    result, _ = fitted(crossed, works, "jitter.sigma_mrad=0.2:0.3")
    assert result["parameters"]["jitter.sigma_mrad"]["value"] is None
    network = json.loads((crossed / "fitted.json").read_text(encoding="utf-8"))
    fitted_value = network["nodes"]["jitter"]["params"]["sigma_mrad"]
    assert fitted_value == pytest.approx(0.2, rel=1e-3)
    assert any("lower end of its range, 0.2 mrad" in line for line in result["warnings"])


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ((), "--free: name a parameter to fit, such as blur.sigma_x_mrad, blur.sigma_y_mrad, "),
        (("--free", "blur.sigma_x_mrad=2:1"), "LOW below HIGH"),
        (("--free", "init.platform"), "only a parameter with a range of numbers"),
        (("--free", "blur.sigma_x_mrad", "--output", "net.png"), "must end in .json"),
    ],
)
def test_what_cannot_be_free_is_refused_in_one_line(fails, files, words, why):
    assert why in fails("fit", "net.json", "--to", "edge.npy", *words)


def test_a_picture_without_an_edge_is_refused(fails, files):
    np.save(files / "flat.npy", np.random.default_rng(1).normal(100.0, 3.0, (64, 64)))
    assert "flat.npy: no edge can be used" in fails(
        "fit", "net.json", "--to", "flat.npy", "--free", "blur.sigma_x_mrad"
    )
