"""Spatial Blur against direct sums, and against the Fourier way."""

import math

import numpy as np
import pytest

from analytic_stages import INTERVAL_X, INTERVAL_Y, STAGES
from core.network.network import Link, Network, Node
from delivered_chains import chain_network, scene
from node_bench import NodeBench
from spatial_truth import blurred, left_behind

SIZES = [(24, 17), (23, 16), (16, 1), (1, 9), (1, 1), (33, 48)]
EDGES = ["reflect", "periodic"]
CLOSE = 1e-10


def planned(folder, picture, stages, edges, *, precision="double", tolerance=None, **params):
    """A chain that ends in both ways: `back` and `space`."""
    np.save(folder / "in.npy", picture)
    document, _ = chain_network(stages, *picture.shape, edges)
    twins = [Link(k.source, k.output, "space", k.input) for k in document.links_into("back")]
    document = Network(
        nodes={**document.nodes, "space": Node("space", "spatial_blur", params)},
        links=(*document.links, *twins),
    )
    return NodeBench(folder, document, precision=precision, tolerance=tolerance)


def values(folder, picture, stages, edges="reflect", ports=("image",), **params):
    bench = planned(folder, picture, stages, edges, **params)
    return tuple(bench.value(f"space.{port}") for port in ports)


def whole(folder, picture, stages, edges):
    (found,) = values(folder, picture, stages, edges, truncation="none")
    return found


@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("size", SIZES, ids=str)
class TestDirectSums:
    """Weights and frames written out in the test: no transfer function and no transform."""

    def test_gaussian(self, tmp_path, size, edges, monkeypatch):
        monkeypatch.setitem(STAGES, "blur", ("gaussian_mtf", {
            "sigma_x_mrad": 2.7 * INTERVAL_X, "sigma_y_mrad": 2.7 * INTERVAL_Y,
        }))  # fmt: skip
        picture = scene(*size)
        expected = blurred(picture, 2.7, edges)
        found = whole(tmp_path, picture, ("blur",), edges)
        assert np.abs(found - expected).max() <= CLOSE * expected.max()

    def test_charge_left_behind_with_its_phase(self, tmp_path, size, edges):
        picture = scene(*size)
        expected = left_behind(picture, 3, 0.8, edges)
        found = whole(tmp_path, picture, ("left", "late"), edges)
        assert np.abs(found - expected).max() <= CLOSE * expected.max()

    def test_slanted_smear(self, tmp_path, size, edges):
        """Every cosine of the frame times sinc of the smear along it: a plane kernel."""
        picture = scene(*size)
        widths = -0.005 * 30 / 400 * 1000, 0.005 * 50 / 400 * 1000
        expected = smeared(picture, widths, edges)
        found = whole(tmp_path, picture, ("smear",), edges)
        assert np.abs(found - expected).max() <= CLOSE * expected.max()


def smeared(picture, widths_mrad, edges):
    """Sum over the repeating frame's frequencies, each sum written out."""
    frame = picture
    if edges == "reflect":
        frame = np.vstack([frame, frame[::-1]])
        frame = np.hstack([frame, frame[:, ::-1]])
    rows, columns = frame.shape
    ky, kx = np.arange(rows) - rows // 2, np.arange(columns) - columns // 2
    there = [
        np.exp(-2j * np.pi * np.outer(k, np.arange(n)) / n) for k, n in ((ky, rows), (kx, columns))
    ]
    eta, xi = ky / (rows * INTERVAL_Y), kx / (columns * INTERVAL_X)

    def transfer(xi, eta):
        return np.sinc(np.add.outer(widths_mrad[1] * eta, widths_mrad[0] * xi))

    response = transfer(xi, eta)
    # At the Nyquist frequency of an even size both signs of it are one.
    if rows % 2 == 0:
        response[0] = (transfer(xi, eta[:1]) + transfer(xi, -eta[:1]))[0] / 2
    if columns % 2 == 0:
        turned = (transfer(xi[:1], eta) + transfer(-xi[:1], eta))[:, 0] / 2
        if rows % 2 == 0:
            corner = [transfer(a * xi[:1], b * eta[:1])[0, 0] for a in (1, -1) for b in (1, -1)]
            turned[0] = np.mean(corner)
        response[:, 0] = turned
    spectrum = there[0] @ frame @ there[1].T * response
    back = there[0].conj().T @ spectrum @ there[1].conj() / frame.size
    return back.real[: picture.shape[0], : picture.shape[1]]


CHAINS = {
    "separable": ("blur", "pixel", "box"),
    "phase": ("blur", "left", "late"),
    "published phase": ("left", "published"),
    "optics": ("optics",),
    "optics, detector and phase": ("optics", "pixel", "left", "late"),
    "line smear and phase": ("smear", "jitter", "left", "late"),
    "nothing": (),
}


@pytest.mark.thorough(but=23)
@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_equals_the_fourier_way(tmp_path, size, chain, edges):
    picture = scene(*size)
    bench = planned(tmp_path, picture, CHAINS[chain], edges, tolerance=0.0, truncation="none")
    fourier, space = (bench.value(f"{node}.image") for node in ("back", "space"))
    assert np.abs(space - fourier).max() <= CLOSE * np.abs(picture).max()


@pytest.mark.thorough(but=29)
@pytest.mark.parametrize("chain", [name for name in CHAINS if name != "nothing"])
@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize(
    "params",
    [{"half_width_px": n} for n in (0, 1, 5, 20, 1000)]
    + [{"truncation": "error", "error": e} for e in (0.0, 1e-3, 0.05, 0.6)],
    ids=str,
)
def test_cutting_short_costs_no_more_than_is_said(tmp_path, chain, edges, params):
    picture = scene(31, 40)
    exact = whole(tmp_path, picture, CHAINS[chain], edges)
    found, table = values(
        tmp_path, picture, CHAINS[chain], edges, ports=("image", "table"), **params
    )
    bound = table.as_dict()["error_bound"]
    departure = np.abs(picture - picture.mean()).max()
    error = np.abs(found - exact).max()
    assert error <= bound * departure + 1e-12 * picture.max()
    if params.get("truncation") == "error":
        assert bound <= params["error"]
    if params.get("half_width_px") == 0:
        assert error > 0.01 * bound * departure > 0.0  # the bound is one that counts
    if params.get("half_width_px") == 1000:
        assert bound == 0.0
    assert found.mean() == pytest.approx(exact.mean(), abs=bound * departure + 1e-12)


def test_the_bound_is_reached_by_the_worst_picture(tmp_path, monkeypatch):
    """Samples with the signs of the taps that are cut off, at the place that sums them."""
    monkeypatch.setitem(STAGES, "lag", ("charge_eff_mtf", {
        "detectors_per_line": 1, "efficiency": 0.5,
    }))  # fmt: skip
    monkeypatch.setitem(STAGES, "late", ("charge_eff_phase", {
        "detectors_per_line": 1, "efficiency": 0.5,
    }))  # fmt: skip
    # One transfer leaves 1/2^(n+1) behind by n samples: all positive.
    picture = np.zeros((1, 40))
    picture[0, 20] = 1.0
    found, table = values(
        tmp_path, picture - 1 / 40, ("lag", "late"), "periodic", ports=("image", "table"),
        half_width_px=4,
    )  # fmt: skip
    kept = sum(0.5 ** (n + 1) for n in range(5))
    assert table.as_dict()["error_bound"] == pytest.approx(1 - kept, rel=1e-9)
    expected = np.zeros(40)
    expected[20:25] = [0.5 ** (n + 1) for n in range(5)]
    np.testing.assert_allclose(found[0], expected - kept / 40, atol=1e-11)
    assert table.as_dict()["taps"] == 9


def test_separable_factors_are_two_passes_and_others_a_plane(tmp_path):
    picture = scene(24, 16)
    ports = ("table", "curve")
    table, curve = values(tmp_path, picture, ("blur",), ports=ports, truncation="none")
    assert table.as_dict() == {
        "taps": 80, "taps_x": 32, "taps_y": 48, "taps_plane": 0, "error_bound": 0.0,
    }  # fmt: skip
    assert [series.label for series in curve.series] == ["horizontal", "vertical"]
    for series in curve.series:
        assert series.y.sum() == pytest.approx(1.0, abs=1e-14)
        assert series.x[np.argmax(series.y)] == 0.0
    table, curve = values(
        tmp_path, picture, ("optics", "pixel", "late"), ports=ports, half_width_px=3
    )
    found = table.as_dict()
    assert (found["taps_x"], found["taps_y"], found["taps_plane"]) == (7, 7, 49)
    labels = [series.label for series in curve.series]
    assert labels == ["plane, horizontal", "plane, vertical", "horizontal", "vertical"]
    table, _ = values(tmp_path, picture, ("smear", "pixel"), ports=ports, half_width_px=3)
    assert table.as_dict()["taps"] == 49  # one plane takes the detector in


def test_the_impulse_response_is_that_of_the_law(tmp_path, monkeypatch):
    sigma = 2.0
    monkeypatch.setitem(STAGES, "blur", ("gaussian_mtf", {
        "sigma_x_mrad": sigma * INTERVAL_X, "sigma_y_mrad": 0,
    }))  # fmt: skip
    (curve,) = values(tmp_path, scene(8, 60), ("blur",), ports=("curve",), half_width_px=12)
    (series,) = curve.series
    lags = np.arange(-12, 13)
    np.testing.assert_allclose(series.x, lags * INTERVAL_X, rtol=1e-12)
    expected = np.exp(-((lags / sigma) ** 2) / 2) / (sigma * math.sqrt(2 * math.pi))
    np.testing.assert_allclose(series.y, expected, atol=1e-9)
