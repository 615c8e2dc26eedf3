"""Charge gain: excess noise against branching processes, deviates against simulated registers."""

import numpy as np
import pytest
from scipy import stats

from core.errors import ParameterError
from core.physics.detector.focal_plane_array import excess_noise_factor, multiplied_charge


def factor_of(charge_gain, factor, *, register_stages=536, ionization_ratio=0.0):
    return excess_noise_factor(
        charge_gain=charge_gain, factor=factor, register_stages=register_stages,
        ionization_ratio=ionization_ratio,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("gain", "stages"), [(1.0, 536), (1.9, 1), (4.0, 2), (50.0, 20), (1e3, 536)]
)
def test_a_register_is_a_branching_process(gain, stages):
    """Each electron becomes two with chance p in each stage: mean and variance stage by stage."""
    chance = gain ** (1 / stages) - 1
    mean, variance = 1.0, 0.0  # of one electron
    for _ in range(stages):
        variance = (1 + chance) ** 2 * variance + chance * (1 - chance) * mean
        mean *= 1 + chance
    # A Poisson number of electrons: variance of each plus its mean squared.
    wanted = (variance + mean**2) / mean**2
    assert factor_of("em_register", gain, register_stages=stages) == pytest.approx(wanted, rel=1e-9)


def test_factors_at_their_ends():
    assert factor_of("none", 7.0) == 1.0
    assert factor_of("photoconductive", 0.3) == 2.0
    assert factor_of("em_register", 1e4, register_stages=5000) == pytest.approx(2.0, abs=5e-3)
    # One kind of carrier: a Yule process, whose number is geometric, F = 1 + (M − 1)/M.
    assert factor_of("avalanche", 8.0) == pytest.approx(1 + 7 / 8)
    assert factor_of("avalanche", 8.0, ionization_ratio=1.0) == pytest.approx(8.0)  # F = M
    # McIntyre's silicon diode: 0.02·100 + 0.98·1.99
    assert factor_of("avalanche", 100.0, ionization_ratio=0.02) == pytest.approx(3.9502)


@pytest.mark.parametrize(
    ("kind", "gain", "line"),
    [("avalanche", 0.9, "at least 1"), ("em_register", 5.0, "at most 2 per register stage"),
     ("photoconductive", 0.0, "charge_gain_factor")],
)  # fmt: skip
def test_gains_that_are_refused(kind, gain, line):
    with pytest.raises(ParameterError, match=line):
        factor_of(kind, gain, register_stages=2)


@pytest.mark.parametrize("electrons", [1, 4])
def test_deviates_have_the_law_of_a_simulated_register(electrons):
    count, gain, stages = 20_000, 1000.0, 536
    random = np.random.default_rng(5)
    charge = np.full(count, electrons)
    for _ in range(stages):
        charge += random.binomial(charge, gain ** (1 / stages) - 1)
    made = multiplied_charge(
        electrons=np.full(count, float(electrons)), deviates=random.standard_normal(count),
        excess_noise_factor=factor_of("em_register", gain),
    )  # fmt: skip
    assert stats.ks_2samp(made, charge / gain).pvalue > 1e-3


@pytest.mark.parametrize("factor", [1.2, 2.0, 4.0])
@pytest.mark.parametrize("electrons", [0.4, 3.0, 60.0, 5000.0])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_mean_and_variance(electrons, factor, kind):
    """To 5 standard errors; the gamma law of shape a has a kurtosis of 6/a."""
    count, width = 200_000, factor - 1
    deviates = np.random.default_rng(8).standard_normal(count).astype(kind)
    made = multiplied_charge(
        electrons=np.full(count, electrons, kind), deviates=deviates, excess_noise_factor=factor
    )
    assert made.dtype == kind
    variance = width * electrons
    made = made.astype(np.float64)
    assert made.mean() == pytest.approx(electrons, abs=5 * np.sqrt(variance / count))
    error = variance * np.sqrt((2 + 6 * width / electrons) / count)
    assert made.var() == pytest.approx(variance, abs=5 * error)
