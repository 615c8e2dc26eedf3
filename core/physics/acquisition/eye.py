"""Averaging of noise by the observer's eye: over the parts of a target, and over time.

Each function gives the share of a noise's variance that is left, at most 1: the spatial integrators
E_h and E_v and the temporal integrator E_t of the thermal imaging models.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Vector
from core.errors import ParameterError
from core.kernels import special
from core.physics import numerics

_LONGEST = 1e300


def spatial_share(*, length_mrad: ArrayLike, noise_bandwidth_cyc_per_mrad: float) -> Vector:
    """Share of white noise's variance that is left after averaging along a length.

    Parameters
    ----------
    length_mrad
        Length L over which the eye averages, mrad, zero or above, any shape.
    noise_bandwidth_cyc_per_mrad
        Bandwidth B up to which the noise is white, cycles/mrad, above zero: half the samples per
        mrad where the samples' noises are independent, bandwidth over scan velocity along an
        analogue scan.

    Returns
    -------
    ndarray of float64
        (1/B)·∫₀ᴮ sinc²(L·ξ) dξ, sinc(x) = sin(πx)/(πx): 1 for a short length, 1/(2·B·L), the
        inverse of the number of samples, for a long one. By the sine integral, Si(2πBL)/(πL) −
        sin²(πBL)/(π²BL²).

    Source: Ratches et al. 1975, ECOM-7043, the noise bandwidth Q(f) after the eye's filter of a
    bar's width; Scott and D'Agostino 1992, Proc. SPIE 1689, 194, the integrators E_h and E_v. Both
    have the filters behind the noise under the integral as well: `coloured_share`. The equations'
    numbers could not be checked.
    """
    bandwidth = numerics.positive(
        "noise_bandwidth_cyc_per_mrad", noise_bandwidth_cyc_per_mrad, unit="cyc/mrad"
    )
    length = numerics.all_from_zero("length_mrad", length_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        turns = np.minimum(bandwidth * length, _LONGEST)
    # Below this sinc² is 1 to rounding, and the closed form is 0/0 or next to it.
    long = turns > 1e-4
    safe = np.where(long, turns, 1.0)
    sine = np.sin(math.pi * np.fmod(safe, 1.0))
    integral = special("sici")(2.0 * math.pi * safe)[0] / math.pi - sine**2 / (math.pi**2 * safe)
    series = 1.0 - (math.pi * np.where(long, 0.0, turns)) ** 2 / 9.0
    return np.asarray(np.where(long, integral / safe, series), np.float64)


def coloured_share(
    *,
    length_x_mrad: ArrayLike,
    length_y_mrad: ArrayLike,
    noise_bandwidth_x_cyc_per_mrad: float,
    noise_bandwidth_y_cyc_per_mrad: float,
    spectrum: ArrayLike,
) -> Vector:
    """Share of a filtered noise's variance that is left after averaging over rectangles.

    Parameters
    ----------
    length_x_mrad, length_y_mrad
        Sides of the rectangles, mrad, zero or above, both of shape (n,).
    noise_bandwidth_x_cyc_per_mrad, noise_bandwidth_y_cyc_per_mrad
        Frequencies up to which the spectrum goes, cycles/mrad, above zero.
    spectrum
        Power of the noise in equal cells from 0 to the bandwidths, shape (along y, across x), in
        any unit, zero or above, not zero everywhere.

    Returns
    -------
    ndarray of float64, shape (n,)
        ∬ S(ξ, η)·sinc²(X·ξ)·sinc²(Y·η) dξ dη over ∬ S(ξ, η) dξ dη; of a spectrum of one cell, which
        is white, the product of both `spatial_share`. In a cell sinc² is integrated exactly.

    Source: Ratches et al. 1975, ECOM-7043, Q(f); Scott and D'Agostino 1992, Proc. SPIE 1689, 194,
    E_h and E_v: both have the noise's filters H_N² = S under the integral.
    """
    power = numerics.all_from_zero("spectrum", spectrum)
    if power.ndim != 2 or not power.sum() > 0.0:
        raise ParameterError(
            "spectrum.shape", power.shape, "two-dimensional, and the total power above 0"
        )
    along_y = _share_of_cells(length_y_mrad, noise_bandwidth_y_cyc_per_mrad, power.shape[0])
    along_x = _share_of_cells(length_x_mrad, noise_bandwidth_x_cyc_per_mrad, power.shape[1])
    if along_x.shape[0] != along_y.shape[0]:
        shapes = f"{along_x.shape[:1]}, {along_y.shape[:1]}"
        raise ParameterError("length_x_mrad, length_y_mrad", shapes, "equal in shape")
    left = np.einsum("ni,ij,nj->n", along_y, power / power.mean(), along_x, optimize=True)
    return np.asarray(left, np.float64)


def _share_of_cells(length_mrad: ArrayLike, bandwidth: float, cells: int) -> Vector:
    """∫ sinc²(L·ξ) dξ over each of the cells, over the bandwidth; shape (lengths, cells)."""
    length = np.atleast_1d(numerics.all_from_zero("length_mrad", length_mrad, unit="mrad"))
    part = np.arange(1, cells + 1) / cells
    with np.errstate(over="ignore"):
        lengths = np.minimum(length[:, np.newaxis] * part, _LONGEST)
    up_to = part * spatial_share(length_mrad=lengths, noise_bandwidth_cyc_per_mrad=bandwidth)
    # It never falls with the bandwidth; where it has levelled off rounding might lower it.
    return np.asarray(np.maximum(np.diff(up_to, axis=1, prepend=0.0), 0.0), np.float64)


def frames_integrated(*, frame_rate_Hz: float, eye_integration_s: float) -> float:
    """Frames over which the eye averages, F_R·t_E, or 1 where fewer frames come.

    The integration time t_E is 0.2 s in Ratches' model, 0.1 s and less for bright displays. The
    temporal integrator of FLIR92, E_t = α_t/(F_R·τ_E), is the inverse, with α_t = 1: independent
    frames. Source: Ratches et al. 1975, ECOM-7043; Scott and D'Agostino 1992.
    """
    rate = numerics.positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    time = numerics.positive("eye_integration_s", eye_integration_s, unit="s")
    return max(1.0, rate * time)


def frame_count(frames: float) -> float:
    """A number of frames averaged, checked: finite, 1 or above."""
    number = numerics.positive("frames", frames)
    if number < 1.0:
        raise ParameterError("frames", frames, "1 or above")
    return number


# Contrast threshold of the naked eye, and of the eye behind a sensor and its display.

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

    Source: Barten 1990, J. Opt. Soc. Am. A 7, 2024 (fit to measured thresholds), the form used by
    Vollmerhausen and Jacobs 2004, report AMSEL-NV-TR-230. Written down from the literature that
    quotes it; the numbers of the equations could not be checked.
    """
    frequency, luminance, display = numerics.broadcast(
        frequency_cyc_per_deg=numerics.all_from_zero(
            "frequency_cyc_per_deg", frequency_cyc_per_deg, unit="cyc/deg"
        ),
        luminance_cd_m2=numerics.all_above_zero("luminance_cd_m2", luminance_cd_m2, unit="cd/m²"),
        display_deg=numerics.all_above_zero("display_deg", display_deg, unit="°"),
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

    Source: Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806; Vollmerhausen and Jacobs
    2004, report AMSEL-NV-TR-230, where α is fitted to observers. The numbers of the equations
    could not be checked.
    """
    places, response, noise, magnified = numerics.broadcast(
        frequency=numerics.all_from_zero("frequency", frequency, unit="cyc/mrad"),
        mtf=np.abs(numerics.all_finite("mtf", mtf)),
        relative_noise=numerics.all_from_zero("relative_noise", relative_noise, unit="1/√Hz"),
        magnification=numerics.all_above_zero("magnification", magnification),
    )
    eye = eye_contrast_threshold(
        frequency_cyc_per_deg=places * (CYC_PER_DEG / magnified),
        luminance_cd_m2=luminance_cd_m2,
        display_deg=display_deg,
    )
    with np.errstate(over="ignore", divide="ignore"):
        return np.asarray(eye / response * np.hypot(1.0, NOISE_SENSITIVITY * noise))[()]
