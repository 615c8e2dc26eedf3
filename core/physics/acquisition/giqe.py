"""The General Image Quality Equation: NIIRS of a picture from sampling, edge, overshoot and noise.

NIIRS is the interpretability scale of visible pictures, from 0 to 9; a step up halves what can be
told apart. Versions 3 and 4 are of sharpened pictures, and take overshoot H and noise gain G of the
sharpening; version 5 is of pictures before it. Ground sample distances are in inches, and each
version has its own: version 3 in the plane normal to the line of sight, version 4 on the ground,
version 5 between both.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Vector
from core.errors import ParameterError
from core.physics.numerics import all_above_zero, all_from_zero, broadcast, gauss_legendre, positive

INCH_M = 0.0254
_SHARP = 0.9  # relative edge response from which version 4 has its other pair of coefficients
LIMITS = {"gsd_inch": (3.0, 80.0), "rer": (0.2, 1.3), "overshoot": (0.9, 1.9), "snr": (2.0, 130.0)}
"""Where version 4 was fitted; taken for the others too, whose own could not be checked."""


def giqe_3(
    *,
    gsd_inch: ArrayLike,
    rer: ArrayLike,
    snr: ArrayLike,
    overshoot: ArrayLike = 1.0,
    noise_gain: ArrayLike = 1.0,
) -> Any:
    """NIIRS by version 3.

    Parameters
    ----------
    gsd_inch
        Ground sample distance, the geometric mean across and along, inches, above zero.
    rer
        Relative edge response, above zero: how far an edge rises within a sample about it.
    snr
        Signal to noise ratio, above zero; infinite without noise.
    overshoot
        Height of the edge response beside the edge, above zero.
    noise_gain
        Rms gain of the sharpening, 0 or above.

    Returns
    -------
    float or ndarray
        11.81 + 3.32·lg(RER/GSD) − 1.48·H − G/SNR, of the broadcast shape.

    Source: Leachtenauer, Malila, Irvine, Colburn and Salvaggio 1997, Appl. Opt. 36, 8322, which
    quotes it. The coefficients could not be checked.
    """
    gsd, edge, signal, height, gain = _checked(gsd_inch, rer, snr, overshoot, noise_gain)
    return (11.81 + 3.32 * np.log10(edge / gsd) - 1.48 * height - gain / signal)[()]


def giqe_4(
    *,
    gsd_inch: ArrayLike,
    rer: ArrayLike,
    snr: ArrayLike,
    overshoot: ArrayLike = 1.0,
    noise_gain: ArrayLike = 1.0,
) -> Any:
    """NIIRS by version 4; parameters as of `giqe_3`.

    Returns
    -------
    float or ndarray
        10.251 − a·lg(GSD) + b·lg(RER) − 0.656·H − 0.344·G/SNR, with a = 3.32 and b = 1.559 for RER
        of 0.9 and above, else a = 3.16 and b = 2.817.

    Source: Leachtenauer, Malila, Irvine, Colburn and Salvaggio 1997, Appl. Opt. 36, 8322. The
    equation jumps at an RER of 0.9 wherever GSD is not near 5 inches.
    """
    gsd, edge, signal, height, gain = _checked(gsd_inch, rer, snr, overshoot, noise_gain)
    sharp = edge >= _SHARP
    a, b = np.where(sharp, 3.32, 3.16), np.where(sharp, 1.559, 2.817)
    steps = 10.251 - a * np.log10(gsd) + b * np.log10(edge)
    return (steps - 0.656 * height - 0.344 * gain / signal)[()]


def giqe_5(*, gsd_inch: ArrayLike, rer: ArrayLike, snr: ArrayLike) -> Any:
    """NIIRS by version 5, of a picture that is not sharpened; parameters as of `giqe_3`.

    Returns
    -------
    float or ndarray
        9.57 − 3.32·lg(GSD) + 3.32·(1 − e^(−1.9/SNR))·lg(RER) − 2·lg(RER)⁴ − 1.8/SNR.

    Source: Harrington, Tanner, Valliant and Gillin 2015, General Image Quality Equation (GIQE),
    version 5.0, National Geospatial-Intelligence Agency, 16 September 2015, eq. 2. RER and GSD are
    those of `weighted_rer` and `weighted_gsd`.
    """
    gsd, edge, signal, _, _ = _checked(gsd_inch, rer, snr, 1.0, 1.0)
    log_edge = np.log10(edge)
    steps = 9.57 - 3.32 * np.log10(gsd) - 3.32 * np.expm1(-1.9 / signal) * log_edge
    return (steps - 2.0 * log_edge**4 - 1.8 / signal)[()]


def ground_gsd(*, gsd: ArrayLike, elevation_deg: float) -> Any:
    """Geometric mean of the ground sample distance on the ground: GSD/√sin(elevation).

    `gsd` is that normal to the line of sight, pitch times range over focal length, in any unit; the
    elevation is of the line of sight above the horizon at the target, above 0 and at most 90.

    Source: GIQE version 5.0 (NGA, 16 September 2015), section 2.3; used by version 4.
    """
    return all_above_zero("gsd", gsd) / _sine(elevation_deg) ** 0.5


def weighted_gsd(*, gsd: ArrayLike, elevation_deg: float) -> Any:
    """Ground sample distance of version 5, GSD/sin(elevation)^¼; parameters as of `ground_gsd`.

    Source: GIQE version 5.0 (NGA, 16 September 2015), eq. 5.
    """
    return all_above_zero("gsd", gsd) / _sine(elevation_deg) ** 0.25


def _sine(elevation_deg: float) -> float:
    height = float(elevation_deg)
    if not 0.0 < height <= 90.0:
        raise ParameterError("elevation_deg", height, "above 0 and at most 90", unit="deg")
    return math.sin(math.radians(height))


def weighted_rer(*, rer_x: ArrayLike, rer_y: ArrayLike) -> Any:
    """Relative edge response of version 5: the worse direction counts twice, (better·worse²)^⅓.

    Source: GIQE version 5.0 (NGA, 16 September 2015), eq. 7.
    """
    one, other = all_above_zero("rer_x", rer_x), all_above_zero("rer_y", rer_y)
    return np.cbrt(np.maximum(one, other) * np.minimum(one, other) ** 2)[()]


class ObliqueQuality(NamedTuple):
    """NIIRS of a camera by each version, and its ground sample distance."""

    gsd_normal_inch: float
    giqe3: float
    giqe4: float
    giqe5: float


def giqe_oblique(
    *,
    pitch_um: float,
    focal_length_mm: float,
    slant_range_m: float,
    elevation_deg: float = 90.0,
    rer_x: float,
    rer_y: float,
    snr: float,
    overshoot: float = 1.0,
    noise_gain: float = 1.0,
) -> ObliqueQuality:
    """NIIRS of a camera that looks down at an angle.

    Parameters
    ----------
    pitch_um, focal_length_mm, slant_range_m : float
        Pixel pitch, focal length and distance along the line of sight, above 0.
    elevation_deg : float
        Elevation of the camera above the horizon as seen from the target, above 0 and up to 90.
    rer_x, rer_y : float
        Relative edge response in both directions, above 0.
    snr : float
        Signal to noise ratio of the contrast between 15 % and 7 % reflectance, above 0.
    overshoot, noise_gain : float
        Of the sharpening, for versions 3 and 4.

    Returns
    -------
    ObliqueQuality
        Ground sample distance normal to the line of sight, and NIIRS by versions 3, 4 and 5.

    Source: GIQE version 5.0 (NGA, 16 September 2015), eqs. 1, 2, 5 and 7; Leachtenauer et al. 1997.
    """
    pitch_m = positive("pitch_um", pitch_um, unit="µm") * 1e-6
    focal_m = positive("focal_length_mm", focal_length_mm, unit="mm") * 1e-3
    gsd = pitch_m / focal_m * positive("slant_range_m", slant_range_m, unit="m") / INCH_M
    sharpened = {"snr": snr, "overshoot": overshoot, "noise_gain": noise_gain}
    mean = float(np.sqrt(all_above_zero("rer_x", rer_x) * all_above_zero("rer_y", rer_y)))
    at = {"gsd": gsd, "elevation_deg": elevation_deg}
    return ObliqueQuality(
        gsd,
        float(giqe_3(gsd_inch=gsd, rer=mean, **sharpened)),
        float(giqe_4(gsd_inch=ground_gsd(**at), rer=mean, **sharpened)),
        float(
            giqe_5(gsd_inch=weighted_gsd(**at), rer=weighted_rer(rer_x=rer_x, rer_y=rer_y), snr=snr)
        ),
    )


def beyond_limits(**values: float) -> tuple[str, ...]:
    """Which of the values of `LIMITS` lie outside, each in words with its limits."""
    return tuple(
        f"{name} = {value:.4g} ({LIMITS[name][0]:g} to {LIMITS[name][1]:g})"
        for name, value in values.items()
        if not LIMITS[name][0] <= value <= LIMITS[name][1]
    )


def _checked(
    gsd_inch: ArrayLike, rer: ArrayLike, snr: ArrayLike, overshoot: ArrayLike, gain: ArrayLike
) -> Any:
    signal = all_from_zero("snr", snr, infinite=True)
    all_above_zero("snr", np.where(np.isfinite(signal), signal, 1.0))
    return broadcast(
        gsd_inch=all_above_zero("gsd_inch", gsd_inch, unit="in"),
        rer=all_above_zero("rer", rer),
        snr=signal,
        overshoot=all_above_zero("overshoot", overshoot),
        noise_gain=all_from_zero("noise_gain", gain),
    )


# Response to an edge that a transfer function gives: how steep it is, how far it overshoots.

_NODES = 8  # of a panel
_PANELS_PER_CYCLE = 8  # of the sampling frequency: the furthest place has 3 periods in it
_ENDS = (32, 1024)  # of the sums, in sampling frequencies
_FIRST, _LAST, _STEP = 1.0, 3.0, 0.25  # samples beside the edge, where it may overshoot


def edge_response(
    *, mtf: Callable[[Vector], Vector], places_px: Vector, sample_mrad: float
) -> Vector:
    """Response to a step from 0 to 1, at places beside it.

    Parameters
    ----------
    mtf
        Signed transfer function without phase, of frequencies in cycles/mrad; 1 at zero.
    places_px
        Places in samples of `sample_mrad`, the edge at 0.

    Returns
    -------
    ndarray
        1/2 + (1/π)·∫ H(ξ)·sin(2πξd)/ξ dξ of each place d.

    Notes
    -----
    Summed by Gauss and Legendre to 32 times the sampling frequency, and to 1024 where there is
    anything beyond: what a sinc alone leaves out there is 1e-4. Source: Goodman 2005, Introduction
    to Fourier Optics, chapter 6 (incoherent edge as the integral of the line spread).
    """
    total = np.zeros(len(places_px))
    nodes, weights = gauss_legendre(_NODES)
    width = 1.0 / (_PANELS_PER_CYCLE * sample_mrad)
    begin = 0
    for end in _ENDS:
        first = np.arange(begin * _PANELS_PER_CYCLE, end * _PANELS_PER_CYCLE) * width
        frequency = (first[:, np.newaxis] + width * (1.0 + nodes) / 2.0).ravel()
        share = np.tile(weights * width / 2.0, len(first)) * mtf(frequency) / frequency
        if begin and not share.any():
            break
        turns = 2.0 * np.pi * sample_mrad * frequency
        total += np.array([np.dot(share, np.sin(turns * place)) for place in places_px])
        begin = end
    return 0.5 + total / np.pi


def relative_edge_response(*, mtf: Callable[[Vector], Vector], sample_mrad: float) -> float:
    """RER: how far the edge rises from half a sample before it to half a sample behind it."""
    before, behind = edge_response(
        mtf=mtf, places_px=np.array([-0.5, 0.5]), sample_mrad=sample_mrad
    )
    return float(behind - before)


def edge_overshoot(*, mtf: Callable[[Vector], Vector], sample_mrad: float) -> float:
    """H: the height of the edge response from 1 to 3 samples beside the edge.

    The greatest at steps of a quarter of a sample; that at 1.25 where it only rises. Source:
    Leachtenauer et al. 1997.
    """
    places = np.arange(_FIRST, _LAST + _STEP / 2, _STEP)
    heights = edge_response(mtf=mtf, places_px=places, sample_mrad=sample_mrad)
    if np.all(np.diff(heights) >= -1e-12):
        return float(heights[1])
    return float(heights.max())
