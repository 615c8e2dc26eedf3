"""Spectra of filtered noise in cells, against the filter's power and one wave."""

import numpy as np
import pytest
import scipy.fft

from core.chain.engine import Engine
from core.chain.noise_power import NoisePower, spectrum_of
from core.evaluation.work import Policy
from core.physics.optics.veiling_glare import gaussian_mtf
from core.transfer.factors import Grid
from nodes.library import standard_library
from nodes.shared.factors import separable

BLUR = separable(gaussian_mtf, x={"sigma_mrad": 0.6}, y={"sigma_mrad": 0.4}, label="blur")


@pytest.fixture(scope="module")
def work():
    return Engine(standard_library()).work(Policy(precision="double"))


def mean_power(sigma, nyquist, cells):
    """Of exp(−4π²σ²f²), in each of the cells from 0 to Nyquist, in strips."""
    f = (np.arange(200 * cells) + 0.5) / (200 * cells) * nyquist
    return np.exp(-4 * np.pi**2 * sigma**2 * f**2).reshape(cells, 200).mean(axis=1)


@pytest.mark.parametrize("axes", ["mirrored", "periodic"])
@pytest.mark.parametrize(("rows", "columns"), [(300, 257), (255, 400)])
def test_behind_a_filter(work, axes, rows, columns):
    power = NoisePower.white(rows, columns, 3.0).filtered(
        work, BLUR, Grid(rows, columns, 1.0, 1.25), axes
    )
    found = spectrum_of([power], cells=20)
    assert found.shape == (20, 20)
    truth = 3.0 * np.outer(mean_power(0.4, 0.4, 20), mean_power(0.6, 0.5, 20))
    np.testing.assert_allclose(found, truth, rtol=0.02)


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
    if axes == "mirrored":  # and the mirror image of each sample, at −1 − x
        matrix = matrix + spread[(x[:, None] + x + 1) % period]
    return matrix


SMALL = [(1, 1), (1, 7), (13, 1), (2, 3), (5, 8), (11, 47), (48, 49), (80, 80), (53, 94), (97, 64)]


@pytest.mark.parametrize("axes", ["mirrored", "periodic"])
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
        cosines = np.apply_along_axis(lambda p, c=cells: in_cells(p, "mirrored", c), axis, cosines)
    along, across = (
        in_cells(amplitude_power(blurring(n, s, d, "periodic"), "periodic"), "periodic", min(48, n))
        for n, s, d in ((rows, 0.4, 1.25), (columns, 0.6, 1.0))
    )
    truth = cosines + 3.0 * np.outer(along, across)
    np.testing.assert_allclose(np.broadcast_to(found, truth.shape), truth, rtol=1e-10)
