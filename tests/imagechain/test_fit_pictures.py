"""`ic.fit`: a chain fitted to arrays and files, as the command fits it."""

import json

import numpy as np
import pytest

import imagechain as ic
from command_line import run_here
from edge_truth import blur_network, gaussian_edge

SIGMA_X, SIGMA_Y, INTERVAL = 0.6, 0.8, 0.1  # samples, samples, mrad


def edge(angle_deg, seed=1):
    return gaussian_edge(
        angle_deg=angle_deg, sigma=(SIGMA_X, SIGMA_Y), shape=(64, 64), noise=15.0, seed=seed
    )


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blurs = {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.2}
    network = blur_network(blur=("gaussian_mtf", blurs), jitter=("jitter_mtf", {"sigma_mrad": 0.0}))
    (tmp_path / "camera.json").write_text(json.dumps(network), encoding="utf-8")
    np.save("across.npy", edge(6.0))
    np.save("along.npy", edge(96.0, 2))
    return tmp_path


def test_both_blurs_from_files_and_from_arrays(folder):
    chain = ic.open("camera.json")
    names = ["blur.sigma_x_mrad", "blur.sigma_y_mrad"]
    fitted = ic.fit(chain, to=["across.npy", "along.npy"], free=names)
    for name, truth in zip(names, (SIGMA_X, SIGMA_Y), strict=True):
        one = fitted.parameters[name]
        assert one.value == pytest.approx(truth * INTERVAL, abs=4.0 * one.sigma)
        assert one.sigma < 0.01 * one.value
        assert fitted.chain.get(name) == one.value
    assert chain.get("blur.sigma_x_mrad") == 0.2
    assert fitted.correlation.shape == (2, 2)
    assert fitted.chi2_per_degree == pytest.approx(1.0, abs=0.1)
    assert (fitted.warnings, fitted.combinations) == ((), {})
    assert "0.1 × 0.1 mrad" in " ".join(fitted.notes)
    words = ("--to", "across.npy", "along.npy", "--free", *names, "--json", "fit.json")
    done = run_here("fit", "camera.json", *words, folder=folder)
    assert done.returncode == 0, done.stderr
    assert json.loads((folder / "fit.json").read_text("utf-8")) == fitted.to_dict()
    assert done.stdout == f"{fitted!r}\n"
    of_arrays = ic.fit("camera.json", to=[edge(6.0), edge(96.0, 2)], free=names)
    assert of_arrays.to_dict() == fitted.to_dict()


def test_a_fit_is_saved_and_its_chain_runs(folder):
    fitted = ic.fit("camera.json", to=edge(6.0), free={"blur.sigma_x_mrad": (0.01, 0.2)})
    fitted.save("fit.json")
    assert json.loads((folder / "fit.json").read_text("utf-8")) == fitted.to_dict()
    fitted.save("fit.html")
    assert "blurs fitted to array 1" in (folder / "fit.html").read_text("utf-8")
    fitted.chain.save("fitted.json")
    value = fitted.parameters["blur.sigma_x_mrad"].value
    assert ic.open("fitted.json").get("blur.sigma_x_mrad") == value
    assert fitted.chain.run().image().shape == (64, 64)
    with pytest.raises(ic.UsageError, match=r"must end in \.json or \.html"):
        fitted.save("fit.txt")


def test_parameters_with_one_effect_have_a_combination(folder):
    names = {"blur.sigma_x_mrad": None, "jitter.sigma_mrad": None}
    chain = ic.open("camera.json").set("blur.sigma_y_mrad", SIGMA_Y * INTERVAL)
    fitted = ic.fit(chain, to=edge(6.0), free=names)
    assert [one.value for one in fitted.parameters.values()] == [None, None]
    ((text, (value, sigma)),) = fitted.combinations.items()
    assert text == "sqrt(blur.sigma_x_mrad² + jitter.sigma_mrad²)"
    assert value == pytest.approx(SIGMA_X * INTERVAL, abs=4.0 * sigma)
    assert np.isnan(fitted.correlation).all()
    assert "not determined" in repr(fitted)


@pytest.mark.parametrize(
    ("how", "line"),
    [
        ({"free": {"blur.sigma_x_mrad": 3}}, "is not allowed"),
        ({"to": 3}, "to: int is not allowed; give a picture"),
        ({"to": ["across.npy", np.zeros((20, 20))]}, "only files or only arrays"),
        ({"to": np.zeros((20, 20), complex)}, "picture 1 is an array of complex128"),
    ],
)  # fmt: skip
def test_what_is_refused(folder, how, line):
    words = {"to": edge(6.0), "free": "blur.sigma_x_mrad", **how}
    with pytest.raises(ic.ImagechainError) as raised:
        ic.fit("camera.json", **words)
    assert line in str(raised.value)
