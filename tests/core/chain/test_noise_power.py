"""Variances of filtered noise against the chain itself, which is given every sample's impulse."""

import numpy as np
import pytest
import scipy.fft

from core import machine
from core.chain.back_transformed import back_transform, combine_pixels
from core.chain.engine import Engine
from core.chain.noise_power import NoisePower, spectrum_of
from core.chain.wires import Image, Magnitude, Phase
from core.errors import DataError
from core.evaluation.recipes import Step
from core.evaluation.work import Policy
from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from core.physics.optics.blur import gaussian_mtf
from core.transfer.factors import Grid, Law, Planar
from nodes.library import standard_library
from nodes.shared.module_ports import radial, separable
from nodes.transform.resampling import interpolator, resampled

ROWS, COLUMNS = 8, 12
GRID = Grid(ROWS, COLUMNS, 1.0, 1.2)


def gaussians(*, rho, sigma_mrad):
    return np.exp(-2 * (np.pi * sigma_mrad * rho) ** 2)


BLUR = separable(gaussian_mtf, x={"sigma_mrad": 0.6}, y={"sigma_mrad": 0.4}, label="blur")
TRANSFER = {"transfers": 640, "efficiency": 0.9993, "model": "exact"}
SCALE = {"argument": "phase_per_transfer", "scale_x": 2 * np.pi}
ODD = (
    *separable(charge_transfer_mtf, x=TRANSFER, **SCALE),
    *separable(charge_transfer_ptf, x=TRANSFER, part="ptf", **SCALE),
)
PUPIL = radial(gaussians, sigma_mrad=0.3)
CHAINS = {"even": BLUR, "odd": (*BLUR, *ODD), "plane": (*BLUR, *PUPIL), "all": (*PUPIL, *ODD)}


@pytest.fixture(scope="module")
def work():
    return Engine(standard_library()).work(Policy(precision="double"))


def impulse(_, *, place):
    frame = np.zeros(ROWS * COLUMNS)
    frame[place] = 1.0
    return frame.reshape(ROWS, COLUMNS)


def through(image, factors, edges):
    wires = [tuple(f for f in factors if f.part == part) for part in ("mtf", "ptf")]
    grid = Grid(*image.shape, image.interval_x_mrad, image.interval_y_mrad)
    return back_transform(
        Magnitude(image, grid, edges).times(*wires[0]), Phase(image, grid, edges).plus(*wires[1])
    )


def by_impulses(work, chain, weights=None):
    """Sums over all samples of the square of what a unit there makes of the last picture."""
    totals = np.zeros(4)
    for place in range(ROWS * COLUMNS):
        start = Image(Step.of(impulse, place=place), ROWS, COLUMNS, 1.0, 1.2)
        made = work.value(chain(start).recipe)
        weight = 1.0 if weights is None else weights.ravel()[place]
        totals += weight * np.array(
            [
                np.mean(made**2),
                np.mean(made.mean(axis=1) ** 2),
                np.mean(made.mean(axis=0) ** 2),
                made.mean() ** 2,
            ]
        )
    return totals


def told(power):
    rows, columns = power.rows, power.columns
    parts = power.components(temporal=True)
    means = [
        parts.t + parts.tv + (parts.th + parts.tvh) / columns,
        parts.t + parts.th + (parts.tv + parts.tvh) / rows,
        parts.t + parts.tv / rows + parts.th / columns + parts.tvh / (rows * columns),
    ]
    return [power.variance, *means]


@pytest.mark.thorough(but=12)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("factors", [(1, 1), (3, 2), (5, 1), (1, 3)])
def test_filtered_and_combined(work, edges, chain, factors):
    x, y = factors
    expected = by_impulses(
        work,
        lambda image: combine_pixels(through(image, CHAINS[chain], edges), factor_x=x, factor_y=y),
    )
    axes = edges
    filtered = NoisePower.white(ROWS, COLUMNS, 1.0).filtered(work, CHAINS[chain], GRID, axes)
    power = filtered.averaged(x, y)
    assert (power.rows, power.columns) == (ROWS // y, COLUMNS // x)
    assert told(power) == pytest.approx(list(expected), rel=1e-11)


def smear(*, xi, eta):
    return np.sinc(2.1 * xi + 1.3 * eta) * np.exp(1j * (xi**2 * eta))


@pytest.mark.parametrize("factors", [(1, 1), (3, 2)])
def test_by_a_law_that_mixes_the_axes(work, factors):
    """At the Nyquist row and column the mean of both signs acts, on all factors together."""
    x, y = factors
    law = Law.of(smear)
    mixed = [Planar(law, symmetric=False, take=take) for take in ("modulus", "phase")]
    chain = (*mixed, *ODD)
    expected = by_impulses(
        work,
        lambda image: combine_pixels(through(image, chain, "periodic"), factor_x=x, factor_y=y),
    )
    filtered = NoisePower.white(ROWS, COLUMNS, 1.0).filtered(work, chain, GRID, "periodic")
    power = filtered.averaged(x, y)
    assert told(power) == pytest.approx(list(expected), rel=1e-11)


def test_a_matrix_that_memory_cannot_hold_is_refused(work, monkeypatch):
    monkeypatch.setattr(machine, "usable_bytes", lambda: 2 * 40 * COLUMNS**2 - 2)
    power = NoisePower.white(ROWS, COLUMNS, 1.0)
    power.filtered(work, BLUR, GRID, "reflect")
    with pytest.raises(DataError, match=f"the noise of {COLUMNS} samples in a row or column"):
        power.filtered(work, ODD, GRID, "reflect")


def test_samples_of_different_variances(work):
    weights = np.random.default_rng(4).uniform(0.2, 3.0, (ROWS, COLUMNS))
    expected = by_impulses(work, lambda image: through(image, BLUR, "reflect"), weights)
    power = NoisePower.white(ROWS, COLUMNS, weights)
    assert told(power)[0] == pytest.approx(weights.mean(), rel=1e-14)
    assert told(power.filtered(work, BLUR, GRID, "reflect")) == pytest.approx(
        list(expected), rel=1e-11
    )


@pytest.mark.thorough(but=11)
@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize("new", [(11, 9), (5, 12), (16, 30)])
@pytest.mark.parametrize("edges", ["reflect", "periodic", None])
def test_resampled(work, order, new, edges):
    frame = "periodic" if edges == "periodic" else "reflect"

    def chain(image):
        blurred = through(image, BLUR, frame)
        how = {"old": (ROWS, COLUMNS), "new": new, "order": order, "edges": edges}
        return blurred.with_recipe(Step.of(resampled, blurred.recipe, **how))

    axes = edges
    power = NoisePower.white(ROWS, COLUMNS, 1.0).filtered(work, BLUR, GRID, axes)
    found = power.resampled(
        new, interpolator(ROWS, new[0], order, edges), interpolator(COLUMNS, new[1], order, edges)
    )
    assert told(found) == pytest.approx(list(by_impulses(work, chain)), rel=1e-11)


def test_of_a_pattern_and_scaled():
    samples = np.random.default_rng(2).standard_normal((ROWS, COLUMNS))
    power = NoisePower.of_pattern(samples).scaled(3.0)
    expected = [
        np.mean(samples**2),
        np.mean(samples.mean(axis=1) ** 2),
        np.mean(samples.mean(axis=0) ** 2),
        samples.mean() ** 2,
    ]
    assert told(power) == pytest.approx([9 * each for each in expected], rel=1e-12)


# Spectra of filtered noise in cells, against the filter's power and one wave.


def test_of_a_pattern_of_one_frequency():
    """cos(2π·5·x/40) of 40 columns is wave 10 of 40: a quarter of Nyquist, in cell 2 of 8."""
    samples = np.tile(np.cos(2 * np.pi * 5 * (np.arange(40) + 0.5) / 40), (6, 1))
    amplitudes = scipy.fft.dctn(samples, type=2, norm="ortho")
    assert np.argmax(np.abs(amplitudes[0])) == 10
    found = spectrum_of([NoisePower.of_pattern(samples)], cells=8)
    lit = np.flatnonzero(found.sum(axis=0) > 1e-9 * found.sum())
    assert list(lit) == [1, 2]  # half of the wave's band on each side of 2/8


def amplitude_power(operator, axes):
    """Variances of the waves' amplitudes behind an operator on white noise, by their definition."""
    n = len(operator)
    k, x = np.mgrid[:n, :n]
    if axes == "periodic":
        waves = np.exp(-2j * np.pi * k * x / n) / np.sqrt(n)
    else:
        waves = np.cos(np.pi * k * (x + 0.5) / n) * np.where(k > 0, np.sqrt(2 / n), np.sqrt(1 / n))
    return np.sum(np.abs(waves @ operator) ** 2, axis=1)


def in_cells(power, axes, cells):
    """Means over cells, each frequency having the power of the wave nearest to it."""
    n = len(power)
    strips = 2 * n * cells  # of which every border between cells or waves is one
    f = (np.arange(strips) + 0.5) / strips  # of Nyquist
    if axes == "periodic":
        of_wave = (power + power[-np.arange(n)]) / 2
        nearest = np.minimum(np.rint(f * n / 2).astype(int), n // 2)
    else:
        of_wave, nearest = power, np.minimum(np.rint(f * n).astype(int), n - 1)
    return of_wave[nearest].reshape(cells, -1).mean(axis=1)


def blurring(size, sigma, interval, axes):
    """Matrix of a Gaussian blur: what it makes of a unit in each sample, from sums of waves."""
    x = np.arange(size)
    period = size if axes == "periodic" else 2 * size
    order = np.minimum(np.arange(period), period - np.arange(period))
    mtf = np.exp(-2 * (np.pi * sigma * order / (period * interval)) ** 2)
    spread = np.array([np.sum(mtf * np.cos(2 * np.pi * order * d / period)) for d in range(period)])
    spread /= period
    matrix = spread[(x[:, None] - x) % period]
    if axes == "reflect":  # and the mirror image of each sample, at −1 − x
        matrix = matrix + spread[(x[:, None] + x + 1) % period]
    return matrix


SMALL = [(1, 1), (1, 7), (13, 1), (2, 3), (5, 8), (11, 47), (48, 49), (80, 80), (53, 94), (97, 64)]


@pytest.mark.parametrize("axes", ["reflect", "periodic"])
@pytest.mark.parametrize(("rows", "columns"), SMALL)
@pytest.mark.parametrize("cells", [48, 5])
def test_noise_before_and_after_the_transform(work, axes, rows, columns, cells):
    """The noise before is known on the frame's waves, the one after it on none."""
    grid = Grid(rows, columns, 1.0, 1.25)
    before = NoisePower.white(rows, columns, 3.0).filtered(work, BLUR, grid, axes)
    after = NoisePower.white(rows, columns, 0.7)
    found = spectrum_of([after, before, after], cells)
    along = amplitude_power(blurring(rows, 0.4, 1.25, axes), axes)
    across = amplitude_power(blurring(columns, 0.6, 1.0, axes), axes)
    truth = 1.4 + 3.0 * np.outer(
        in_cells(along, axes, min(cells, rows)), in_cells(across, axes, min(cells, columns))
    )
    np.testing.assert_allclose(np.broadcast_to(found, truth.shape), truth, rtol=1e-11)


@pytest.mark.parametrize(("rows", "columns"), SMALL)
def test_noises_on_waves_of_different_edges(work, rows, columns):
    """A noise after the transform that differs from sample to sample is known on cosines."""
    grid = Grid(rows, columns, 1.0, 1.25)
    random = np.random.default_rng(rows * columns)
    periodic = NoisePower.white(rows, columns, 3.0).filtered(work, BLUR, grid, "periodic")
    # The known pattern of a read-out is an instance.
    pattern = random.standard_normal((rows, columns))
    found = spectrum_of([periodic, NoisePower.of_pattern(pattern)])
    cosines = scipy.fft.dctn(pattern, type=2, norm="ortho") ** 2
    for axis in (0, 1):
        cells = min(48, pattern.shape[axis])
        cosines = np.apply_along_axis(lambda p, c=cells: in_cells(p, "reflect", c), axis, cosines)
    along, across = (
        in_cells(amplitude_power(blurring(n, s, d, "periodic"), "periodic"), "periodic", min(48, n))
        for n, s, d in ((rows, 0.4, 1.25), (columns, 0.6, 1.0))
    )
    truth = cosines + 3.0 * np.outer(along, across)
    np.testing.assert_allclose(np.broadcast_to(found, truth.shape), truth, rtol=1e-10)
