"""Post filters behind the amplifier: low-pass, high-pass and boost, along one axis."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.electronics.filters import pole_count
from core.physics.numerics.scalar_checks import positive, within

KINDS = ("none", "lowpass", "highpass", "boost")


def post_filter_mtf(
    *,
    frequency: ArrayLike,
    kind: str,
    corner_cyc_per_mrad: float,
    poles: int = 1,
    max_gain: float = 2.0,
) -> NDArray[np.float64]:
    """Modulus of a post filter.

    Parameters
    ----------
    frequency : array_like
        Frequencies along the filtered axis in cycles/mrad, any shape, finite.
    kind : str
        With u = frequency/corner: `none`, H = 1. `lowpass`, H = 1/(1 + iu)^n. `highpass`,
        H = (iu/(1 + iu))^n: it takes the mean out, H(0) = 0. `boost`,
        H = 1 + (G − 1)(1 − cos(πu))/2 up to the corner and G beyond, without phase.
    corner_cyc_per_mrad : float
        Corner of each pole, or the frequency at which the boost reaches its gain; above zero.
    poles : int
        Number n of equal poles, 1 to 100; not used by `boost`.
    max_gain : float
        Gain G of `boost`, 1 to 1e6.

    Returns
    -------
    ndarray of float64
        Modulus of H, of the shape of `frequency`.

    Raises
    ------
    ParameterError
        When a value is out of range or the kind has another name.

    Notes
    -----
    Source: poles, linear network theory. Boost: the raised-cosine form of thermal-system models
    (Ratches et al. 1975), held at its gain beyond the boost frequency instead of falling again.
    """
    ratio = _ratio(frequency, kind, corner_cyc_per_mrad)
    count = pole_count(poles)
    gain = within("max_gain", max_gain, 1.0, 1e6)
    if kind == "none":
        return np.ones_like(ratio)
    if kind == "boost":
        rise = np.square(np.sin(0.5 * math.pi * np.minimum(np.abs(ratio), 1.0)))
        return np.asarray(1.0 + (gain - 1.0) * rise, dtype=np.float64)
    size = np.hypot(1.0, ratio)
    one_pole = 1.0 / size if kind == "lowpass" else np.abs(ratio) / size
    return np.asarray(one_pole ** float(count), dtype=np.float64)


def post_filter_ptf(
    *, frequency: ArrayLike, kind: str, corner_cyc_per_mrad: float, poles: int = 1
) -> NDArray[np.float64]:
    """Phase of a post filter.

    Parameters
    ----------
    frequency, kind, corner_cyc_per_mrad, poles
        As in `post_filter_mtf`, the scan running towards +x.

    Returns
    -------
    ndarray of float64
        Phase of H in radians, odd in frequency and 0 at 0: −n·arctan(u) for `lowpass`,
        n·(±π/2 − arctan(u)) for `highpass`, 0 for `none` and `boost`.

    Raises
    ------
    ParameterError
        When a value is out of range or the kind has another name.

    Notes
    -----
    Source: linear network theory.
    """
    ratio = _ratio(frequency, kind, corner_cyc_per_mrad)
    count = pole_count(poles)
    if kind == "lowpass":
        return np.asarray(-count * np.arctan(ratio), dtype=np.float64)
    if kind == "highpass":
        lead = np.sign(ratio) * np.arctan2(1.0, np.abs(ratio))
        return np.asarray(count * lead, dtype=np.float64)
    return np.zeros_like(ratio)


def corner_in_cyc_per_mrad(*, corner_Hz: float, scan_velocity_mrad_per_s: float) -> float:
    """Corner along the scan of a filter whose corner is given in time.

    Parameters
    ----------
    corner_Hz : float
        Corner frequency in Hz, above zero.
    scan_velocity_mrad_per_s : float
        Scan velocity in mrad/s, above zero.

    Returns
    -------
    float
        corner/velocity in cycles/mrad.

    Raises
    ------
    ParameterError
        When a value is not positive and finite.

    Notes
    -----
    Source: frequency in time = velocity × frequency in angle.
    """
    velocity = positive("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    return positive("corner_Hz", corner_Hz, unit="Hz") / velocity


def _ratio(frequency: ArrayLike, kind: str, corner_cyc_per_mrad: float) -> NDArray[np.float64]:
    if kind not in KINDS:
        raise ParameterError("post_filter", kind, "one of " + ", ".join(KINDS))
    corner = positive("corner_cyc_per_mrad", corner_cyc_per_mrad, unit="cyc/mrad")
    with np.errstate(over="ignore"):
        ratio = np.asarray(frequency, dtype=np.float64) / corner
    return np.asarray(np.clip(ratio, -1e300, 1e300), dtype=np.float64)
