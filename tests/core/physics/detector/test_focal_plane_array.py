"""Electrons and their noise against the reference values of 20 digits, and against quadrature."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from mpmath import mpf
from scipy import ndimage, stats
from scipy.integrate import quad

from core.errors import DataError, ParameterError
from core.physics.detector import focal_plane_array as array
from core.physics.detector.focal_plane_array import (
    DEAD,
    HOT,
    bad_pixel_places,
    bent_response,
    bent_slope,
    excess_noise_factor,
    lag_weights,
    multiplied_charge,
    netd_noise_radiance,
    one_point_offset,
    rule_07_A_per_cm2,
    rule_07_e_per_s,
    share_kept,
    two_point_gain,
    two_point_offset,
)
from core.physics.detector.photon_conversion import (
    PhotonWeights,
    QuantumEfficiency,
    conversion_between,
)
from core.physics.radiometry.planck import band_radiance, brightness_temperature
from reference_cases import CAMERA, reference_cases

REL = 1e-9
POINTS = ((3.2, 0.3), (3.6, 0.75), (4.4, 0.8), (5.0, 0.1))


def close(value):
    return pytest.approx(float(value), rel=REL, abs=0.0)


def photons(temperature_K, wavelength_um):
    """Spectral photon radiance in 30 digits, s⁻¹ m⁻² sr⁻¹ µm⁻¹."""
    h, c, k = mpf("6.62607015e-34"), mpf(299792458), mpf("1.380649e-23")
    metres = wavelength_um / mpf(10) ** 6
    x = h * c / (metres * k * mpf(temperature_K))
    return 2 * c / metres**4 / mpmath.expm1(x) / 10**6


def counted(temperature_K, low, high, points=None):
    """∫ QE·L_q dλ, between the corners of QE."""
    with mpmath.workdps(30):
        corners = [mpf(low), mpf(high)]
        if points:
            corners += [mpf(w) for w, _ in points if low < w < high]

        def efficiency(wavelength):
            if points is None:
                return mpf(1)
            for (a, qa), (b, qb) in pairwise(points):
                if a <= wavelength <= b:
                    return qa + (mpf(qb) - qa) * (wavelength - a) / (mpf(b) - a)
            return mpf(0)

        return (
            mpmath.quad(
                lambda w: photons(temperature_K, w) * efficiency(w) / mpf(10) ** 20, sorted(corners)
            )
            * mpf(10) ** 20
        )


@pytest.mark.parametrize("case", reference_cases("rule_07", file=CAMERA))
def test_rule_07_of_the_reference(case):
    given = {name: float(value) for name, value in case["inputs"].items()}
    assert rule_07_A_per_cm2(**given) == close(case["expected"]["dark_current_A_per_cm2"])


def test_rule_07_of_a_pixel_is_its_area_times_the_density():
    density = rule_07_A_per_cm2(cutoff_um=5.0, detector_K=120.0)
    electrons = rule_07_e_per_s(cutoff_um=5.0, detector_K=120.0, area_um2=225.0)
    assert electrons == pytest.approx(density * 225e-8 / 1.602176634e-19, rel=1e-14)


def test_rule_07_is_continuous_at_its_threshold_and_refuses_a_cutoff_too_short():
    below, above = (
        rule_07_A_per_cm2(cutoff_um=4.63513642316149 * factor, detector_K=120.0)
        for factor in (1 - 1e-9, 1 + 1e-9)
    )
    assert below == pytest.approx(above, rel=1e-3)
    with pytest.raises(ParameterError, match=r"material_cutoff_um = 0\.19 µm"):
        rule_07_A_per_cm2(cutoff_um=0.19, detector_K=77.0)


@pytest.mark.parametrize(("low", "high", "kelvin"), [(3.0, 5.2, 300.0), (3.5, 4.1, 77.0)])
def test_photons_through_a_response_against_quadrature(low, high, kelvin):
    efficiency = QuantumEfficiency(low, high, points=POINTS)
    truth = counted(kelvin, low, high, POINTS)
    assert efficiency.photon_radiance(kelvin) == close(truth)
    step = mpf("1e-4")
    up, down = (counted(kelvin + sign * step, low, high, POINTS) for sign in (1, -1))
    assert efficiency.photon_radiance(kelvin, slope=True) == close((up - down) / (2 * step))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("filtered", [(3.0, 5.0), (3.7, 4.8)])
def test_electrons_of_a_scene_are_those_of_its_brightness_temperatures(dtype, filtered):
    band = {"cut_on_um": 3.0, "cut_off_um": 5.0}
    kelvin = np.linspace(240.0, 700.0, 1001)
    radiance = band_radiance(temperature_K=kelvin, **band).astype(dtype)
    efficiency = QuantumEfficiency(*filtered, 0.6)
    weights = PhotonWeights("scene", (3.0, 5.0), efficiency, 5800.0)
    conversion = conversion_between(
        weights=weights,
        electrons_per_photon=2e-15,
        low=float(radiance.min()),
        high=float(radiance.max()),
    )
    electrons = conversion.times(radiance)
    assert electrons.dtype == dtype
    truth = 2e-15 * efficiency.photon_radiance(
        brightness_temperature(radiance=radiance.astype(float), **band)
    )
    tight = 1e-12 if dtype is np.float64 else 1e-6
    np.testing.assert_allclose(electrons, truth, rtol=tight)
    np.testing.assert_allclose(conversion.inverse.times(electrons), radiance, rtol=2 * tight)


def test_a_dark_corner_and_negative_samples_are_in_proportion():
    weights = PhotonWeights("scene", (3.0, 5.0), QuantumEfficiency(3.0, 5.0), 5800.0)
    conversion = conversion_between(weights=weights, electrons_per_photon=1e-15, low=-0.1, high=5.0)
    electrons = conversion.times(np.array([-0.1, 0.0, 5e-10, 5.0]))
    assert electrons[1] == 0.0
    assert electrons[0] < 0.0 < electrons[2]
    assert electrons[3] == pytest.approx(5.0 * 1e-15 * weights.per_radiance(np.array([5.0]))[0])
    black = conversion_between(weights=weights, electrons_per_photon=1e-15, low=0.0, high=0.0)
    assert black.times(np.zeros(2)).tolist() == [0.0, 0.0]


def test_no_brightness_temperature_below_two_and_a_half_micrometres():
    visible = PhotonWeights("scene", (0.4, 0.8), QuantumEfficiency(0.4, 0.8), 5800.0)
    source = PhotonWeights("source", (0.4, 0.8), QuantumEfficiency(0.4, 0.8), 5800.0)
    assert visible.used == "source"
    assert visible.per_radiance(np.array([1.0, 2.0])).tolist() == (
        source.per_radiance(np.array([1.0, 2.0])).tolist()
    )
    assert PhotonWeights("scene", (2.5, 5.0), QuantumEfficiency(2.5, 5.0), 5800.0).used == "scene"
    assert PhotonWeights("scene", (2.4, 5.0), QuantumEfficiency(2.5, 5.0), 5800.0).used == "source"


def test_a_response_bends_by_its_percent_at_the_full_well():
    well = 1e5
    bent = bent_response(electrons=well, full_well_e=well, nonlinearity_percent=3.0)
    assert bent == pytest.approx(0.97 * well, rel=1e-14)
    slope = bent_slope(electrons=4e4, full_well_e=well, nonlinearity_percent=3.0)
    up, down = (
        bent_response(electrons=4e4 + d, full_well_e=well, nonlinearity_percent=3.0)
        for d in (1.0, -1.0)
    )
    assert slope == pytest.approx((up - down) / 2.0, rel=1e-9)


def test_more_light_never_gives_less():
    electrons = np.linspace(0.0, 1e6, 5001)
    for percent in (0.0, 1.0, 25.0):
        bent = bent_response(electrons=electrons, full_well_e=1e5, nonlinearity_percent=percent)
        assert (np.diff(bent) >= 0.0).all()
        assert bent.max() >= 0.999e5  # the well can still be filled


@pytest.mark.parametrize("f_number", [0.5, 0.7, 1.0, 4.0, 12.0])
@pytest.mark.parametrize("inner", [0.0, 0.35, 0.9])
def test_the_solid_angle_is_the_flux_of_a_cone_of_even_radiance(f_number, inner):
    """E = ∫ L·cos θ dΩ over the pupil, by angle (sine condition) and by its area (flat disc)."""
    sine = array.solid_angle(f_number=f_number, obscuration_ratio=inner, irradiance="sine")
    most, least = mpmath.asin(1 / (2 * mpf(f_number))), mpmath.asin(inner / (2 * mpf(f_number)))
    by_angle = 2 * mpmath.pi * mpmath.quad(lambda t: mpmath.cos(t) * mpmath.sin(t), [least, most])
    assert sine == pytest.approx(float(by_angle), rel=1e-13)
    disc = array.solid_angle(f_number=f_number)
    rim = 1 / (2 * mpf(f_number))
    by_area = 2 * mpmath.pi * mpmath.quad(lambda r: r / (1 + r * r) ** 2, [0, rim])
    assert disc == pytest.approx(float(by_area), rel=1e-13)
    obscured = array.solid_angle(f_number=f_number, obscuration_ratio=inner)
    assert obscured == pytest.approx(disc * (1 - inner**2), rel=1e-14)


def test_photons_of_a_scene_whose_temperature_is_known():
    """The brightness temperature given is the one used: no second one is sought."""
    weights = PhotonWeights("scene", (3.7, 4.8), QuantumEfficiency(3.7, 4.8, 0.7), 5800.0)
    radiance = band_radiance(cut_on_um=3.7, cut_off_um=4.8, temperature_K=300.0)
    photons = 0.7 * counted(300, 3.7, 4.8)
    ratio = weights.per_radiance(np.array([radiance]), temperature_K=np.array([300.0]))
    assert ratio[0] == close(photons / radiance)
    assert weights.slope(radiance, temperature_K=300.0) == close(weights.slope(radiance))


# Maps of bad pixels: their number, kinds and clusters.


def made(rows, columns, percent, seed=1):
    """A map: 0 where a pixel is good."""
    generator = np.random.default_rng(seed)
    places, kinds = bad_pixel_places(
        rows=rows, columns=columns, percent=percent, generator=generator
    )
    assert len(np.unique(places)) == len(places) == len(kinds)
    drawn = np.zeros(rows * columns, np.uint8)
    drawn[places] = kinds
    return drawn.reshape(rows, columns)


@pytest.mark.parametrize(
    ("rows", "columns", "percent"),
    [
        (100, 120, 0.5), (64, 64, 10), (1, 7, 50), (1, 1, 100), (30, 20, 24.9), (8, 8, 0.0),
        (9, 9, 100),
    ],
)  # fmt: skip
def test_their_number_is_exact(rows, columns, percent):
    kinds = made(rows, columns, percent)
    assert kinds.shape == (rows, columns)
    assert np.count_nonzero(kinds) == round(percent / 100 * rows * columns)


def test_dead_and_hot_come_alike_and_some_in_clusters():
    kinds = made(512, 512, 0.4)
    dead, hot = np.count_nonzero(kinds == DEAD), np.count_nonzero(kinds == HOT)
    assert 0.35 < dead / (dead + hot) < 0.65
    labels, count = ndimage.label(kinds > 0)
    sizes = np.bincount(labels.ravel())[1:]
    assert 0.5 < np.count_nonzero(sizes == 1) / count < 0.85
    assert (sizes > 2).any()


# Corrections of known gains and offsets: the algebra by hand.


@pytest.fixture
def maps():
    rng = np.random.default_rng(2)
    return 1.0 + 0.05 * rng.standard_normal((40, 50)), 3.0 * rng.standard_normal((40, 50))


def test_one_point_leaves_the_gains_times_the_distance_from_the_reference(maps):
    gain, offset = maps
    low = 100.0 * gain + offset
    found = 130.0 * gain + offset + one_point_offset(low=low)
    # y − y₁ + mean(y₁) = (S − S₁)·g + S₁·mean(g) + mean(o).
    expected = 30.0 * gain + 100.0 * gain.mean() + offset.mean()
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_two_points_leave_nothing_of_a_straight_response(maps):
    gain, offset = maps
    low, high = 100.0 * gain + offset, 150.0 * gain + offset
    factor = two_point_gain(low=low, high=high)
    np.testing.assert_allclose(factor, gain.mean() / gain, rtol=1e-12)
    for signal in (80.0, 100.0, 137.0, 400.0):
        seen = (signal * gain + offset) * factor + two_point_offset(low=low, gain=factor)
        np.testing.assert_allclose(seen, signal * gain.mean() + offset.mean(), rtol=1e-12)


def test_of_a_bent_response_the_bow_is_left(maps):
    """y = g·S·(1 − c·g·S): the line through two points misses by g²c(S − S₁)(S₂ − S)."""
    gain, _ = maps
    bend, low_s, high_s, signal = 1e-4, 100.0, 200.0, 150.0

    def response(level):
        return gain * level * (1 - bend * gain * level)

    low, high = response(low_s), response(high_s)
    factor = two_point_gain(low=low, high=high)
    found = response(signal) * factor + two_point_offset(low=low, gain=factor)
    bow = bend * gain**2 * (signal - low_s) * (high_s - signal)
    line = low.mean() + (high - low).mean() * (signal - low_s) / (high_s - low_s)
    np.testing.assert_allclose(found, line + bow * factor, rtol=1e-12)


def test_a_dead_pixel_keeps_its_gain():
    low, high = np.full((4, 5), 10.0), np.full((4, 5), 20.0)
    low[1, 2] = high[1, 2] = 0.0
    factor = two_point_gain(low=low, high=high)
    assert factor[1, 2] == 1.0
    assert factor[0, 0] == pytest.approx(0.95)


def test_references_that_are_alike_are_refused():
    with pytest.raises(DataError, match="on average"):
        two_point_gain(low=np.ones((3, 3)), high=np.ones((3, 3)))


# Microbolometers: scaling of NETD and a first-order lag, by hand.

SHEET = {
    "netd_K": 0.05, "reference_K": 300.0, "reference_sr": math.pi / 5, "lens_sr": math.pi / 5,
    "cut_on_um": 8.0, "cut_off_um": 14.0,
}  # fmt: skip


def slope(kelvin, low=8.0, high=14.0):
    """dL/dT of a band by Planck's law, W/m²/sr/K."""
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23

    def spectral(um):
        wave = um * 1e-6
        x = h * c / (wave * k * kelvin)
        return 2 * h * c**2 / wave**5 * x / kelvin * math.exp(x) / math.expm1(x) ** 2 * 1e-6

    return quad(spectral, low, high, epsrel=1e-11)[0]


def test_noise_is_netd_times_the_slope_at_the_reference():
    assert netd_noise_radiance(**SHEET) == pytest.approx(0.05 * slope(300.0), rel=1e-8)


def test_the_lag_is_the_heat_balance_followed_step_by_step():
    """C·dx/dt = s − x at each frame's scene, integrated in small steps, read at the frame's end."""
    rate, constant, steps = 50.0, 0.012, 4000
    scene = np.random.default_rng(3).uniform(size=40)
    state, shown = scene[0], []
    for value in scene:
        for _ in range(steps):
            state += (value - state) / (rate * constant * steps)
        shown.append(state)
    weights = lag_weights(kept=share_kept(time_constant_s=constant, frame_rate_Hz=rate), most=64)
    count = len(weights)
    assert math.fsum(weights) == pytest.approx(1.0, abs=1e-15)
    for frame in range(count, 40):
        found = np.dot(weights, scene[frame - count + 1 : frame + 1][::-1])
        assert found == pytest.approx(shown[frame], abs=2e-4)


def test_a_long_lag_is_cut_and_still_adds_to_one():
    weights = lag_weights(kept=0.99, most=64)
    assert len(weights) == 64
    assert math.fsum(weights) == pytest.approx(1.0, abs=1e-14)


# Charge gain: excess noise against branching processes, deviates against simulated registers.


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
    [("avalanche", 0.9, "at least 1"), ("em_register", 5.0, "a gain of 2 per register stage"),
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
