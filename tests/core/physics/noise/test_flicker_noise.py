"""1/f noise: its spectrum, covariance and distribution against closed forms."""

import numpy as np
import pytest
from scipy import special, stats

from core.errors import DataError
from core.physics.detector.readout import apply_gain_bias
from core.physics.noise.flicker_noise import (
    SMALL_MEAN,
    flicker_band,
    flicker_sigma,
    flicker_waves,
    photon_means,
    poisson_of_normal,
    published_means,
    wave_at,
)

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
            wave = flicker_waves(band=band, stratum=stratum, place=place, level=level)
            time = (start + number) / RATE
            made[number] += wave_at(
                time_s=time, frequency_hz=wave[0], amplitude=wave[1], phase=phase
            )
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


# Poisson counts of normal deviates: quantiles, distribution and moments against scipy's.


def chances(mean):
    """Probability of counts 0, 1, 2 … by the deviates at which the count steps, bisected."""
    count = np.arange(0, int(mean + 8 * np.sqrt(mean) + 12))
    low, high = np.full(count.size, -9.0), np.full(count.size, 9.0)
    means = np.full(count.size, float(mean))
    for _ in range(70):
        middle = (low + high) / 2
        below = poisson_of_normal(means, middle) < count
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return count, np.diff(np.append(special.ndtr(low), 1.0))


@pytest.mark.parametrize(
    ("mean", "distance"),
    [
        (0.01, 1e-12), (0.7, 1e-12), (3.0, 1e-12), (15.9, 1e-12), (16.0, 6e-5), (40.0, 2e-5),
        (63.9, 1e-5), (64.0, 4e-5), (200.0, 1e-5), (1e3, 1e-6), (1e4, 1e-7),
    ],
)  # fmt: skip
def test_total_variation_distance_from_the_poisson_distribution(mean, distance):
    count, found = chances(mean)
    assert 0.5 * np.abs(found - stats.poisson.pmf(count, mean)).sum() < distance


@pytest.mark.parametrize("mean", [2.0, 10.0, 500.0, 1e5])
def test_quantiles_in_the_tails(mean):
    z = np.array([-4.5, -3.0, -1.0, 0.0, 1.0, 3.0, 4.5])
    truth = stats.poisson.ppf(special.ndtr(z), mean)
    found = poisson_of_normal(np.full(7, mean), z)
    assert np.abs(found - truth).max() <= (0.0 if mean < SMALL_MEAN else 1.0)


def test_without_light_there_is_no_count_and_huge_means_do_no_harm():
    mean = np.array([-3.0, 0.0, 1e-300, 1e30])
    counts = poisson_of_normal(mean, np.array([3.0, 3.0, 3.0, -5.0]))
    assert counts[:3].tolist() == [0.0, 0.0, 0.0]
    assert counts[3] == pytest.approx(1e30, rel=1e-14)


# Gain and bias models, and the means of photon noise, against their formulas written out.


GIVEN = {"gain_percent": 1.0, "bias_percent": 2.0, "mean_radiance": 1.4}


@pytest.fixture
def picture():
    return np.linspace(0.5, 2.5, 20).reshape(4, 5)


@pytest.mark.parametrize("shape", [(), (1, 5), (4, 1), (4, 5)])
def test_models_with_any_pattern(picture, shape):
    rng = np.random.default_rng(1)
    n1, n2 = rng.standard_normal(shape), rng.standard_normal(shape)
    expected = {
        "per_pixel": picture * (1 + 0.01 * n1) + 0.02 * n2 * 1.4,
        "published": picture + (0.01 * n1 + 0.02 * n2) * 1.4,
        "literal": picture * (0.01 * 1.4) + 0.02 * 1.4,
    }
    for model, truth in expected.items():
        got = apply_gain_bias(picture, gain_pattern=n1, bias_pattern=n2, model=model, **GIVEN)
        np.testing.assert_allclose(got, truth, rtol=1e-14)
        single = apply_gain_bias(
            picture.astype(np.float32), gain_pattern=n1, bias_pattern=n2, model=model, **GIVEN
        )
        assert single.dtype == np.float32
        np.testing.assert_allclose(single, truth, rtol=1e-6)


def test_rounding_below_zero_is_zero_and_more_is_refused(picture):
    picture[1, 1] = -1e-7
    assert published_means(picture, percent=1.0)[1, 1] == 0.0
    picture[1, 1] = -0.1
    with pytest.raises(DataError, match="Means below 0: 1 of 20"):
        photon_means(picture, photons_per_unit=10.0)
    picture[1, 1] = np.nan
    with pytest.raises(DataError, match="not finite"):
        published_means(picture, percent=1.0)
