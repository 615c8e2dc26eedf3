"""1/f noise: its spectrum, covariance and distribution against closed forms."""

import numpy as np
import pytest
from scipy import special

from core.physics.noise.flicker_noise import flicker_band, flicker_sigma, flicker_wave

RATE = 30.0


def series(frames, samples, *, longest_s, seed=5, start=0):
    """Frames of independent samples, shape (frames, samples), of variance 1."""
    band = flicker_band(frame_rate_Hz=RATE, longest_period_s=longest_s)
    drawn = np.random.default_rng(seed)
    place = drawn.random(samples)
    waves = [(drawn.random(samples), drawn.random(samples)) for _ in range(band.strata)]
    made = np.zeros((frames, samples))
    for number in range(frames):
        for stratum, (level, phase) in enumerate(waves):
            made[number] += flicker_wave(
                band=band, stratum=stratum, time_s=(start + number) / RATE,
                place=place, level=level, phase=phase,
            )  # fmt: skip
    return made / band.strata**0.5


@pytest.mark.parametrize("lag", [1, 2, 5, 17, 100])
def test_the_covariance_is_that_of_the_spectrum(lag):
    """The cosine transform of 1/f between two frequencies: cosine integrals at its ends."""
    count = 200_000
    values = series(1, count, longest_s=50.0)[0], series(1, count, longest_s=50.0, start=lag)[0]
    turns = 2 * np.pi * lag / RATE
    _, high = special.sici(turns * RATE / 2)
    _, low = special.sici(turns / 50.0)
    expected = (high - low) / np.log(RATE / 2 * 50.0)
    assert np.mean(values[0] * values[1]) == pytest.approx(expected, abs=4.5 / count**0.5)


def test_the_densities_meet_at_the_corner():
    """White noise of a frame has the density σ²/(rate/2)."""
    band = flicker_band(frame_rate_Hz=RATE, longest_period_s=200.0)
    sigma = flicker_sigma(white_sigma=0.3, corner_Hz=2.5, band=band)
    at_corner = sigma**2 / (2.5 * np.log(15.0 * 200.0))
    assert at_corner == pytest.approx(0.3**2 / 15.0, rel=1e-12)
    assert flicker_sigma(white_sigma=0.3, corner_Hz=0.0, band=band) == 0.0
