"""MTF Slices against formulas."""

from dataclasses import replace

import numpy as np
import pytest

from core.chain.wires import Magnitude, SampledTransfer, Transfer
from core.evaluation.recipes import Step, Store
from core.evaluation.work import Policy, Work
from core.modules.declaration import NodeContext
from core.transfer.factors import Grid, Law, Planar, Separable
from node_bench import NodeBench
from nodes.analysis.mtf_slices import MtfSlices

GRID = Grid(40, 64, 0.5, 0.8)


def sliced(**slicing):
    """Slices of what two blurs make together that are alike in name, behind a scene."""
    nodes = {
        "scene": ("test_scene", {"width": 64, "height": 40, "fov_x_deg": 2, "fov_y_deg": 3}),
        "init": ("init_trans", {}),
        "one": ("gaussian_mtf", {"sigma_x_mrad": 0.3, "sigma_y_mrad": 0.9}),
        "two": ("gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.1}),
        "jitter": ("jitter_mtf", {"sigma_mrad": 0.4}),
        "slices": ("mtf_slices", slicing),
    }
    bench = NodeBench(None, nodes, precision="single")
    return bench.plan, bench.value("slices.curve"), bench.readouts("slices")


def blur(sigma, frequency):
    return np.exp(-2 * (np.pi * sigma * frequency) ** 2)


def test_stages_and_total_on_both_axes():
    plan, curves, readouts = sliced(direction="both", samples=33)
    grid = plan.output("init.context").grid
    expected, ends = {}, []
    cases = (("horizontal", grid.nyquist_x, (0.3, 0.2)), ("vertical", grid.nyquist_y, (0.9, 0.1)))
    for name, nyquist, (one, two) in cases:
        f = np.linspace(0, nyquist, 33)
        stages = {
            f"Gaussian MTF (one) {name}": blur(one, f),
            f"Gaussian MTF (two) {name}": blur(two, f),
            f"Jitter MTF {name}": blur(0.4, f),
        }
        stages[f"Total MTF {name}"] = np.prod(list(stages.values()), axis=0)
        expected |= {label: (f, y) for label, y in stages.items()}
        ends.append(stages[f"Total MTF {name}"][-1])
    assert [series.label for series in curves.series] == list(expected)
    for series in curves.series:
        np.testing.assert_allclose(series.x, expected[series.label][0], rtol=1e-14)
        np.testing.assert_allclose(series.y, expected[series.label][1], rtol=1e-12)
    assert readouts["at_nyquist_x"] == pytest.approx(ends[0], rel=1e-12)
    assert readouts["at_nyquist_y"] == pytest.approx(ends[1], rel=1e-12)
    assert curves.x_label == "frequency (cyc/mrad)"


def test_any_angle_ends_where_the_band_does():
    plan, curves, _ = sliced(direction="angle", angle_deg=-30.0, stages=False)
    grid = plan.output("init.context").grid
    (total,) = curves.series
    end = min(grid.nyquist_x / np.cos(np.pi / 6), grid.nyquist_y / 0.5)
    f = np.linspace(0, end, 257)
    xi, eta = f * np.cos(np.pi / 6), -f / 2
    expected = blur(0.3, xi) * blur(0.9, eta) * blur(0.2, xi) * blur(0.1, eta) * blur(0.4, f)
    assert total.label == "Total MTF"
    np.testing.assert_allclose(total.x, f, rtol=1e-13)
    np.testing.assert_allclose(total.y, expected, rtol=1e-11)


@pytest.mark.parametrize(
    ("angle", "direction"), [(0, "horizontal"), (180, "horizontal"), (90, "vertical")]
)
def test_right_angles_are_the_axes(angle, direction):
    turned = sliced(direction="angle", angle_deg=angle)[1]
    straight = sliced(direction=direction)[1]
    for a, b in zip(turned.series, straight.series, strict=True):
        np.testing.assert_array_equal(a.x, b.x)
        np.testing.assert_array_equal(a.y, b.y)


def lopsided(xi, eta):
    """Complex and Hermitian, with phases."""
    return np.exp(-0.1 * (xi**2 + eta**2)) * np.exp(1j * (xi**3 + 0.4 * xi * eta**2 + eta))


def delay(frequency, delay_mrad):
    return -2 * np.pi * frequency * delay_mrad


def curve_of(transfer, **slicing):
    """Slices of any transfer, without a network."""
    output = MtfSlices.build(slicing).run(transfer, NodeContext("slices"))
    return Work(Policy(), Store()).value(output.curve.recipe)


def test_complex_factors_and_phases():
    modulus = Planar(Law.of(lopsided), symmetric=False, take="modulus", label="Pupil")
    phase = replace(modulus, take="phase")
    shift = Separable(Law.of(delay, delay_mrad=0.1), None, part="ptf", label="Delay")
    angle = np.degrees(np.arctan2(0.8, 0.6))
    settings = {"direction": "angle", "angle_deg": angle}
    (_, total) = curve_of(Magnitude(None, GRID, factors=(modulus,)), **settings).series
    np.testing.assert_allclose(total.y, np.exp(-0.1 * total.x**2), rtol=1e-12)
    pupil, later, total = curve_of(Transfer(GRID, "ptf", (phase, shift)), **settings).series
    xi, eta = 0.6 * total.x, 0.8 * total.x
    np.testing.assert_allclose(pupil.y, xi**3 + 0.4 * xi * eta**2 + eta, atol=1e-12)
    np.testing.assert_allclose(later.y, -0.2 * np.pi * xi, atol=1e-12)
    np.testing.assert_allclose(total.y, pupil.y + later.y, atol=1e-14)
    assert total.label == "Total PTF"


def tent(work, *, rows, columns, step_x, step_y):
    """A plane through 1 that falls linearly, sampled in FFT order."""
    xi = np.fft.fftfreq(columns, 1 / (columns * step_x))
    eta = np.fft.fftfreq(rows, 1 / (rows * step_y))
    return SampledTransfer(1 - 0.1 * xi - 0.2 * eta[:, None], step_x, step_y)


def test_function_with_intervals_of_its_own():
    own = Step.of(tent, rows=9, columns=14, step_x=0.3, step_y=0.2)
    transfer = Transfer(GRID, "mtf", label="Autocorrelation", own=own)
    (row,) = curve_of(transfer).series
    np.testing.assert_allclose(row.x, 0.3 * np.arange(7), rtol=1e-14)
    np.testing.assert_allclose(row.y, 1 - 0.1 * row.x, rtol=1e-13)
    (column,) = curve_of(transfer, direction="vertical").series
    np.testing.assert_allclose(column.y, 1 - 0.2 * 0.2 * np.arange(5), rtol=1e-13)
    (slanted,) = curve_of(transfer, direction="angle", angle_deg=-20.0).series
    cosine, sine = np.cos(np.radians(-20)), np.sin(np.radians(-20))
    expected = 1 - (0.1 * cosine + 0.2 * sine) * slanted.x
    np.testing.assert_allclose(slanted.y, expected, rtol=1e-12)
