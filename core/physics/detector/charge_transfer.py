"""Charge left behind at each transfer of a CCD."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.numerics.scalar_checks import non_negative, within

MODELS = ("exact", "published", "leading")


def charge_transfer_mtf(
    *, phase_per_transfer: ArrayLike, transfers: float, efficiency: float, model: str = "exact"
) -> NDArray[np.float64]:
    """MTF of incomplete charge transfer along the read-out direction.

    Parameters
    ----------
    phase_per_transfer : array_like
        w = 2π·xi·Δ in radians, any shape, finite; π at Nyquist.
    transfers : float
        Number N of transfers, zero or above.
    efficiency : float
        Share ε of the charge that moves on at each transfer, 0 to 1.
    model : str
        `exact`: |ε/(1 − (1−ε)e^{−iw})|^N. `published` and `leading`: exp(−N(1−ε)(1 − cos w)).

    Returns
    -------
    ndarray of float64
        MTF from 0 to 1, of the shape of `phase_per_transfer`.

    Raises
    ------
    ParameterError
        When a value is out of range or the model has another name.

    Notes
    -----
    Source: Tantalo 1996, eq. 4.57, after LeBlanc and Contini (1990); exact form: the product of N
    transfers. 1 − cos w is taken as 2·sin²(w/2), which keeps its digits near w = 0.
    """
    count, lost = _count_and_loss(transfers, efficiency, model)
    half_sine = np.abs(np.sin(0.5 * np.asarray(phase_per_transfer, dtype=np.float64)))
    if count == 0.0:
        return np.ones_like(half_sine)
    if model == "exact":
        exponent = -count * _log_one_transfer(half_sine, float(efficiency), lost)
    else:
        exponent = -2.0 * count * lost * np.square(half_sine)
    return np.asarray(np.exp(exponent), dtype=np.float64)


def charge_transfer_ptf(
    *, phase_per_transfer: ArrayLike, transfers: float, efficiency: float, model: str = "exact"
) -> NDArray[np.float64]:
    """PTF of incomplete charge transfer along the read-out direction, not wrapped.

    Parameters
    ----------
    phase_per_transfer : array_like
        w = 2π·xi·Δ in radians, any shape, finite; π at Nyquist.
    transfers : float
        Number N of transfers, zero or above.
    efficiency : float
        Share ε of the charge that moves on at each transfer, 0 to 1.
    model : str
        `exact`: −N·arctan((1−ε)sin w/(1 − (1−ε)cos w)). `published`: −N(1−ε)(w − sin w).
        `leading`: −N(1−ε)·sin w, the first term of `exact`.

    Returns
    -------
    ndarray of float64
        Phase in radians, odd in w; charge that lags behind gives a negative one.

    Raises
    ------
    ParameterError
        When a value is out of range or the model has another name.

    Notes
    -----
    Source: Tantalo 1996, eq. 4.58. Erratum: the published phase starts with w³; that of N
    transfers starts as −N(1−ε)·w. Series for w − sin w below 1 radian, where it cancels.
    """
    count, lost = _count_and_loss(transfers, efficiency, model)
    phase = np.asarray(phase_per_transfer, dtype=np.float64)
    if model == "published":
        return np.asarray(-count * lost * _minus_sine(phase), dtype=np.float64)
    if model == "leading":
        return np.asarray(-count * lost * np.sin(phase), dtype=np.float64)
    real_part = float(efficiency) + 2.0 * lost * np.square(np.sin(0.5 * phase))
    return np.asarray(-count * np.arctan2(lost * np.sin(phase), real_part), dtype=np.float64)


def _count_and_loss(transfers: float, efficiency: float, model: str) -> tuple[float, float]:
    count = non_negative("transfers", transfers)
    share = within("efficiency", efficiency, 0.0, 1.0)
    if model not in MODELS:
        raise ParameterError("model", model, "one of " + ", ".join(MODELS))
    # An efficiency is typed as a decimal; 1 − 0.99999 in float64 keeps eleven digits of the loss.
    return count, float(1 - Decimal(repr(share)))


def _log_one_transfer(
    half_sine: NDArray[np.float64], efficiency: float, lost: float
) -> NDArray[np.float64]:
    """Natural logarithm of |1 − (1−ε)e^{−iw}|/ε, zero or above.

    |1 − (1−ε)e^{−iw}|² = ε² + 4(1−ε)sin²(w/2).
    """
    # At ε = 0 the smallest float64 stands in for it: zero beyond w = 0, and 1 there.
    with np.errstate(over="ignore"):
        ratio = 2.0 * math.sqrt(lost) * half_sine / max(efficiency, math.ulp(0.0))
        large = np.log(np.hypot(1.0, ratio))
        small = 0.5 * np.log1p(np.square(ratio))
    return np.asarray(np.where(ratio < 1.0, small, large), dtype=np.float64)


def _minus_sine(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Difference x − sin x, without cancellation."""
    square = np.square(np.clip(x, -1.0, 1.0))
    series = np.ones_like(square)
    for order in (17, 15, 13, 11, 9, 7, 5):
        series = 1.0 - square / (order * (order - 1)) * series
    near = x * square / 6.0 * series
    return np.asarray(np.where(np.abs(x) < 1.0, near, x - np.sin(x)), dtype=np.float64)
