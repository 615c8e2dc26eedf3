"""The published reference values of sampling, blur, motion, detector, transfer and electronics."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import scipy.optimize

from core.physics.atmosphere import scattering_and_turbulence as atmosphere
from core.physics.detector import detector_mtf as charge_transfer
from core.physics.detector import detector_mtf as detector
from core.physics.detector import readout as electronics
from core.physics.optics import blur as gaussian
from core.physics.sampling import detector_sampling as sampling
from core.physics.sampling import platform_motion as motion
from core.physics.sampling import platform_motion as vibration
from reference_cases import reference_cases

_QUANTITIES = {
    "sampling",
    "gaussian_mtf",
    "sinusoidal_vibration_mtf",
    "detector_mtf",
    "motion_mtf",
    "charge_transfer",
    "charge_transfer_leading",
    "charge_transfer_exact",
    "electronics_lowpass",
    "turbulence_long_exposure",
    "turbulence_short_exposure",
}
Values = dict[str, float]


def _at(mtf):
    return float(mtf[0])


def _sampling(v):
    samples = int(v["samples"])
    interval = sampling.interval_mrad(fov_deg=v["fov_deg"], samples=samples)
    return {
        "interval_mrad": interval,
        "nyquist_cyc_per_mrad": sampling.nyquist_cyc_per_mrad(interval_mrad=interval),
        "frequency_interval_cyc_per_mrad": sampling.frequency_interval_cyc_per_mrad(
            interval_mrad=interval, samples=samples
        ),
    }


def _gaussian(v):
    frequency = np.array([v["xi_cyc_per_mrad"]])
    mtf = gaussian.gaussian_mtf(frequency=frequency, sigma_mrad=v["sigma_mrad"])
    return {"mtf": _at(mtf)}


def _vibration(v):
    frequency = np.array([v["xi_cyc_per_mrad"]])
    mtf = vibration.vibration_mtf(frequency=frequency, amplitude_mrad=v["amplitude_mrad"])
    return {"mtf": _at(mtf)}


def _detector(v):
    ifov = sampling.ifov_mrad(
        pitch_um=v["pitch_um"], focal_length_mm=v["focal_length_mm"], fill=v["fill_factor"]
    )
    frequency = np.array([v["xi_cyc_per_mrad"]])
    mtf = detector.aperture_mtf(frequency=frequency, effective_ifov_mrad=ifov)
    return {
        "effective_ifov_mrad": ifov,
        "first_zero_cyc_per_mrad": detector.first_zero_cyc_per_mrad(effective_ifov_mrad=ifov),
        "mtf": _at(mtf),
    }


def _motion(v):
    blur = motion.blur_mrad(
        velocity_m_per_s=v["relative_velocity_m_per_s"],
        time_s=v["integration_time_s"],
        range_m=v["range_m"],
    )
    frequency = np.array([v["xi_cyc_per_mrad"]])
    return {"blur_mrad": blur, "mtf": _at(motion.motion_mtf(frequency=frequency, blur_mrad=blur))}


def _charge_transfer(model):
    def compute(v):
        given = {
            "phase_per_transfer": np.array([math.pi * v["xi_over_nyquist"]]),
            "transfers": v["transfers"],
            "efficiency": v["efficiency"],
            "model": model,
        }
        phase = _at(charge_transfer.charge_transfer_ptf(**given))
        return {
            "mtf": _at(charge_transfer.charge_transfer_mtf(**given)),
            "ptf_rad": math.remainder(phase, 2.0 * math.pi),
        }

    return compute


def _lowpass(v):
    given = {
        "frequency": np.array([v["xi_cyc_per_mrad"]]),
        "scan_velocity_mrad_per_s": v["scan_velocity_mrad_per_s"],
        "time_constant_s": v["time_constant_s"],
    }

    def beyond_half_power(xi):
        return _at(electronics.lowpass_mtf(**{**given, "frequency": np.array([xi])})) ** 2 - 0.5

    corner = scipy.optimize.brentq(beyond_half_power, 0.0, 1e4, xtol=1e-13, rtol=1e-13)
    return {
        "mtf": _at(electronics.lowpass_mtf(**given)),
        "ptf_rad": _at(electronics.lowpass_ptf(**given)),
        "f_3db_Hz": corner * v["scan_velocity_mrad_per_s"],
    }


def _turbulence(v):
    aperture_m = v.get("aperture_m")
    mtf = atmosphere.fried_mtf(
        rho=np.array([v["xi_cyc_per_mrad"]]),
        wavelength_um=v["wavelength_um"],
        fried_r0_m=v["fried_r0_m"],
        aperture_mm=None if aperture_m is None else 1000.0 * aperture_m,
        alpha=v.get("alpha", 0.0),
    )
    return {"mtf": _at(mtf)}


_COMPUTE: dict[str, Callable[[Values], Values]] = {
    "sampling": _sampling,
    "gaussian_mtf": _gaussian,
    "sinusoidal_vibration_mtf": _vibration,
    "detector_mtf": _detector,
    "motion_mtf": _motion,
    "charge_transfer": _charge_transfer("published"),
    "charge_transfer_leading": _charge_transfer("leading"),
    "charge_transfer_exact": _charge_transfer("exact"),
    "electronics_lowpass": _lowpass,
    "turbulence_long_exposure": _turbulence,
    "turbulence_short_exposure": _turbulence,
}


@pytest.mark.parametrize("case", reference_cases(*_QUANTITIES))
def test_reference_value(case):
    assert case["quantity"] in _COMPUTE, f"no function computes {case['quantity']}"
    inputs = {name: float(value) for name, value in case["inputs"].items()}
    got = _COMPUTE[case["quantity"]](inputs)
    for name, text in case["expected"].items():
        expected = float(text)
        assert abs(got[name] - expected) <= 1e-12 * abs(expected) + 1e-15, name


def test_every_quantity_has_a_function():
    assert set(_COMPUTE) == _QUANTITIES
