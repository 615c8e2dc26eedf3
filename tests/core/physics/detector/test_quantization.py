"""Quantization against exact rational arithmetic, its rounding errors against integrals."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import special

from core.errors import ParameterError
from core.physics.detector.readout import quantization_rms, quantize, rounding_variances

_BITS = [1, 4, 6, 8, 12, 16, 24, 32, 64]


def _samples(dtype: type, low: float, high: float) -> np.ndarray:
    span = high - low
    generator = np.random.default_rng(7)
    return generator.uniform(low - 0.1 * span, high + 0.1 * span, (37, 11)).astype(dtype)


@pytest.mark.parametrize("bits", _BITS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (29.7, 41.3), (-1e30, 1e30), (0.0, 1e-30)])
def test_each_sample_goes_to_the_nearest_level(
    bits: int, dtype: type, low: float, high: float
) -> None:
    samples = _samples(dtype, low, high)
    got = quantize(samples, bits=bits, low=low, high=high)
    assert got.dtype == dtype
    step = (Fraction(high) - Fraction(low)) / (2**bits - 1)
    rounding = Fraction(2.0 * float(np.finfo(dtype).eps) * max(abs(low), abs(high)))
    for sample, value in zip(samples.ravel().tolist(), got.ravel().tolist(), strict=True):
        inside = min(max(Fraction(sample), Fraction(low)), Fraction(high))
        level = Fraction(low) + round((inside - Fraction(low)) / step) * step
        assert abs(Fraction(value) - level) <= rounding or (
            abs(abs(inside - Fraction(value)) - step / 2) <= rounding
        )
        assert abs(Fraction(value) - inside) <= step / 2 + rounding


@pytest.mark.parametrize("bits", _BITS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_both_ends_are_levels(bits: int, dtype: type) -> None:
    low, high = float(dtype(29.7)), float(dtype(41.3))
    ends = np.array([low, high, -1e9, 1e9], dtype=dtype)
    got = quantize(ends, bits=bits, low=low, high=high)
    np.testing.assert_array_equal(got, np.array([low, high, low, high], dtype=dtype))


@pytest.mark.parametrize(
    ("bits", "low", "high"),
    [(4, 14.3, 48.6), (4, 13.4, 28.8), (6, 5.4, 23.7), (12, 11.9, 29.7), (16, 5.4, 24.2)],
)
def test_the_last_level_is_the_end_of_the_range_to_the_bit(
    bits: int, low: float, high: float
) -> None:
    """2^b − 1 rounded steps end below the range here; the level before keeps its place."""
    count = 2**bits - 1
    step = (high - low) / count
    assert low + count * step < high
    got = quantize(np.array([high, high - step, 1e9]), bits=bits, low=low, high=high)
    assert got[0] == got[2] == high
    before = Fraction(high) - (Fraction(high) - Fraction(low)) / count
    assert got[1] == pytest.approx(float(before), rel=4e-16)


def test_number_of_levels() -> None:
    ramp = np.linspace(-3.0, 5.0, 5001)
    for bits in (1, 4, 8):
        got = np.unique(quantize(ramp, bits=bits, low=-3.0, high=5.0))
        np.testing.assert_allclose(got, np.linspace(-3.0, 5.0, 2**bits), rtol=0.0, atol=1e-14)


@given(
    values=st.lists(st.floats(-1e300, 1e300), min_size=1, max_size=20),
    bits=st.integers(0, 64),
)
def test_never_worse_than_half_a_step(values: list[float], bits: int) -> None:
    samples = np.array(values)
    low, high = float(samples.min()), float(samples.max())
    got = quantize(samples, bits=bits, low=low, high=high)
    half = 0.5 * (high - low) / (2**bits - 1) if bits else 0.0
    rounding = 4e-16 * max(abs(low), abs(high)) + 1e-300
    assert np.all(np.abs(got - samples) <= half * (1.0 + 1e-12) + rounding)
    assert np.all((got >= low) & (got <= high))


@pytest.mark.parametrize("bits", [32, 64])
def test_many_bits_alter_nothing_beyond_rounding(bits: int) -> None:
    samples = np.random.default_rng(3).normal(30.0, 2.0, (41, 3)).astype(np.float32)
    low, high = float(samples.min()), float(samples.max())
    np.testing.assert_array_max_ulp(quantize(samples, bits=bits, low=low, high=high), samples, 1)


def test_constant_image_and_zero_bits_change_nothing() -> None:
    flat = np.full((5, 4), 0.1, dtype=np.float32)
    np.testing.assert_array_equal(quantize(flat, bits=8, low=0.1, high=0.1), flat)
    ramp = np.arange(12.0).reshape(3, 4)
    np.testing.assert_array_equal(quantize(ramp, bits=0, low=0.0, high=5.0), ramp)


@pytest.mark.parametrize("shape", [(), (0,), (1, 1), (1, 70001), (70001, 1), (300, 301)])
def test_every_shape_in_place_and_strided(shape: tuple[int, ...]) -> None:
    samples = np.random.default_rng(5).uniform(0.0, 1.0, shape)
    truth = np.rint(samples * 15.0) / 15.0
    np.testing.assert_allclose(quantize(samples, bits=4, low=0.0, high=1.0), truth, atol=1e-15)
    turned = quantize(samples.T, bits=4, low=0.0, high=1.0)
    np.testing.assert_allclose(turned, truth.T, atol=1e-15)


@pytest.mark.parametrize("scale", [1e-30, 1.0, 1e30])
def test_rms_of_the_difference(scale: float) -> None:
    generator = np.random.default_rng(11)
    before, after = generator.normal(size=(2, 301, 400))
    difference = (before - after).ravel().tolist()
    truth = math.sqrt(math.fsum(d * d for d in difference) / len(difference)) * scale
    got = quantization_rms(original=before * scale, quantized=after * scale)
    assert got == pytest.approx(truth, rel=1e-13)
    assert quantization_rms(original=before, quantized=before) == 0.0


def test_uniform_samples_have_a_twelfth_of_the_squared_step() -> None:
    per_level = 4000  # midpoints that fill each level's cell: q²/12·(1 − 1/4000²)
    ramp = (np.arange(63 * per_level) + 0.5) / (63 * per_level)
    rms = quantization_rms(original=ramp, quantized=quantize(ramp, bits=6, low=0.0, high=1.0))
    assert rms == pytest.approx(math.sqrt((1.0 - per_level**-2.0) / 12.0) / 63.0, rel=1e-12)


def test_what_cannot_be_used_is_refused() -> None:
    ramp = np.arange(6.0)
    for given_ in (
        {"bits": 8, "low": 1.0, "high": 0.0},
        {"bits": 8, "low": math.nan, "high": 1.0},
        {"bits": 8, "low": -1.7e308, "high": 1.7e308},
    ):
        with pytest.raises(ParameterError, match="is not allowed"):
            quantize(ramp, **given_)
    with pytest.raises(ParameterError, match="float32"):
        quantize(ramp.astype(np.float32), bits=8, low=0.0, high=1e300)


# Rounding errors stirred by noise, against integrals over what is rounded and the noise.


def fixed_by_integration(step, sigma):
    """Mean square of the mean error of s + noise over s in one step, by normal integrals.

    The mean of round(s + n) − n over normal n is Σ of levels × the chance to fall in each cell.
    """

    s = step * (np.arange(20_000) / 20_000 - 0.5)  # periodic and smooth: equal steps sum exactly
    reach = int(10 * sigma / step) + 2
    levels = step * np.arange(-reach, reach + 1)[:, np.newaxis]
    low, high = levels - 0.5 * step - s, levels + 0.5 * step - s
    mean = (levels * (special.ndtr(high / sigma) - special.ndtr(low / sigma))).sum(axis=0)
    return np.mean((mean - s) ** 2)


@pytest.mark.parametrize("sigma", [0.02, 0.05, 0.079, 0.08, 0.1, 0.2, 0.3, 0.5])
def test_against_integration(sigma):
    step = 1.7
    temporal, fixed = rounding_variances(step=step, noise_variance=(sigma * step) ** 2)
    expected = fixed_by_integration(step, sigma * step)
    assert fixed == pytest.approx(expected, rel=1e-6, abs=1e-12)
    assert temporal + fixed == pytest.approx(step**2 / 12, rel=1e-15)


def test_limits():
    assert rounding_variances(step=2.0, noise_variance=0.0) == (0.0, pytest.approx(1 / 3))
    assert rounding_variances(step=2.0, noise_variance=1e6) == (pytest.approx(1 / 3), 0.0)


def test_both_forms_meet():
    step = 1.0
    edge = 0.25 / (4 * math.pi**2)
    below, above = (
        rounding_variances(step=step, noise_variance=edge * (1 + sign * 1e-12))[1]
        for sign in (-1, 1)
    )
    assert below == pytest.approx(above, rel=1e-10)


def test_against_draws():
    rng = np.random.default_rng(5)
    s = rng.uniform(0, 1, 4000)
    frames = np.round(s + 0.25 * rng.standard_normal((400, 4000)))
    temporal, fixed = rounding_variances(step=1.0, noise_variance=0.0625)
    changing = frames.var(axis=0, ddof=1).mean()
    assert changing == pytest.approx(0.0625 + temporal, rel=0.01)
    still = (frames.mean(axis=0) - s).var() - changing / 400
    assert still == pytest.approx(fixed, rel=0.1)


@pytest.mark.parametrize(("step", "variance"), [(0.0, 1.0), (1.0, -1.0), (1.0, math.inf)])
def test_refused(step, variance):
    with pytest.raises(ParameterError):
        rounding_variances(step=step, noise_variance=variance)
