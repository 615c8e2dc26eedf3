"""1/f noise: its spectrum, covariance and distribution against closed forms."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import special, stats

from core.errors import ParameterError
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


def density(values):
    """One-sided power density of columns, by a Hann window; frequencies without the first few."""
    frames = len(values)
    window = np.hanning(frames + 1)[:-1]
    spectrum = np.abs(np.fft.rfft(values * window[:, np.newaxis], axis=0)) ** 2
    power = 2.0 * spectrum.mean(axis=1) / (RATE * np.sum(window**2))
    return np.fft.rfftfreq(frames, 1 / RATE), power


def test_the_slope_is_minus_one():
    """In bands of a third of an octave: of few waves a line the logarithm's mean is too low."""
    frequency, power = density(series(1024, 1500, longest_s=100.0))
    edges = 0.3 * 2.0 ** (np.arange(17) / 3)
    bands = [(frequency >= low) & (frequency < high) for low, high in pairwise(edges)]
    middle = np.sqrt(edges[1:] * edges[:-1])
    shown = np.array([np.mean(power[band] * frequency[band]) for band in bands])
    slope, _ = np.polyfit(np.log(middle), np.log(shown), 1)
    assert slope - 1.0 == pytest.approx(-1.0, abs=0.03)
    np.testing.assert_allclose(np.mean(shown), 1.0 / np.log(15.0 / 0.01), rtol=0.03)


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


def test_any_frame_is_normal_of_variance_one():
    for start in (0, -7, 123_456_789):
        values = series(1, 20_000, longest_s=3600.0, start=start)[0]
        assert stats.kstest(values, "norm").pvalue > 1e-3
        assert np.var(values) == pytest.approx(1.0, abs=0.05)


def test_the_densities_meet_at_the_corner():
    """White noise of a frame has the density σ²/(rate/2)."""
    band = flicker_band(frame_rate_Hz=RATE, longest_period_s=200.0)
    sigma = flicker_sigma(white_sigma=0.3, corner_Hz=2.5, band=band)
    at_corner = sigma**2 / (2.5 * np.log(15.0 * 200.0))
    assert at_corner == pytest.approx(0.3**2 / 15.0, rel=1e-12)
    assert flicker_sigma(white_sigma=0.3, corner_Hz=0.0, band=band) == 0.0


def test_a_period_of_two_frames_is_refused():
    with pytest.raises(ParameterError, match="longest_period_s"):
        flicker_band(frame_rate_Hz=RATE, longest_period_s=2 / RATE)
