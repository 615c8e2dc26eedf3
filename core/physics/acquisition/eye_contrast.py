"""Contrast threshold of the naked eye, and of the eye behind a sensor and its display."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.physics.numerics.array_checks import all_above_zero, all_finite, all_from_zero, broadcast

CYC_PER_DEG = 1000.0 * math.pi / 180.0  # in one cycle per mrad
NOISE_SENSITIVITY = 169.6  # √Hz, how much noise of the display raises the threshold


def eye_contrast_threshold(
    *, frequency_cyc_per_deg: ArrayLike, luminance_cd_m2: ArrayLike, display_deg: ArrayLike
) -> Any:
    """Smallest contrast (modulation) of a sine that the eye sees on a display.

    Parameters
    ----------
    frequency_cyc_per_deg
        Frequency u at the eye, cycles per degree, zero or above.
    luminance_cd_m2
        Mean luminance L of the display, above zero.
    display_deg
        Root of the display's area w, degrees at the eye, above zero.

    Returns
    -------
    float or ndarray
        1/[a·u·e^(−b·u)·√(1 + 0.06·e^(b·u))], a = 540·(1 + 0.7/L)^−0.2/(1 + 12/(w·(1 + u/3)²)),
        b = 0.3·(1 + 100/L)^0.15; infinite at u = 0, of the broadcast shape.

    Raises
    ------
    ParameterError
        For a value out of range, or shapes that do not broadcast.

    Notes
    -----
    Source: Barten 1990, J. Opt. Soc. Am. A 7, 2024 (fit to measured thresholds), the form used by
    Vollmerhausen and Jacobs 2004, report AMSEL-NV-TR-230. Written down from the literature that
    quotes it; the numbers of the equations could not be checked.
    """
    frequency, luminance, display = broadcast(
        frequency_cyc_per_deg=all_from_zero(
            "frequency_cyc_per_deg", frequency_cyc_per_deg, unit="cyc/deg"
        ),
        luminance_cd_m2=all_above_zero("luminance_cd_m2", luminance_cd_m2, unit="cd/m²"),
        display_deg=all_above_zero("display_deg", display_deg, unit="°"),
    )
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        size = 1.0 + 12.0 / (display * (1.0 + frequency / 3.0) ** 2)
        height = 540.0 * (1.0 + 0.7 / luminance) ** -0.2 / size
        decay = 0.3 * (1.0 + 100.0 / luminance) ** 0.15 * frequency
        # e^(−bu)·√(1 + 0.06·e^(bu)), written so that nothing overflows.
        shape = np.exp(-decay / 2.0) * np.sqrt(np.exp(-decay) + 0.06)
        return (1.0 / (height * frequency * shape))[()]


def system_contrast_threshold(
    *,
    frequency: ArrayLike,
    mtf: ArrayLike,
    luminance_cd_m2: ArrayLike,
    display_deg: ArrayLike,
    magnification: ArrayLike,
    relative_noise: ArrayLike = 0.0,
) -> Any:
    """Smallest contrast of a sine in the scene that the eye sees through a sensor.

    Parameters
    ----------
    frequency
        Frequency in the scene, cycles/mrad, zero or above.
    mtf
        MTF of sensor and display; its sign has no effect, a zero makes the threshold infinite.
    luminance_cd_m2, display_deg
        The display, as in `eye_contrast_threshold`.
    magnification
        Angle on the display over angle in the scene, above zero.
    relative_noise
        Noise σ over the mean luminance L, as the eye filters it at each frequency, 1/√Hz (s^½),
        zero or above.

    Returns
    -------
    float or ndarray
        CTF_eye/MTF·√(1 + α²·σ²/L²), α = 169.6 √Hz, of the broadcast shape.

    Raises
    ------
    ParameterError
        For a value out of range, or shapes that do not broadcast.

    Notes
    -----
    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806; Vollmerhausen and Jacobs
    2004, report AMSEL-NV-TR-230, where α is fitted to observers. The numbers of the equations
    could not be checked.
    """
    places, response, noise, magnified = broadcast(
        frequency=all_from_zero("frequency", frequency, unit="cyc/mrad"),
        mtf=np.abs(all_finite("mtf", mtf)),
        relative_noise=all_from_zero("relative_noise", relative_noise, unit="1/√Hz"),
        magnification=all_above_zero("magnification", magnification),
    )
    eye = eye_contrast_threshold(
        frequency_cyc_per_deg=places * (CYC_PER_DEG / magnified),
        luminance_cd_m2=luminance_cd_m2,
        display_deg=display_deg,
    )
    with np.errstate(over="ignore", divide="ignore"):
        return np.asarray(eye / response * np.hypot(1.0, NOISE_SENSITIVITY * noise))[()]
