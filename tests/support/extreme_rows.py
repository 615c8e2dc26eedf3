"""Modules at the ends of what they allow, and what a picture then comes to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import mpmath
import numpy as np

from slow_reference.filtering import filtered
from slow_reference.transfer import box
from spatial_truth import left_behind


@dataclass(frozen=True)
class Row:
    """A module, and what it makes of a picture: of (picture, edges)."""

    modules: tuple
    expected: Any
    interval_mrad: float = 1.0
    init: dict[str, Any] = field(default_factory=dict)
    exact: bool = False


def unchanged(picture, edges):
    return picture


def mean_of_all(picture, edges):
    return np.full(picture.shape, picture.mean())


def mean_of_lines(picture, edges):
    return np.repeat(picture.mean(axis=1, keepdims=True), picture.shape[1], axis=1)


def charge(**params):
    return (("charge_eff_mtf", params), ("charge_eff_phase", params))


def averaged(width_samples):
    """What a detector of that width makes of it, for a frame of `interval` mrad."""

    def expected(picture, edges):
        one = np.longdouble(1)
        law = box(width_samples, width_samples)
        return filtered(picture.astype(np.longdouble), law, (one, one), edges)

    return expected


def detector(interval_mrad, width_samples):
    """A pitch of so many samples over 100 mm."""
    pitch_um = 100 * interval_mrad * width_samples
    return (("detector_mtf", {"detector_x_um": pitch_um, "detector_y_um": pitch_um,
                              "focal_length_mm": 100.0}),)  # fmt: skip


def optics(size_cm, **pupil):
    pupil = {"size_x": 64, "size_y": 64, "radius": 24.0, **pupil}
    band = {"cut_on_um": 10.0, "cut_off_um": 10.0, "size_x_cm": size_cm, "size_y_cm": size_cm}
    return (("exit_pupil", pupil), ("exit_pupil_mtf", band))


STILL = {"integration_time_s": 1.0, "range_m": 100.0}
ROWS = {
    "zero blur": Row((("gaussian_mtf", {"sigma_x_mrad": 0.0}),), unchanged, exact=True),
    "enormous blur": Row(
        (("gaussian_mtf", {"sigma_x_mrad": 1e9, "sigma_y_mrad": 1e9}),), mean_of_all
    ),
    "enormous blur across": Row((("gaussian_mtf", {"sigma_x_mrad": 1e9}),), mean_of_lines),
    "efficiency of 1": Row(charge(efficiency=1.0), unchanged, exact=True),
    "efficiency of 0": Row(charge(efficiency=0.0, detectors_per_line=1), mean_of_lines),
    "1e6 transfers": Row(
        charge(efficiency=0.99999, detectors_per_line=10**6),
        lambda picture, edges: left_behind(picture, 10**6, 0.99999, edges),
    ),
    "zero velocity": Row(
        (
            ("alongtrack_mtf", {"velocity_m_per_s": 0.0, **STILL}),
            ("crosstrack_mtf", {"scan_velocity_mrad_per_s": 0.0, "dwell_time_s": 1.0}),
            ("relative_motion_mtf", {"image_velocity_x": 7.0, "platform_velocity_x": 7.0, **STILL}),
        ),
        unchanged,
        exact=True,
    ),
    # 0.15 mm over 10 µm are 0.015 cycles/mrad, the mirrored frame's first frequency is 1/26.
    "cutoff below the first frequency interval": Row(optics(0.02), mean_of_all),
    "no cutoff in sight": Row(optics(1e18), unchanged),
    "no obscuration": Row(
        optics(2.56, shape="cassegrain", obscuration_radius=0.0),
        lambda picture, edges: ring(picture, edges, mpmath.mpf(0)),
    ),
    "obscuration of 1 - 1e-9": Row(
        optics(2.56, shape="cassegrain", obscuration_radius=24 * (1 - 1e-9)),
        lambda picture, edges: ring(picture, edges, mpmath.mpf(24 * (1 - 1e-9)) / 24),
    ),
    "field of view of 1e-6 degrees": Row(
        detector(np.pi / 180e-3 * 1e-6 / 13, 2.3), averaged(2.3),
        interval_mrad=np.pi / 180e-3 * 1e-6 / 13,
    ),
    "field of view of 170 degrees": Row(
        detector(np.pi / 180e-3 * 170 / 13, 2.3), averaged(2.3),
        interval_mrad=np.pi / 180e-3 * 170 / 13,
    ),
}  # fmt: skip


def ring(picture, edges, ratio):
    """Overlap of two rings from four of discs, with 40 digits, on a picture of few frequencies."""

    def overlap(lag):
        with mpmath.workdps(40):
            d = mpmath.mpf(float(lag)) / 24  # in radii

            def lens(a, b):
                if b == 0 or d >= a + b:
                    return mpmath.mpf(0)
                if d <= abs(a - b):
                    return mpmath.pi * min(a, b) ** 2
                one = mpmath.acos((d * d + a * a - b * b) / (2 * d * a))
                two = mpmath.acos((d * d + b * b - a * a) / (2 * d * b))
                heron = (a + b - d) * (d + a - b) * (d - a + b) * (d + a + b)
                return a * a * one + b * b * two - mpmath.sqrt(heron) / 2

            outer = mpmath.mpf(1)
            shared = lens(outer, outer) - 2 * lens(outer, ratio) + lens(ratio, ratio)
            return float(shared / (mpmath.pi * (1 - ratio**2)))

    def transfer(xi, eta):
        lags = 10 * np.hypot(xi, eta) / 0.4  # wavelength in µm, a pupil sample in mm
        return np.vectorize(overlap)(lags) + 0j

    one = np.longdouble(1)
    return filtered(picture.astype(np.longdouble), transfer, (one, one), edges)
