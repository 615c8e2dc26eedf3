"""Read-out artefacts against charges that are moved one transfer, or one spill, at a time."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from scipy import special

from core.errors import ParameterError
from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from core.physics.detector.readout import (
    bloomed,
    dwell_time_s,
    mirror_scan_velocity_mrad_per_s,
    noise_bandwidth_hz,
    persistence,
    quantization_rms,
    quantize,
    rounding_variances,
    smear,
    smear_mtf,
    trail_length,
    trailed,
)
from core.physics.sampling.detector_sampling import interval_mrad


def frames_transferred(light, ratio):
    """The second frame of a frame-transfer CCD whose storage lies below: shift, wait, expose."""
    image = np.zeros_like(light)
    for _ in range(2):
        image = image + light
        storage = np.zeros_like(light)
        for shift in range(len(light)):
            storage = np.vstack([image[-1:], storage[:-1]])
            image = np.vstack([np.zeros_like(image[:1]), image[:-1]])
            if shift < len(light) - 1:  # the exposure follows the last shift at once
                image = image + ratio * light
    return storage


def test_smear_is_what_packets_collect_on_their_way():
    light = np.random.default_rng(3).random((12, 4))
    expected = frames_transferred(light, 0.01)
    total = light.sum(axis=0)
    for split in (0, 5):
        how = {"total": total, "ratio": 0.01, "above": True, "below": True}
        parts = [
            smear(charge=light[:split], passed=0.0 * total, **how),
            smear(charge=light[split:], passed=light[:split].sum(axis=0), **how),
        ]
        np.testing.assert_allclose(light + np.concatenate(parts), expected, rtol=0, atol=1e-14)


def test_the_contrast_behind_smear_is_the_mean_over_the_rows():
    rows, ratio, frequency = 9, 0.03, np.array([0.0, 0.04, 0.21, 0.5])
    waves = np.exp(2j * np.pi * np.outer(np.arange(rows), frequency))
    added = ratio * (waves.sum(axis=0) - waves)
    found = ((waves + added) / waves).mean(axis=0).real / (1 + ratio * (rows - 1))
    mtf = smear_mtf(frequency=frequency / 0.1, interval_mrad=0.1, rows=rows, ratio=ratio, sides=2)
    np.testing.assert_allclose(mtf, found, rtol=1e-13)


def spilled(charge, well):
    """Every full pixel passes half of its excess to either side, until there is none left."""
    charge, lost = np.array(charge, float), 0.0
    while (excess := np.maximum(charge - well, 0.0)).max() > 1e-12:
        charge -= excess
        charge[1:] += excess[:-1] / 2
        charge[:-1] += excess[1:] / 2
        lost += (excess[0] + excess[-1]) / 2
    return charge, lost


@pytest.mark.parametrize(
    "charge",
    [
        [0, 0.5, 9, 0.2, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 3, 0.9, 0.9, 3, 0, 0],
        np.random.default_rng(5).exponential(0.45, 60),
        [7],
    ],
)
def test_blooming_is_where_spills_end_and_loses_nothing_on_the_way(charge):
    expected, lost = spilled(charge, 1.0)
    found = bloomed(charge=charge, full_well=1.0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)
    assert found.max() == 1.0
    assert np.sum(charge) - found.sum() == pytest.approx(lost, abs=1e-10)
    np.testing.assert_allclose(
        bloomed(charge=charge[::-1], full_well=1.0)[::-1], found, rtol=0, atol=1e-12
    )


def test_blooming_by_hand():
    spread = bloomed(charge=[0, 0, 3, 0, 0.25, 0.5], full_well=1.0)
    np.testing.assert_allclose(spread, [0, 1, 1, 1, 0.25, 0.5], rtol=0, atol=1e-15)
    drained = bloomed(charge=[0.1, 0, 3, 0, 0.25, 0.5], full_well=1.0, drained=0.75)
    np.testing.assert_allclose(drained, [0.1, 0.25, 1, 0.25, 0.25, 0.5], rtol=0, atol=1e-15)
    untouched = np.random.default_rng(1).random(30)
    np.testing.assert_array_equal(bloomed(charge=untouched, full_well=1.0), untouched)


def register_read(charge, efficiency, nearest):
    """A register clocked pixel by pixel; what stays behind joins the next packet."""
    register = np.concatenate([np.zeros((nearest, charge.shape[1])), charge])
    read = []
    for _ in register:
        moved, register = efficiency * register, (1 - efficiency) * register
        read.append(moved[0])
        register[:-1] += moved[1:]
    return np.array(read)[nearest:]


@pytest.mark.parametrize(
    ("efficiency", "nearest", "pixels"),
    [(0.999, 0, 200), (0.98, 7, 150), (0.5, 0, 50), (0.99999, 300, 90), (1.0, 2, 9)],
)
def test_trails_are_those_of_a_register_clocked_pixel_by_pixel(efficiency, nearest, pixels):
    charge = np.random.default_rng(4).random((pixels, 2))
    length = trail_length(transfers=pixels + nearest, efficiency=efficiency)
    found = trailed(charge=charge, efficiency=efficiency, length=length, nearest=nearest)
    np.testing.assert_allclose(
        found, register_read(charge, efficiency, nearest), rtol=0, atol=5e-13
    )
    start = min(40, pixels // 2)
    skip = min(length, start)
    part = trailed(
        charge=charge[start - skip :],
        efficiency=efficiency,
        length=length,
        nearest=nearest + start - skip,
        skip=skip,
    )
    np.testing.assert_array_equal(part, found[start:])


def test_lag_by_hand():
    left = persistence(
        shares=(0.02, 0.01), time_constants_s=(1 / np.log(2), 3 / np.log(2)), delay_s=3
    )
    assert left == pytest.approx(0.02 / 8 + 0.01 / 2, rel=1e-14)


# Charge transfer, amplifier, post filters and periodic noise against independent truth.

_PHASES = np.array([-math.pi, -1.0, -1e-5, 0.0, 1e-200, 1e-8, 0.3, 0.99, 1.01, 2.0, math.pi])


@pytest.mark.parametrize("efficiency", ["0.99999", "0.999999999999", "0.5", "1e-12"])
@pytest.mark.parametrize("transfers", [1, 640, 10**6])
def test_exact_transfer_equals_the_product_of_its_transfers(efficiency, transfers):
    given_ = {
        "phase_per_transfer": _PHASES,
        "transfers": transfers,
        "efficiency": float(efficiency),
    }
    mtf, ptf = charge_transfer_mtf(**given_), charge_transfer_ptf(**given_)
    with mpmath.workdps(50):
        eps = mpmath.mpf(efficiency)
        for w, modulus, phase in zip(_PHASES, mtf, ptf, strict=True):
            one = eps / (1 - (1 - eps) * mpmath.expj(-mpmath.mpf(float(w))))
            truth = mpmath.exp(transfers * mpmath.log(abs(one)))
            assert modulus == pytest.approx(float(truth), rel=1e-11, abs=1e-300)
            truth_phase = float(transfers * mpmath.arg(one))
            assert phase == pytest.approx(truth_phase, rel=1e-13, abs=1e-300)


def test_published_and_leading_phases_keep_their_digits():
    for w in _PHASES:
        with mpmath.workdps(40):
            lost = mpmath.mpf("0.00001") * 640
            published = -lost * (mpmath.mpf(w) - mpmath.sin(mpmath.mpf(w)))
            leading = -lost * mpmath.sin(mpmath.mpf(w))
            modulus = mpmath.exp(-lost * (1 - mpmath.cos(mpmath.mpf(w))))
        given_ = {"phase_per_transfer": w, "transfers": 640, "efficiency": 0.99999}
        for model, truth in (("published", published), ("leading", leading)):
            ptf = charge_transfer_ptf(**given_, model=model)
            assert ptf == pytest.approx(float(truth), rel=1e-14, abs=1e-300)
            mtf = charge_transfer_mtf(**given_, model=model)
            assert mtf == pytest.approx(float(modulus), rel=1e-15)


@pytest.mark.parametrize(
    ("fov", "samples", "rate", "bandwidth"),
    [(30.0, 512, 16.0, 49152.0), (25.0, 1024, 40.0, 294912.0)],
)
def test_published_bandwidths(fov, samples, rate, bandwidth):
    time = dwell_time_s(
        interval_mrad=interval_mrad(fov_deg=fov, samples=samples),
        scan_velocity_mrad_per_s=mirror_scan_velocity_mrad_per_s(scan_mirror_rate_Hz=rate),
    )
    assert noise_bandwidth_hz(time_constant_s=time) == pytest.approx(bandwidth, rel=1e-15)


# Quantization against exact rational arithmetic, its rounding errors against integrals.

_BITS = [1, 4, 6, 8, 12, 16, 24, 32, 64]


def _samples(dtype, low, high):
    span = high - low
    generator = np.random.default_rng(7)
    return generator.uniform(low - 0.1 * span, high + 0.1 * span, (37, 11)).astype(dtype)


@pytest.mark.parametrize("bits", _BITS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (29.7, 41.3), (-1e30, 1e30), (0.0, 1e-30)])
def test_each_sample_goes_to_the_nearest_level(bits, dtype, low, high):
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


@pytest.mark.parametrize(
    ("bits", "low", "high"),
    [(4, 14.3, 48.6), (4, 13.4, 28.8), (6, 5.4, 23.7), (12, 11.9, 29.7), (16, 5.4, 24.2)],
)
def test_the_last_level_is_the_end_of_the_range_to_the_bit(bits, low, high):
    """2^b − 1 rounded steps end below the range here; the level before keeps its place."""
    count = 2**bits - 1
    step = (high - low) / count
    assert low + count * step < high
    got = quantize(np.array([high, high - step, 1e9]), bits=bits, low=low, high=high)
    assert got[0] == got[2] == high
    before = Fraction(high) - (Fraction(high) - Fraction(low)) / count
    assert got[1] == pytest.approx(float(before), rel=4e-16)


def test_constant_image_and_zero_bits_change_nothing():
    flat = np.full((5, 4), 0.1, dtype=np.float32)
    np.testing.assert_array_equal(quantize(flat, bits=8, low=0.1, high=0.1), flat)
    ramp = np.arange(12.0).reshape(3, 4)
    np.testing.assert_array_equal(quantize(ramp, bits=0, low=0.0, high=5.0), ramp)


@pytest.mark.parametrize("shape", [(), (0,), (1, 1), (1, 70001), (70001, 1), (300, 301)])
def test_every_shape_in_place_and_strided(shape):
    samples = np.random.default_rng(5).uniform(0.0, 1.0, shape)
    truth = np.rint(samples * 15.0) / 15.0
    np.testing.assert_allclose(quantize(samples, bits=4, low=0.0, high=1.0), truth, atol=1e-15)
    turned = quantize(samples.T, bits=4, low=0.0, high=1.0)
    np.testing.assert_allclose(turned, truth.T, atol=1e-15)


@pytest.mark.parametrize("scale", [1e-30, 1.0, 1e30])
def test_rms_of_the_difference(scale):
    generator = np.random.default_rng(11)
    before, after = generator.normal(size=(2, 301, 400))
    difference = (before - after).ravel().tolist()
    truth = math.sqrt(math.fsum(d * d for d in difference) / len(difference)) * scale
    got = quantization_rms(original=before * scale, quantized=after * scale)
    assert got == pytest.approx(truth, rel=1e-13)
    assert quantization_rms(original=before, quantized=before) == 0.0


def test_what_cannot_be_used_is_refused():
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


@pytest.mark.parametrize(("step", "variance"), [(0.0, 1.0), (1.0, -1.0), (1.0, math.inf)])
def test_refused(step, variance):
    with pytest.raises(ParameterError):
        rounding_variances(step=step, noise_variance=variance)
