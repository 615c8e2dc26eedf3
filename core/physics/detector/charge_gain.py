"""Gain of charge before it is read: excess noise of photoconductors, avalanches, EM registers."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import positive, within

Array = NDArray[Any]
ChargeGain = Literal["none", "photoconductive", "em_register", "avalanche"]

LARGE_SHAPE = 16.0
"""Shape of a gamma deviate from which on the cube root is taken as normal: mean within 1e-6,
variance within 4e-5, quantiles to 3 σ within 1 % of σ. Below it, the quantile is exact."""
_FARTHEST = 8.0  # of a deviate; beyond, Φ(z) rounds to 1


def excess_noise_factor(
    *, charge_gain: ChargeGain, factor: float, register_stages: int, ionization_ratio: float
) -> float:
    """Variance of the multiplied charge over G² times that of the charge before: F.

    Parameters
    ----------
    charge_gain : ChargeGain
        What multiplies. None gives 1; a photoconductor 2, as recombination adds as much variance as
        generation.
    factor : float
        Mean gain G, above 0; at least 1 for register and avalanche.
    register_stages : int
        Stages N of an EM register, G at most 2^N: (2(G − 1)·G^(−1/N) + 1)/G, F² of its literature.
    ionization_ratio : float
        k of an avalanche, 0 to 1: k·G + (1 − k)(2 − 1/G).

    Source: Levine 1993, Quantum-well infrared photodetectors, J. Appl. Phys. 74, R1 (noise current
    4qGI); Robbins and Hadwen 2003, The noise performance of electron multiplying charge-coupled
    devices, IEEE Trans. Electron Devices 50, 1227; McIntyre 1966, Multiplication noise in uniform
    avalanche diodes, IEEE Trans. Electron Devices 13, 164.
    """
    gain = positive("charge_gain_factor", factor)
    if charge_gain in ("none", "photoconductive"):
        return 1.0 if charge_gain == "none" else 2.0
    if gain < 1.0:
        raise ParameterError("charge_gain_factor", factor, f"at least 1 for {charge_gain}")
    if charge_gain == "avalanche":
        ratio = within("ionization_ratio", ionization_ratio, 0.0, 1.0)
        return ratio * gain + (1.0 - ratio) * (2.0 - 1.0 / gain)
    per_stage: float = gain ** (1.0 / positive("register_stages", register_stages))
    if per_stage > 2.0:
        allowed = f"at most 2 per register stage (register_stages = {register_stages})"
        raise ParameterError("charge_gain_factor", factor, allowed)
    return (2.0 * (gain - 1.0) / per_stage + 1.0) / gain


def multiplied_charge(
    *, electrons: Array, deviates: Array, excess_noise_factor: float, out: Array | None = None
) -> Array:
    """Charge behind a noisy gain, over the mean gain: gamma deviates.

    Standard normal deviates are of the shape and type of the electrons, float32 or float64; `out`
    is contiguous, and neither of the two. With F above 1, n electrons give a deviate of mean n and
    variance (F − 1)·n; charge that is not above 0 stays.

    Source: Basden, Haniff and Mackay 2003, Photon counting strategies with low-light-level CCDs,
    Mon. Not. R. Astron. Soc. 345, 985: at F = 2 each electron gives an exponential number. For
    other F the form is an approximation. Wilson and Hilferty 1931 (cube root).
    """
    width, number = excess_noise_factor - 1.0, electrons.dtype.type
    large = np.maximum(electrons, number(LARGE_SHAPE * width))
    ninth = np.divide(number(width / 9.0), large)
    made = np.sqrt(ninth, out=out)
    made *= deviates
    made += number(1.0)
    made -= ninth
    cube = made * made
    made *= cube
    made *= large
    few = np.flatnonzero(electrons.reshape(-1) < number(LARGE_SHAPE * width))
    if few.size:
        before = electrons.reshape(-1)[few].astype(np.float64)
        z = np.clip(deviates.reshape(-1)[few].astype(np.float64), -_FARTHEST, _FARTHEST)
        shape = np.where(before > 0.0, before, 1.0) / width
        exact = width * scipy.special.gammaincinv(shape, scipy.special.ndtr(z))
        made.reshape(-1)[few] = np.where(before > 0.0, exact, before)
    return np.asarray(made)


def low_gain_share(*, high: ArrayLike, switch_level: float, blend: float) -> Array:
    """Share, from 0 to 1, that the read-out of low gain has in a pixel that is read at two gains.

    Parameters
    ----------
    high : array_like
        Read-out of high gain.
    switch_level : float
        Value of `high` beyond which the low gain is used alone, above 0, in the same unit.
    blend : float
        Width of a linear change below it, as a share of it, from 0 to 1; 0 switches at once.

    Source: as in dual-gain sCMOS cameras; Fowler et al. 2010, Proc. SPIE 7536, 753607.
    """
    level = positive("switch_level", switch_level)
    values, width = np.asarray(high, np.float64), level * within("blend", blend, 0.0, 1.0)
    if width == 0.0:
        return np.asarray(values > level, np.float64)
    return np.clip((values - level) / width + 1.0, 0.0, 1.0)
