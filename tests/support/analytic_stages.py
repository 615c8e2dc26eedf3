"""Stages of a chain, and their transfer functions as the slow reference has them."""

import numpy as np

from module_defaults import DEFAULTS
from slow_reference.filtering import hermitian
from slow_reference.pupil import otf_of
from slow_reference.transfer import MAGNITUDE, PHASE

FOCAL_MM, PITCH_X_UM, PITCH_Y_UM, FILL_X, FILL_Y = 40.0, 90.0, 60.0, 0.9, 0.8
RANGE_M, SPEED = 400.0, 60.0
SENSOR = {
    "detector_x_um": PITCH_X_UM, "detector_y_um": PITCH_Y_UM, "focal_length_mm": FOCAL_MM,
    "fill_x": FILL_X, "fill_y": FILL_Y, "range_m": RANGE_M, "velocity_m_per_s": SPEED,
    "f_number": 2,
}  # fmt: skip
INTERVAL_X, INTERVAL_Y = 0.8, 1.1  # mrad, what the fields of view below come to
TRANSFERS, EFFICIENCY = 3, 0.8

# One stage each: module, parameters, wires it changes.
STAGES = {
    "air": ("atmosphere_mtf", {
        "fwhm_mrad": 1.1, "turbidity": "custom", "scatter_depth": 0.3,
        "turbidity_cutoff_cyc_per_mrad": 0.35,
    }),
    "fried": ("atmosphere_mtf", {
        "turbulence": "short_exposure", "fried_r0_m": 0.008, "wavelength_um": 9,
        "aperture_mm": 30, "alpha": 0.5,
    }),
    "optics": ("exit_pupil_mtf", {
        "cut_on_um": 8, "cut_off_um": 12, "size_x_cm": 3.2, "size_y_cm": 2.4,
    }),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.31, "sigma_y_mrad": 0.17}),
    "scan": ("crosstrack_mtf", {"dwell_time_s": 1e-3, "scan_velocity_mrad_per_s": 400}),
    "along": ("alongtrack_mtf", {"integration_time_s": 0.004}),
    "smear": ("relative_motion_mtf", {
        "image_velocity_x": 30, "platform_velocity_y": 50, "integration_time_s": 0.005,
        "model": "line",
    }),
    "box": ("relative_motion_mtf", {
        "image_velocity_x": 30, "platform_velocity_y": 50, "integration_time_s": 0.005,
    }),
    "jitter": ("jitter_mtf", {"sigma_mrad": 0.13}),
    "shake": ("vibration_mtf", {"amplitude_x_mrad": 0.4, "amplitude_y_mrad": 0.2}),
    "shake some": ("vibration_mtf", {
        "amplitude_x_mrad": 0.4, "frequency_Hz": 10, "integration_time_s": 0.13,
    }),
    "pixel": ("detector_mtf", {}),
    "left": ("charge_eff_mtf", {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY}),
    "late": ("charge_eff_phase", {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY}),
    "published": ("charge_eff_phase", {
        "detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY, "model": "published",
    }),
}  # fmt: skip
PUPIL = {"shape": "cassegrain", "size_x": 64, "size_y": 64, "radius": 24, "obscuration_radius": 9}
ALL = ("air", "optics", "blur", "scan", "along", "smear", "jitter", "shake", "pixel", "left",
       "late")  # fmt: skip
CHAINS = {
    "whole chain": ALL,
    "sampled by rows": ("fried", "box", "shake some", "left", "published"),
    "optics and delay": ("optics", "late"),
    "smear": ("smear", "late"),
    "symmetric": ("fried", "optics", "pixel", "shake", "jitter"),
}


CONTEXT = {**DEFAULTS["init_trans"], **SENSOR, "interval_x": INTERVAL_X, "band_um": None}


def analytic(stage, xi, eta):
    """H of a stage on broadcast frequencies, cycles/mrad, in their type."""
    key, params = STAGES[stage]
    p = {**DEFAULTS[key], **params}
    if key == "exit_pupil_mtf":
        pupil = {**DEFAULTS["exit_pupil"], **PUPIL, "samples": None}
        law = otf_of(p, CONTEXT, pupil)[0]
    else:
        law = {**MAGNITUDE, **PHASE}[key](p, CONTEXT)
    return law(xi, eta) + 0 * (xi + eta)


def expected_h(stages, rows, columns, kind=np.longdouble):
    """The Hermitian part of the stages' H: the mean over both signs of Nyquist."""

    def transfer(xi, eta):
        return np.prod([analytic(stage, xi, eta) + 0j for stage in stages], axis=0)

    steps = kind(INTERVAL_X), kind(INTERVAL_Y)
    return hermitian(transfer, steps, (rows, columns), "periodic")
