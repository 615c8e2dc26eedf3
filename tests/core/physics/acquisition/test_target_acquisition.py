"""Johnson's criteria: probabilities, resolvable cycles and ranges, by hand and in closed form."""

import math

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.special import lambertw

from core.physics.acquisition.target_acquisition import (
    apparent_difference,
    johnson_probability,
    resolvable_cycles,
    resolvable_frequency,
    ttp_probability,
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


# Line scanner, 8 to 12 µm: detectors of 600 µm behind 130 mm, 4.615 mrad, so Nyquist is at
# 1/(2·4.615) = 0.1083 cyc/mrad. MRTD 0.4 K at 0.02, 1.5 K at 0.04 and 6 K at 0.08 cyc/mrad.
# A wall 20 m wide and 5 K warmer, at 402 m through air of 0.5/km:
#   e^(−0.5·0.402) = e^−0.201 = 0.8179124; 5 K · 0.8179124 = 4.0895622 K
#   between 0.04 and 0.08 the MRTD goes up fourfold, as the square of the frequency:
#   0.04·√(4.0895622/1.5) = 0.04·√2.7263749 = 0.04·1.6511738 = 0.06604695 cyc/mrad
#   20 m/402 m = 49.7512438 mrad; 0.06604695·49.7512438 = 3.2859179 cycles
#   r = 3.2859179/4 = 0.8214795; E = 2.7 + 0.5750356 = 3.2750356; ln r = −0.1966483
#   r^E = e^−0.6440303 = 0.5251716; P = 0.5251716/1.5251716 = 0.3443361
LINE_SCANNER = {"frequency": [0.02, 0.04, 0.08], "mrtd_K": [0.4, 1.5, 6.0]}


def test_line_scanner_by_hand():
    cycles = resolvable_cycles(
        **LINE_SCANNER, delta_K=5, target_size_m=20, range_m=402, extinction_per_km=0.5
    )
    assert cycles == pytest.approx(3.2859179, rel=2e-7)
    assert johnson_probability(cycles=cycles, n50=4) == pytest.approx(0.3443361, rel=3e-7)


# Staring array, 3 to 5 µm: a pitch of 25 µm behind 200 mm, 0.125 mrad: Nyquist at 4 cyc/mrad.
# MRTD 0.02 K at 1, 0.08 K at 2 and 0.64 K at 4 cyc/mrad. A vehicle 2.3 m high, 2 K warmer, 0.3/km.
# At 5 km: e^−1.5 = 0.2231302; apparent 0.4462603 K; the MRTD goes up eightfold, as the cube:
#   2·(0.4462603/0.08)^(1/3) = 2·5.5782540^(1/3) = 2·1.7735064 = 3.5470128 cyc/mrad
#   2.3/5000 = 0.46 mrad: 1.6316259 cycles; detection, N50 = 1: E = 3.8421381
#   ln 1.6316259 = 0.4895770; E·ln r = 1.8810225; P = 1/(1 + e^−1.8810225) = 1/1.1524342 = 0.8677285
# At 2 km: e^−0.6 = 0.5488116; apparent 1.0976233 K, above the whole curve: 4 cyc/mrad,
#   1.15 mrad·4 = 4.6 cycles.
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
        frequency=frequency,
        mrtd_K=0.3 * frequency,
        delta_K=1.5,
        target_size_m=2.3,
        n50=3.0,
        probability=wanted,
        extinction_per_km=beta,
    )
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
