"""A response that bends down towards the full well."""

from __future__ import annotations

from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from core.physics.numerics.scalar_checks import positive, within

FloatOrArray = TypeVar("FloatOrArray", float, NDArray[Any])
HIGHEST_PERCENT = 25.0
"""With it the response just reaches the full well."""


def bent_response(
    *,
    electrons: FloatOrArray,
    full_well_e: float,
    nonlinearity_percent: float,
    out: NDArray[Any] | None = None,
) -> FloatOrArray:
    """Electrons as the read-out sees them: N·(1 − p·N/well), p percent too few at the full well.

    Parameters
    ----------
    electrons : float or ndarray
        Collected.
    full_well_e : float
        Above 0.
    nonlinearity_percent : float
        0 to 25.
    out : ndarray, optional
        Where to put those of an array; not that array itself.

    Returns
    -------
    float or ndarray
        The largest value of the parabola from there on, so that more light never gives less.

    Notes
    -----
    Source: Janesick 2007, Photon Transfer, chapter 7: V/V and V/e nonlinearity to first order.
    """
    percent = within("nonlinearity_percent", nonlinearity_percent, 0.0, HIGHEST_PERCENT)
    well = positive("full_well_e", full_well_e, unit="e-")
    if percent == 0.0:
        return electrons if out is None else cast(FloatOrArray, np.positive(electrons, out=out))
    curvature = percent / 100.0 / well
    # A third of the time of numpy's minimum by a number.
    result: Any = np.clip(electrons, -np.inf, 0.5 / curvature, out=out)
    factor = result * -curvature
    factor += 1.0
    result *= factor
    return cast(FloatOrArray, result)


def bent_slope(*, electrons: float, full_well_e: float, nonlinearity_percent: float) -> float:
    """Its derivative, 1 − 2·p·N/well; 0 from the largest value on."""
    share = 2.0 * nonlinearity_percent / 100.0 * electrons / positive("full_well_e", full_well_e)
    return max(1.0 - share, 0.0)
