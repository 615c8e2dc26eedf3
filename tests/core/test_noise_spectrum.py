"""Spectra of filtered noise in cells, against the filter's power and one wave."""

import numpy as np
import pytest
import scipy.fft

from core.engine import Engine
from core.grid import Grid
from core.noise_power import NoisePower
from core.noise_spectrum import spectrum_of
from core.physics.gaussian import gaussian_mtf
from core.policy import Policy
from nodes.laws import separable
from nodes.library import standard_library

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


def test_all_cells_have_the_power_of_all_waves(work):
    grid = Grid(64, 48, 1.0, 1.25)
    coloured = NoisePower.white(64, 48, 2.0).filtered(work, BLUR, grid, "periodic")
    found = spectrum_of([coloured, NoisePower.white(64, 48, 0.5)], cells=16)
    assert found.mean() == pytest.approx(coloured.moments().sample + 0.5, rel=1e-12)


def test_of_a_pattern_of_one_frequency():
    """cos(2π·5·x/40) of 40 columns is wave 10 of 40: a quarter of Nyquist, in cell 2 of 8."""
    samples = np.tile(np.cos(2 * np.pi * 5 * (np.arange(40) + 0.5) / 40), (6, 1))
    amplitudes = scipy.fft.dctn(samples, type=2, norm="ortho")
    assert np.argmax(np.abs(amplitudes[0])) == 10
    found = spectrum_of([NoisePower.of_pattern(samples)], cells=8)
    lit = np.flatnonzero(found.sum(axis=0) > 1e-9 * found.sum())
    assert list(lit) == [1, 2]  # half of the wave's band on each side of 2/8


def test_of_no_noise():
    assert spectrum_of([]) is None
    assert spectrum_of([NoisePower.white(4, 4, 0.0)]) is None
