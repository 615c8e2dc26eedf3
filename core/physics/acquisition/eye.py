"""Averaging of noise by the observer's eye: over the parts of a target, and over time.

Each function gives the share of a noise's variance that is left, at most 1: the spatial integrators
E_h and E_v and the temporal integrator E_t of the thermal imaging models.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import sici

from core.errors import ParameterError
from core.physics.numerics.array_checks import all_from_zero
from core.physics.numerics.scalar_checks import positive

Vector = NDArray[np.float64]
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
        inverse of the number of samples, for a long one.

    Raises
    ------
    ParameterError
        For a value out of range.

    Notes
    -----
    The integral is Si(2πBL)/(πL) − sin²(πBL)/(π²BL²), Si the sine integral.
    Source: Ratches et al. 1975, ECOM-7043, the noise bandwidth Q(f) after the eye's filter of a
    bar's width; Scott and D'Agostino 1992, Proc. SPIE 1689, 194, the integrators E_h and E_v. Both
    have the filters behind the noise under the integral as well: `coloured_share`. The equations'
    numbers could not be checked.
    """
    bandwidth = positive(
        "noise_bandwidth_cyc_per_mrad", noise_bandwidth_cyc_per_mrad, unit="cyc/mrad"
    )
    length = all_from_zero("length_mrad", length_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        turns = np.minimum(bandwidth * length, _LONGEST)
    # Below this sinc² is 1 to rounding, and the closed form is 0/0 or next to it.
    long = turns > 1e-4
    safe = np.where(long, turns, 1.0)
    sine = np.sin(math.pi * np.fmod(safe, 1.0))
    integral = sici(2.0 * math.pi * safe)[0] / math.pi - sine**2 / (math.pi**2 * safe)
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
        Sides of the rectangles, mrad, zero or above, shape (n,).
    noise_bandwidth_x_cyc_per_mrad, noise_bandwidth_y_cyc_per_mrad
        Frequencies up to which the spectrum goes, cycles/mrad, above zero.
    spectrum
        Power of the noise in equal cells from 0 to the bandwidths, shape (along y, across x), in
        any unit, zero or above, not zero everywhere.

    Returns
    -------
    ndarray of float64, shape (n,)
        ∬ S(ξ, η)·sinc²(X·ξ)·sinc²(Y·η) dξ dη over ∬ S(ξ, η) dξ dη; of a spectrum of one cell, which
        is white, the product of both `spatial_share`.

    Raises
    ------
    ParameterError
        For a value out of range, or sides of different shapes.

    Notes
    -----
    In a cell the spectrum is constant and sinc² is integrated exactly.
    Source: Ratches et al. 1975, ECOM-7043, Q(f); Scott and D'Agostino 1992, Proc. SPIE 1689, 194,
    E_h and E_v: both have the noise's filters H_N² = S under the integral.
    """
    power = all_from_zero("spectrum", spectrum)
    if power.ndim != 2 or not power.sum() > 0.0:
        raise ParameterError("spectrum", f"an array of shape {power.shape}", "two axes, some power")
    along_y = _share_of_cells(length_y_mrad, noise_bandwidth_y_cyc_per_mrad, power.shape[0])
    along_x = _share_of_cells(length_x_mrad, noise_bandwidth_x_cyc_per_mrad, power.shape[1])
    if along_x.shape[0] != along_y.shape[0]:
        shapes = f"{along_x.shape[:1]}, {along_y.shape[:1]}"
        raise ParameterError("length_x_mrad, length_y_mrad", shapes, "of one shape")
    left = np.einsum("ni,ij,nj->n", along_y, power / power.mean(), along_x, optimize=True)
    return np.asarray(left, np.float64)


def _share_of_cells(length_mrad: ArrayLike, bandwidth: float, cells: int) -> Vector:
    """∫ sinc²(L·ξ) dξ over each of the cells, over the bandwidth; shape (lengths, cells)."""
    length = np.atleast_1d(all_from_zero("length_mrad", length_mrad, unit="mrad"))
    part = np.arange(1, cells + 1) / cells
    with np.errstate(over="ignore"):
        lengths = np.minimum(length[:, np.newaxis] * part, _LONGEST)
    up_to = part * spatial_share(length_mrad=lengths, noise_bandwidth_cyc_per_mrad=bandwidth)
    # It never falls with the bandwidth; where it has levelled off rounding might lower it.
    return np.asarray(np.maximum(np.diff(up_to, axis=1, prepend=0.0), 0.0), np.float64)


def frames_integrated(*, frame_rate_Hz: float, eye_integration_s: float) -> float:
    """Frames over which the eye averages, F_R·t_E; one at the least.

    Parameters
    ----------
    frame_rate_Hz
        Frames in a second F_R, Hz, above zero.
    eye_integration_s
        Integration time t_E of the eye, s, above zero: 0.2 s in Ratches' model, 0.1 s and less
        for bright displays.

    Returns
    -------
    F_R·t_E, or 1 where fewer frames come than the eye could average.

    Raises
    ------
    ParameterError
        For a value out of range.

    Notes
    -----
    The temporal integrator of FLIR92, E_t = α_t/(F_R·τ_E), is the inverse of it, with α_t = 1:
    independent frames.
    Source: Ratches et al. 1975, ECOM-7043; Scott and D'Agostino 1992.
    """
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    time = positive("eye_integration_s", eye_integration_s, unit="s")
    return max(1.0, rate * time)


def frame_count(frames: float) -> float:
    """A number of frames averaged, checked: finite, 1 or above."""
    number = positive("frames", frames)
    if number < 1.0:
        raise ParameterError("frames", frames, "1 or above")
    return number
