"""Pre-amplifier of a scanning sensor: one or more equal poles in time, seen along the scan."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import finite, non_negative, positive, within


def lowpass_mtf(
    *,
    frequency: ArrayLike,
    scan_velocity_mrad_per_s: float,
    time_constant_s: float,
    poles: int = 1,
) -> NDArray[np.float64]:
    """Modulus of the low-pass H = 1/(1 + 2πi·τ·v·frequency)^n.

    Parameters
    ----------
    frequency : array_like
        Frequencies along the scan in cycles/mrad, any shape, finite.
    scan_velocity_mrad_per_s : float
        Scan velocity v in mrad/s; positive towards +x.
    time_constant_s : float
        Time constant τ of each pole in s, zero or above.
    poles : int
        Number n of equal poles, 1 to 100.

    Returns
    -------
    ndarray of float64
        (1 + (2πτv·frequency)²)^(−n/2).

    Source: Tantalo 1996, section 4.9.2 and eq. 4.60 (one pole).
    """
    count = pole_count(poles)
    size = _phase_size(frequency, scan_velocity_mrad_per_s, time_constant_s)
    with np.errstate(over="ignore"):
        return np.asarray(np.hypot(1.0, size) ** -float(count), dtype=np.float64)


def lowpass_ptf(
    *,
    frequency: ArrayLike,
    scan_velocity_mrad_per_s: float,
    time_constant_s: float,
    poles: int = 1,
) -> NDArray[np.float64]:
    """Phase of the low-pass of `lowpass_mtf`: −n·arctan(2πτv·frequency), radians.

    A lag to +x when the scan runs to +x. Source: Tantalo 1996, section 4.9.2 (one pole).
    """
    count = pole_count(poles)
    size = _phase_size(frequency, scan_velocity_mrad_per_s, time_constant_s)
    return np.asarray(-count * np.arctan(size), dtype=np.float64)


def noise_bandwidth_hz(*, time_constant_s: float) -> float:
    """Bandwidth of the detector noise, Hz: 1/(2τ) (Tantalo 1996, section 4.6)."""
    return 0.5 / positive("time_constant_s", time_constant_s, unit="s")


def dwell_time_s(*, interval_mrad: float, scan_velocity_mrad_per_s: float) -> float:
    """Time the scan stays on one sample, interval/velocity: the time constant where none is given.

    The velocity is of either sign, not zero. Source: Tantalo 1996, section 4.9.2: 30° in 512
    samples at 16 Hz have a bandwidth of 49152 Hz.
    """
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    if velocity == 0.0:
        allowed = "other than 0 if the time constant comes from the scan"
        raise ParameterError("scan_velocity_mrad_per_s", velocity, allowed, unit="mrad/s")
    return positive("interval_mrad", interval_mrad, unit="mrad") / abs(velocity)


def mirror_scan_velocity_mrad_per_s(*, scan_mirror_rate_Hz: float) -> float:
    """Angular velocity of a mirror that turns once per line: 2π·1000·rate (Tantalo 1996, 4.9.2)."""
    rate = non_negative("scan_mirror_rate_Hz", scan_mirror_rate_Hz, unit="Hz")
    return 2.0 * math.pi * 1000.0 * rate


def pole_count(poles: int) -> int:
    """The number of equal poles of a filter, checked: a whole number from 1 to 100."""
    if within("poles", poles, 1, 100) != int(poles):
        raise ParameterError("poles", poles, "a whole number, 1 to 100")
    return int(poles)


def _phase_size(
    frequency: ArrayLike, scan_velocity_mrad_per_s: float, time_constant_s: float
) -> NDArray[np.float64]:
    """2πτv·frequency, without unit."""
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    lag = velocity * non_negative("time_constant_s", time_constant_s, unit="s")
    scale = 2.0 * math.pi * finite("time constant × scan velocity", lag, unit="mrad")
    # The largest float64 stands in for infinity, so that zero frequency stays zero.
    scale = max(-1e300, min(scale, 1e300))
    with np.errstate(over="ignore"):
        return np.asarray(scale * np.asarray(frequency, dtype=np.float64), dtype=np.float64)


# Post filters behind the amplifier: low-pass, high-pass and boost, along one axis.

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
    """Phase of a post filter in radians, odd in frequency, the scan running towards +x.

    −n·arctan(u) for `lowpass`, n·(±π/2 − arctan(u)) for `highpass`, and 0 at frequency 0; 0 for
    `none` and `boost`. Arguments as of `post_filter_mtf`. Source: linear network theory.
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
    """Corner along the scan of a filter whose corner is given in time: corner/velocity."""
    velocity = positive("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    return positive("corner_Hz", corner_Hz, unit="Hz") / velocity


def _ratio(frequency: ArrayLike, kind: str, corner_cyc_per_mrad: float) -> NDArray[np.float64]:
    if kind not in KINDS:
        raise ParameterError("post_filter", kind, "one of " + ", ".join(KINDS))
    corner = positive("corner_cyc_per_mrad", corner_cyc_per_mrad, unit="cyc/mrad")
    with np.errstate(over="ignore"):
        ratio = np.asarray(frequency, dtype=np.float64) / corner
    return np.asarray(np.clip(ratio, -1e300, 1e300), dtype=np.float64)
