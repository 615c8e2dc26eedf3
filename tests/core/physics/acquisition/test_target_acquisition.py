"""Johnson's criteria: probabilities, resolvable cycles and ranges, by hand and in closed form."""

import math

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.special import lambertw

from core.errors import ParameterError
from core.physics.acquisition.target_acquisition import (
    apparent_difference,
    interpolated,
    johnson_probability,
    resolvable_cycles,
    resolvable_frequency,
    ttp_probability,
    ttp_values,
)
from core.physics.numerics import range_for_probability

mp.dps = 40
FUNCTIONS = [
    (lambda r: johnson_probability(cycles=r, n50=1.0), "2.7", "0.7"),
    (lambda r: ttp_probability(value=r, v50=1.0), "1.51", "0.24"),
]


def exact_probability(ratio, constant, slope):
    ratio = mpf(ratio)
    power = ratio ** (mpf(constant) + mpf(slope) * ratio)
    return power / (1 + power)


@pytest.mark.parametrize(("probability", "constant", "slope"), FUNCTIONS)
def test_probability_to_full_precision(probability, constant, slope):
    for ratio in [1e-9, 1e-3, 0.1, 0.5, 0.999999, 1.000001, 1.5, 2.0, 3.0, 7.5, 60.0]:
        exact = exact_probability(ratio, constant, slope)
        assert probability(ratio) == pytest.approx(float(exact), rel=2e-14, abs=0)


@pytest.mark.parametrize(("probability", "constant", "slope"), FUNCTIONS)
def test_probability_at_its_limits(probability, constant, slope):
    assert probability(0.0) == 0.0
    assert probability(1.0) == 0.5
    np.testing.assert_array_equal(probability([1e3, 1e300, np.inf]), 1.0)
    assert probability(5e-324) == 0.0


# Staring array, 3 to 5 µm: a pitch of 25 µm behind 200 mm, 0.125 mrad: Nyquist at 4 cyc/mrad.
# MRTD 0.02 K at 1, 0.08 K at 2 and 0.64 K at 4 cyc/mrad. A vehicle 2.3 m high, 2 K warmer, 0.3/km.
STARING = {"frequency": [1.0, 2.0, 4.0], "mrtd_K": [0.02, 0.08, 0.64]}
VEHICLE = {"delta_K": 2.0, "target_size_m": 2.3, "extinction_per_km": 0.3}


def test_apparent_difference_of_a_cold_target():
    # Beer and Lambert: ln 2 over 1/km and 1 km halves.
    found = apparent_difference(delta_K=[-3.0, 3.0], extinction_per_km=math.log(2), range_m=1000)
    np.testing.assert_allclose(found, [-1.5, 1.5], rtol=1e-15)
    warm = resolvable_cycles(**STARING, **VEHICLE, range_m=4000)
    cold = resolvable_cycles(**STARING, **{**VEHICLE, "delta_K": -2.0}, range_m=4000)
    assert warm == cold


@pytest.mark.parametrize(
    ("curve", "apparent", "expected"),
    [
        ([0.1, 0.2, 0.4], 0.05, 0.0),  # below all of it
        ([0.1, 0.2, 0.4], 0.1, 1.0),  # at a sample
        ([0.1, 0.2, 0.4], 0.4, 4.0),  # at the last
        ([0.1, 0.2, 0.4], 9.0, 4.0),  # above all of it
        ([0.4, 0.1, 0.4], 0.2, 2 * math.sqrt(2)),  # crossed twice: the higher
        ([0.1, 0.4, 0.1], 0.2, 4.0),  # reached again
        ([0.1, 0.2, np.inf], 0.3, 2.0),  # an infinite one ends the curve
        ([np.inf, 0.1, 0.2], 0.1, 2.0),  # and may begin it
        ([np.inf, np.inf, np.inf], 9.0, 0.0),
        ([0.0, 0.2, 0.4], 0.1, 1.5),  # from zero it is linear
        ([0.0, 0.0, 0.0], 0.0, 4.0),
        ([0.2, 0.2, 0.2], 0.2, 4.0),
    ],
)
def test_highest_frequency_that_is_resolved(curve, apparent, expected):
    found = resolvable_frequency(frequency=[1.0, 2.0, 4.0], mrtd_K=curve, apparent_K=apparent)
    assert found == pytest.approx(expected, rel=1e-12)


def johnson_range(*, n50, probability=0.5, **seen):
    """Where the probability of the cycles resolved falls to a value."""
    return range_for_probability(
        probability_at=lambda range_m: johnson_probability(
            cycles=resolvable_cycles(**seen, range_m=range_m), n50=n50
        ),
        probability=probability,
    )


# With MRTD = k·f, N = ΔT·e^(−βR)/k · 1000·s/R falls to r·N50 where R·e^(βR) = 1000·s·ΔT/(k·r·N50).
@pytest.mark.parametrize("beta", [0.0, 0.05, 0.7])
@pytest.mark.parametrize("wanted", [0.1, 0.5, 0.9])
def test_range_in_closed_form(beta, wanted):
    ratio = float(mp.findroot(lambda r: exact_probability(r, "2.7", "0.7") - mpf(wanted), 1))
    frequency = np.linspace(0, 50, 11)
    found = johnson_range(
        frequency=frequency, mrtd_K=0.3 * frequency, delta_K=1.5, target_size_m=2.3, n50=3.0,
        probability=wanted, extinction_per_km=beta,
    )  # fmt: skip
    clear_m = 1000 * 2.3 * 1.5 / (0.3 * ratio * 3.0)
    km = clear_m / 1000
    expected = clear_m if beta == 0 else 1000 * float(lambertw(beta * km).real) / beta
    assert found == pytest.approx(expected, rel=1e-11)


def test_range_where_the_probability_jumps():
    """Beyond ln 10/0.3 km the difference of 2 K is below all of the MRTD, 0.2 K."""
    found = johnson_range(
        frequency=[1.0, 4.0], mrtd_K=[0.2, 0.3], **{**VEHICLE, "target_size_m": 300.0}, n50=1.0
    )
    assert found == pytest.approx(1000 * math.log(10) / 0.3, rel=1e-12)


def test_range_never_reached_and_never_left():
    assert johnson_range(**STARING, delta_K=0.01, target_size_m=2.3, n50=1) is None
    assert range_for_probability(probability_at=lambda _: 0.49, probability=0.5) is None
    assert range_for_probability(probability_at=lambda _: 0.51, probability=0.5) == math.inf


# TTP values and ranges, by hand, in closed form and against quadrature in 30 digits.

mp.dps = 30
UNIT = {"target_area_m2": 1.0, "range_m": 1000.0}  # 1 mrad: V is the sum itself


def ttp_value(*, frequency, ctf, contrast, target_area_m2, range_m):
    return ttp_values(frequency=frequency, ctf=ctf)(contrast, target_area_m2, range_m)


def exponential(frequency):
    return 0.02 * np.exp(6 * frequency)


@pytest.mark.parametrize("count", [2, 7, 65])
@pytest.mark.parametrize("contrast", [0.0200001, 0.03, 0.4, 5.0])
def test_exponential_threshold_in_closed_form(count, contrast):
    """∫√(C/CTF) df from 0 to where C = CTF is 2/6·(√(C/0.02) − 1)."""
    frequency = np.linspace(0, 1, count)
    exact = 2 / mpf(6) * (mp.sqrt(mpf(contrast) / mpf("0.02")) - 1)
    ctf = exponential(frequency)
    value = ttp_value(frequency=frequency, ctf=ctf, contrast=contrast, **UNIT)
    assert value == pytest.approx(float(exact), rel=2e-13, abs=1e-13)


def test_sum_ends_with_the_curve():
    """No crossing up to 0.25 cyc/mrad: 2/6·√(C/0.02)·(1 − e^(−6·0.25/2))."""
    exact = 2 / 6 * math.sqrt(5.0 / 0.02) * -math.expm1(-0.75)
    frequency = np.array([0.0, 0.1, 0.25])
    value = ttp_value(frequency=frequency, ctf=exponential(frequency), contrast=5.0, **UNIT)
    assert value == pytest.approx(exact, rel=1e-13)


def hollow(frequency):
    """A threshold that is seen only between two frequencies: 0.01·(f/0.3 + 0.3/f)·e^(3f)."""
    return 0.01 * (frequency / 0.3 + 0.3 / frequency) * np.exp(3 * frequency)


@pytest.mark.parametrize("contrast", [0.05, 0.3, 3.0])
def test_threshold_crossed_twice(contrast):
    def exact_threshold(f):
        return mpf("0.01") * (f / mpf("0.3") + mpf("0.3") / f) * mp.exp(3 * f)

    level = mpf(contrast)
    low = mp.findroot(lambda f: exact_threshold(f) - level, (mpf("1e-6"), mpf("0.2")), "anderson")
    high = mp.findroot(lambda f: exact_threshold(f) - level, (mpf("0.2"), mpf(3)), "anderson")
    exact = mp.quad(lambda f: mp.sqrt(level / exact_threshold(f)), mp.linspace(low, high, 9))
    frequency = np.linspace(0, 3, 301)
    with np.errstate(divide="ignore"):
        samples = hollow(frequency)
    assert np.isinf(samples[0])
    value = ttp_value(frequency=frequency, ctf=samples, contrast=contrast, **UNIT)
    assert value == pytest.approx(float(exact), rel=2e-5)


def mrtd(frequency):
    """As the static models have it: the frequency over an MTF, of a Gaussian and a detector."""
    return 0.05 * frequency * np.exp(8 * frequency**2) / np.sinc(frequency)


def test_samples_of_an_mrtd_and_their_error():
    """From zero as f, to infinity where the MTF is zero; the error falls as the step's cube."""

    def exact_threshold(f):
        return mpf("0.05") * f * mp.exp(8 * f**2) / (mp.sinc(mp.pi * f))

    end = mp.findroot(lambda f: exact_threshold(f) - 2, (mpf("0.1"), mpf("0.9")), "anderson")
    exact = mp.quad(lambda u: mp.sqrt(2 / exact_threshold(u * u)) * 2 * u, [0, mp.sqrt(end)])
    errors = []
    for count in (17, 33, 65):
        frequency = np.linspace(0, 1, count)
        samples = mrtd(frequency)
        samples[-1] = np.inf
        value = ttp_value(frequency=frequency, ctf=samples, contrast=2.0, **UNIT)
        errors.append(abs(value / float(exact) - 1))
    assert errors[0] < 1e-4
    assert errors[2] < errors[0] / 30


def test_what_is_infinite_is_not_seen():
    frequency = np.linspace(0, 4, 9)
    ctf = np.where((frequency >= 1) & (frequency <= 2), 0.25, np.inf)
    value = ttp_value(frequency=frequency, ctf=ctf, contrast=1.0, **UNIT)
    assert value == pytest.approx(2.0, rel=1e-14)  # √4·(2 − 1)
    assert ttp_value(frequency=frequency, ctf=np.full(9, np.inf), contrast=1.0, **UNIT) == 0.0
    assert ttp_value(frequency=frequency, ctf=np.full(9, 0.5), contrast=0.5, **UNIT) == 0.0


GOOD = {"frequency": [0.0, 1.0, 2.0], "ctf": [0.1, 0.2, 0.4], "contrast": 1.0, **UNIT}


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"frequency": [0.0, 2.0, 1.0]}, r"frequency\[2\]"),
        ({"frequency": [0.0]}, "frequency"),
        ({"ctf": [0.1, 0.2]}, "ctf"),
        ({"ctf": [0.1, 0.0, 0.4]}, r"ctf\[1\]"),
        ({"contrast": -1.0}, "contrast"),
        ({"target_area_m2": 0.0}, "target_area_m2"),
        ({"contrast": np.ones(2), "range_m": np.ones(3)}, r"\(2,\)"),
    ],
)
def test_what_is_out_of_range_is_refused_by_name(wrong, named):
    with pytest.raises(ParameterError, match=named):
        ttp_value(**{**GOOD, **wrong})


# A threshold between samples that lie unevenly.


FREQUENCY = np.array([0.5, 0.7, 1.4, 1.7, 3.0, 3.2])
BETWEEN = np.array([0.5, 0.6, 1.0, 1.55, 2.0, 2.9, 3.1, 3.2])


def level(frequency):
    return -2.0 + 0.8 * frequency + 0.3 * frequency**2


def test_a_quadratic_logarithm_is_met_at_uneven_samples():
    """A parabola through three of its points is the curve itself, and so is Hermite's cubic."""
    threshold = interpolated(frequency=FREQUENCY, ctf=np.exp(level(FREQUENCY)))
    assert threshold(BETWEEN) == pytest.approx(np.exp(level(BETWEEN)), rel=1e-13)


@pytest.mark.parametrize(("at_zero", "power"), [(0.0, 1.0), (np.inf, -1.0)])
def test_the_power_towards_zero_is_put_back(at_zero, power):
    """Rising as the frequency (MRTD) or falling as its inverse (eye), times that curve."""
    ctf = np.exp(level(FREQUENCY)) * FREQUENCY**power
    threshold = interpolated(frequency=np.append(0.0, FREQUENCY), ctf=np.append(at_zero, ctf))
    places = np.append(0.2, BETWEEN)
    assert threshold(places) == pytest.approx(np.exp(level(places)) * places**power, rel=1e-13)
