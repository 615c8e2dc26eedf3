"""Sinusoidal vibration of the line of sight during one exposure."""

from __future__ import annotations

import math
import sys

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import j0

from core.errors import ParameterError
from core.physics.numerics.quadrature import gauss_legendre
from core.physics.numerics.scalar_checks import non_negative

# Up to this much phase swept along the remainder one Gauss rule is exact to rounding; beyond,
# the paths of steepest descent are.
_SWEPT_RAD = 32.0
_GAUSS_NODES = 64
_BLOCK = 256
# The J0 of a larger argument is below rounding, and its phase is unknown in float64.
_LARGEST_ARGUMENT = 1e32


def vibration_mtf(
    *,
    frequency: ArrayLike,
    amplitude_mrad: float,
    vibration_frequency_Hz: float | None = None,
    integration_time_s: float | None = None,
) -> NDArray[np.float64]:
    """MTF of a sinusoidal vibration along one axis.

    Parameters
    ----------
    frequency : array_like
        Frequencies along this axis in cycles/mrad, any shape, finite.
    amplitude_mrad : float
        Amplitude A of the motion A·sin(2πft) in mrad, zero or above.
    vibration_frequency_Hz, integration_time_s : float, optional
        Frequency f and exposure t, zero or above. Empty or 0: many periods in one exposure.

    Returns
    -------
    ndarray of float64
        For whole (or many) periods the signed J0(2πA·frequency). With a part of a period left
        over, the modulus of `vibration_otf`, whose phase is then neither 0 nor π.

    Raises
    ------
    ParameterError
        When a value is negative or not finite.

    Notes
    -----
    Source: N. S. Kopeika, A System Engineering Approach to Imaging (SPIE, 1998). With a remainder,
    a lobe in which J0 is negative comes out positive; `vibration_otf` keeps its phase.
    """
    otf = vibration_otf(
        frequency=frequency,
        amplitude_mrad=amplitude_mrad,
        vibration_frequency_Hz=vibration_frequency_Hz,
        integration_time_s=integration_time_s,
    )
    periods = _periods(vibration_frequency_Hz, integration_time_s)
    # The modulus may exceed 1 by a rounding error of the quadrature.
    modulus = otf.real if periods is None else np.minimum(np.abs(otf), 1.0)
    return np.asarray(modulus, dtype=np.float64)


def vibration_otf(
    *,
    frequency: ArrayLike,
    amplitude_mrad: float,
    vibration_frequency_Hz: float | None = None,
    integration_time_s: float | None = None,
) -> NDArray[np.complex128]:
    """Transfer function of a sinusoidal vibration that starts at phase 0 with the exposure.

    Parameters
    ----------
    frequency, amplitude_mrad, vibration_frequency_Hz, integration_time_s
        As in `vibration_mtf`.

    Returns
    -------
    ndarray of complex128
        The mean of exp(−2πi·A·frequency·sin(2πf·t')) over the exposure; real for whole periods.

    Raises
    ------
    ParameterError
        When a value is negative or not finite.

    Notes
    -----
    Source: time average of a displaced image. n whole periods give J0, the remainder its own
    integral, each weighted by its time.
    """
    amplitude = non_negative("amplitude_mrad", amplitude_mrad, unit="mrad")
    periods = _periods(vibration_frequency_Hz, integration_time_s)
    with np.errstate(over="ignore"):
        argument = 2.0 * math.pi * (amplitude * np.asarray(frequency, dtype=np.float64))
    argument = np.clip(argument, -_LARGEST_ARGUMENT, _LARGEST_ARGUMENT)
    whole = np.asarray(j0(argument), dtype=np.complex128)
    if periods is None:
        return whole
    count = math.floor(periods)
    share = (periods - count) / periods
    size = np.abs(argument)
    part = _partial_mean(size.ravel(), 2.0 * math.pi * (periods - count)).reshape(size.shape)
    part = np.where(argument < 0.0, part.conj(), part)
    otf = (1.0 - share) * whole + share * part if count else part
    return np.asarray(np.where(argument == 0.0, 1.0, otf), dtype=np.complex128)


def _periods(
    vibration_frequency_Hz: float | None, integration_time_s: float | None
) -> float | None:
    """Periods in one exposure, or None when they are whole (to rounding) or many."""
    rate = non_negative("vibration_frequency_Hz", vibration_frequency_Hz or 0.0, unit="Hz")
    time = non_negative("integration_time_s", integration_time_s or 0.0, unit="s")
    periods = rate * time
    if not math.isfinite(periods):
        raise ParameterError("periods in one exposure", periods, "a finite number")
    rounding = 4.0 * sys.float_info.epsilon * periods
    nearest = round(periods)
    if periods == 0.0 or (nearest >= 1 and abs(periods - nearest) <= rounding):
        return None
    return periods


def _partial_mean(size: NDArray[np.float64], end: float) -> NDArray[np.complex128]:
    """Mean of exp(−i·size·sin θ) over θ from 0 to `end`, less than a whole turn."""
    swept = size * _swept(end)
    gentle = swept <= _SWEPT_RAD
    mean = np.empty(size.shape, dtype=np.complex128)
    mean[gentle] = _gauss_mean(size[gentle], end)
    steep = np.flatnonzero(~gentle)
    for start in range(0, steep.size, _BLOCK):
        block = steep[start : start + _BLOCK]
        mean[block] = _descent_integral(size[block], end) / end
    return mean


def _swept(end: float) -> float:
    """Total variation of the sine from 0 to `end`."""
    if end <= 0.5 * math.pi:
        return math.sin(end)
    return 2.0 - math.sin(end) if end <= 1.5 * math.pi else 4.0 + math.sin(end)


def _gauss_mean(size: NDArray[np.float64], end: float) -> NDArray[np.complex128]:
    nodes, weights = gauss_legendre(_GAUSS_NODES)
    sines = np.sin(0.5 * end * (1.0 + nodes))
    phase = np.multiply.outer(size, sines)
    half = 0.5 * weights
    return np.asarray(np.cos(phase) @ half - 1j * (np.sin(phase) @ half), dtype=np.complex128)


def _descent_integral(size: NDArray[np.float64], end: float) -> NDArray[np.complex128]:
    """Integral of exp(−i·size·sin θ) from 0 to `end`, for many oscillations.

    On each monotone stretch of the sine the contour is turned down from both ends, where the
    integrand decays without oscillating: the cost does not grow with `size`.
    """
    total = _descent(size, 0.0, 1.0)
    forward = 1.0
    if end > 0.5 * math.pi:
        total -= 2.0 * _descent(size, 1.0, 0.0)
        forward = -1.0
    if end > 1.5 * math.pi:
        total += 2.0 * _descent(size, -1.0, 0.0)
        forward = 1.0
    return total - forward * _descent(size, math.sin(end), abs(math.cos(end)))


def _descent(size: NDArray[np.float64], sine: float, cosine: float) -> NDArray[np.complex128]:
    """Integral of exp(−i·size·w)/√(1 − w²) dw from w = `sine` straight down to −i∞.

    With w = sine − i·q/size the integrand is e^{−q} times an algebraic function, whose branch
    points lie on the imaginary axis of q: the trapezoidal rule in ln q converges exponentially,
    alike for every distance of `sine` from ±1.
    """
    step = 0.25
    q = np.exp(np.arange(-76.0, 3.75, step))
    depth = np.divide.outer(1.0 / size, 1.0 / q)
    root = np.sqrt(cosine**2 + depth * (depth + 2j * sine))
    integral = np.sum(np.exp(-q) * depth / root, axis=-1) * step
    return np.asarray(-1j * np.exp(-1j * size * sine) * integral, dtype=np.complex128)
