"""Stages of a chain and their transfer functions, written a second time."""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np
from mpmath import mp, mpf

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


def sinc(x):
    return np.sinc(x)


def overlap(a, b, d):
    """Area two discs of radius a and b share at the distance d, to 30 digits."""
    if d >= a + b:
        return mpf(0)
    if d <= abs(a - b):
        return mp.pi * min(a, b) ** 2
    one = (d * d + a * a - b * b) / (2 * d * a)
    two = (d * d + b * b - a * a) / (2 * d * b)
    kite = mp.sqrt((-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b)) / 2
    return a * a * mp.acos(one) + b * b * mp.acos(two) - kite


@cache
def ring(distance: str) -> float:
    """Normalised autocorrelation of the pupil at a lag in samples."""
    with mpmath.workdps(30):
        d, a, b = mpf(distance), mpf(PUPIL["radius"]), mpf(PUPIL["obscuration_radius"])
        shared = overlap(a, a, d) - 2 * overlap(a, b, d) + overlap(b, b, d)
        return float(shared / (mp.pi * (a * a - b * b)))


def optics(xi, eta):
    pitch_x, pitch_y, wavelength = mpf(32) / 64, mpf(24) / 64, mpf(10)
    found = np.empty(np.broadcast(xi, eta).shape)
    for index, (x, y) in enumerate(np.broadcast(xi, eta)):
        with mpmath.workdps(25):
            lag = mp.hypot(wavelength * abs(mpf(x)) / pitch_x, wavelength * abs(mpf(y)) / pitch_y)
            found.flat[index] = ring(mp.nstr(lag, 22))
    return found


def fried(rho):
    lag = 9 * rho
    tilt = np.maximum(0, 1 - 0.5 * (lag / 30) ** (1 / 3))
    return np.exp(-3.44 * (lag / 8) ** (5 / 3) * tilt)


def air(rho):
    sigma = 1.1 / (2 * np.sqrt(2 * np.log(2)))
    return np.exp(-2 * (np.pi * sigma * rho) ** 2) * np.exp(-0.3 * np.minimum(rho / 0.35, 1) ** 2)


def bessel(x):
    return np.vectorize(lambda v: float(mp.besselj(0, v)))(x)


def shake_some(xi):
    """Mean of exp(−2πi·xi·A·sin(2πft)) over 1.3 periods, by Gauss's rule; the modulus."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    t = 0.065 * (nodes + 1)
    moved = 0.4 * np.sin(2 * np.pi * 10 * t)
    return np.abs(np.exp(-2j * np.pi * np.multiply.outer(xi, moved)) @ weights / 2)


def one_transfer(xi):
    lost = 1 - EFFICIENCY
    return EFFICIENCY / (1 - lost * np.exp(-2j * np.pi * xi * INTERVAL_X))


def analytic(stage, xi, eta):
    """H of a stage on broadcast frequencies, cycles/mrad."""
    w = 2 * np.pi * xi * INTERVAL_X
    blur_x, blur_y = -30 * 0.005 / RANGE_M * 1000, 50 * 0.005 / RANGE_M * 1000
    forms = {
        "air": lambda: air(np.hypot(xi, eta)),
        "fried": lambda: fried(np.hypot(xi, eta)),
        "optics": lambda: optics(xi, eta),
        "blur": lambda: np.exp(-2 * np.pi**2 * ((0.31 * xi) ** 2 + (0.17 * eta) ** 2)),
        "scan": lambda: sinc(0.4 * xi),
        "along": lambda: sinc(SPEED * 0.004 / RANGE_M * 1000 * eta),
        "smear": lambda: sinc(blur_x * xi + blur_y * eta),
        "box": lambda: sinc(blur_x * xi) * sinc(blur_y * eta),
        "jitter": lambda: np.exp(-2 * np.pi**2 * 0.13**2 * (xi**2 + eta**2)),
        "shake": lambda: bessel(2 * np.pi * 0.4 * xi) * bessel(2 * np.pi * 0.2 * eta),
        "shake some": lambda: shake_some(xi),
        "pixel": lambda: (
            sinc(PITCH_X_UM / FOCAL_MM * FILL_X * xi) * sinc(PITCH_Y_UM / FOCAL_MM * FILL_Y * eta)
        ),
        "left": lambda: np.abs(one_transfer(xi)) ** TRANSFERS,
        "late": lambda: np.exp(1j * TRANSFERS * np.angle(one_transfer(xi))),
        "published": lambda: np.exp(-1j * TRANSFERS * (1 - EFFICIENCY) * (w - np.sin(w))),
    }
    return forms[stage]() + 0 * (xi + eta)


@cache
def plane(stage, rows, columns, flip_y, flip_x):
    """H of a stage at a plain FFT's frequencies; at Nyquist of either sign."""
    xi, eta = np.fft.fftfreq(columns, INTERVAL_X), np.fft.fftfreq(rows, INTERVAL_Y)
    if flip_x:
        xi[np.arange(columns) * 2 == columns] *= -1
    if flip_y:
        eta[np.arange(rows) * 2 == rows] *= -1
    return analytic(stage, xi[np.newaxis, :], eta[:, np.newaxis])


def expected_h(chain, rows, columns):
    """The Hermitian part of the chain's H: the mean over both signs of Nyquist."""
    total = np.zeros((rows, columns), complex)
    for flip_y in (False, True):
        for flip_x in (False, True):
            h = np.ones((rows, columns), complex)
            for stage in CHAINS[chain]:
                h *= plane(stage, rows, columns, flip_y, flip_x)
            total += h / 4
    return total
