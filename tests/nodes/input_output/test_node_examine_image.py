"""Examine Image against numpy and Planck's law by quadrature."""

import numpy as np
import pytest
import scipy.integrate
from scipy.constants import c, h, k

from core.errors import ParameterError
from node_bench import NodeBench


def picture(rows=6, columns=9, seed=1):
    return np.random.default_rng(seed).uniform(-5, 60, (rows, columns))


def examining(folder, array, band=None, **params):
    np.save(folder / "in.npy", array)
    extra = {} if band is None else {"cut_on_um": band[0], "cut_off_um": band[1]}
    nodes = {"in": ("read_image", {"path": "in.npy", **extra}), "out": ("examine_image", params)}
    return NodeBench(folder, nodes)


def test_examine_statistics_and_readouts(tmp_path):
    array = picture(200, 301)
    bench = examining(tmp_path, array)
    expected = {
        "minimum": array.min(),
        "maximum": array.max(),
        "mean": array.mean(),
        "sigma": array.std(),
    }
    assert bench.value("out.table").as_dict() == pytest.approx(expected, rel=1e-13)
    assert bench.readouts("out") == pytest.approx(expected, rel=1e-13)
    module = bench.plan.nodes["out"].module
    assert module.files({}, None, bench.work) == []


@pytest.mark.parametrize("value", [0.0, 1e30, -3.0, 1e-30, 1e200])
def test_examine_constant_and_extreme_pictures(tmp_path, value):
    table = examining(tmp_path, np.full((3, 5), value)).value("out.table").as_dict()
    assert table == {"minimum": value, "maximum": value, "mean": value, "sigma": 0.0}
    curve = examining(tmp_path, np.full((3, 5), value)).value("out.curve").series[0]
    assert (curve.x.tolist(), curve.y.tolist()) == ([value], [15.0])
    ends = examining(tmp_path, np.array([[0.0, value]])).value("out.table").as_dict()
    assert ends["sigma"] == pytest.approx(abs(value) / 2, rel=1e-14)


def test_examine_tells_the_apparent_temperature(tmp_path):
    def spectral(micron, kelvin):
        metre = micron * 1e-6
        return 2e-6 * h * c**2 / metre**5 / np.expm1(h * c / (metre * k * kelvin))

    radiance = [
        scipy.integrate.quad(spectral, 8, 12, args=(kelvin,), epsrel=1e-13)[0]
        for kelvin in (280.0, 300.0, 330.0)
    ]
    array = np.array([radiance])
    table = examining(tmp_path, array, band=(8, 12), probe_x=1, probe_y=0).value("out.table")
    found = table.as_dict()
    assert found["minimum_K"] == pytest.approx(280.0, rel=1e-10)
    assert found["probe"] == radiance[1]
    assert found["probe_K"] == pytest.approx(300.0, rel=1e-10)
    assert found["maximum_K"] == pytest.approx(330.0, rel=1e-10)
    assert 280 < found["mean_K"] < 330
    assert {row.name: row.unit for row in table.rows}["mean_K"] == "K"
    negative = examining(tmp_path, array - 100.0, band=(8, 12)).value("out.table").as_dict()
    assert negative["minimum_K"] is None


def test_reflected_light_has_no_apparent_temperature(tmp_path):
    """0.5 to 0.8 µm: sunlit ground would come out as hot as 1280 K."""
    array = np.array([[19.0, 24.0]])
    names = examining(tmp_path, array, band=(0.5, 0.8)).value("out.table").as_dict()
    assert set(names) == {"minimum", "maximum", "mean", "sigma"}


def test_examine_refuses_a_probe_outside(tmp_path):
    bench = examining(tmp_path, picture(), probe_x=9, probe_y=0)
    with pytest.raises(ParameterError, match="probe_x = 9"):
        bench.value("out.table")
    assert examining(tmp_path, picture(), probe_x=0).error("out").parameter == "probe_y"


def test_examine_histogram_of_what_is_displayed(tmp_path):
    array = np.abs(picture(31, 20)) + 0.1
    shown = {
        "linear": array,
        "log": np.log10(array),
        "centred_spectrum": np.log10(np.abs(np.fft.fft2(array))),
    }
    for display, expected in shown.items():
        curve = examining(tmp_path, array, display=display, bins=16).value("out.curve")
        counts, edges = np.histogram(expected, bins=16)
        np.testing.assert_array_equal(curve.series[0].y, counts)
        np.testing.assert_allclose(
            curve.series[0].x, (edges[1:] + edges[:-1]) / 2, rtol=1e-9, atol=1e-9
        )


def test_examine_magnitude_and_phase(tmp_path):
    np.save(tmp_path / "in.npy", picture())
    nodes = {
        "in": ("read_image", {"path": "in.npy", "fov_x_deg": 1, "fov_y_deg": 1}),
        "init": ("init_trans", {}),
        "mag": ("examine_image", {"probe_x": 2, "probe_y": 1}),
        "pha": ("examine_image", {"display": "centred_spectrum"}),
    }
    links = [
        ("in.image", "init.image"),
        ("init.magnitude", "mag.image"),
        ("init.phase", "pha.image"),
    ]
    bench = NodeBench(tmp_path, nodes, links)
    spectrum = np.fft.fft2(picture())
    found = bench.value("mag.table").as_dict()
    assert found["maximum"] == pytest.approx(np.abs(spectrum).max(), rel=1e-12)
    assert found["probe"] == pytest.approx(abs(spectrum[1, 2]), rel=1e-12)
    assert bench.value("pha.curve").series[0].y.sum() == picture().size
    assert bench.value("pha.table").as_dict()["maximum"] <= np.pi
