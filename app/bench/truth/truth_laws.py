"""Truth for laws of one variable, in mpmath where it is installed, without the measured code."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

NEEDS_MPMATH = "not measured: its truth needs mpmath, which is not installed (extra `peers`)"


def mpmath() -> Any:
    """The module mpmath at 40 digits, or None where it is not installed."""
    try:
        import mpmath as module
    except ImportError:
        return None
    context = module.mp.clone()
    context.dps = 40
    return context


def disc_band_mean(mp: Any, lag_per_um: float, diameter_mm: float, band: Sequence[float]) -> float:
    """Mean of a disc's OTF over a band, frequency `lag_per_um` in mm a µm; adaptive integral."""
    if lag_per_um == 0:
        return 1.0
    low, high = (mp.mpf(end) for end in band)
    cutoff = mp.mpf(diameter_mm) / mp.mpf(lag_per_um)

    def otf(wavelength: Any) -> Any:
        v = wavelength / cutoff
        return 0 if v >= 1 else 2 / mp.pi * (mp.acos(v) - v * mp.sqrt(1 - v * v))

    ends = [low, *([cutoff] if low < cutoff < high else []), high]
    return float(mp.quad(otf, ends) / (high - low))


def charge_transfer(mp: Any, w: float, transfers: int, efficiency: str) -> tuple[float, float]:
    """MTF and unwrapped PTF of N transfers: the product of all of them, in extended precision."""
    share = mp.mpf(efficiency)
    one = share / (1 - (1 - share) * mp.expj(-mp.mpf(w)))
    return float(abs(one) ** transfers), float(transfers * mp.arg(one))


def poisson_cumulative(mean: float) -> Array:
    """P(count ≤ k) for k = 0 … far beyond the mean, as the sum of the probabilities."""
    last = math.ceil(mean + 40.0 * math.sqrt(mean) + 40.0)
    logarithms = [k * math.log(mean) - mean - math.lgamma(k + 1) for k in range(last)]
    return np.asarray(np.minimum(np.cumsum(np.exp(logarithms)), 1.0))
