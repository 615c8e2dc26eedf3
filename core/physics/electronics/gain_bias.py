"""Errors of gain and bias in the conversion from radiance to voltage, detector by detector."""

from __future__ import annotations

from typing import Any, Literal, TypeVar, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError

GainModel = Literal["per_pixel", "published", "literal"]
Floats = TypeVar("Floats", NDArray[np.float32], NDArray[np.float64])


def apply_gain_bias(
    radiance: Floats,
    *,
    gain_pattern: ArrayLike,
    bias_pattern: ArrayLike,
    gain_percent: float,
    bias_percent: float,
    mean_radiance: float,
    model: GainModel = "per_pixel",
) -> Floats:
    """Picture as read through detectors whose gain and bias differ.

    With g, b = percent/100, n₁ and n₂ the patterns and m the mean:

    - `per_pixel`: in·(1 + g·n₁) + b·n₂·m, each detector's gain scales what it sees;
    - `published`: in + (g·n₁ + b·n₂)·m, gain error too as a share of the mean;
    - `literal`: in·(g·m) + b·m, the equation as printed: it scales the whole picture by g·m and
      has no pattern.

    Parameters
    ----------
    radiance
        Picture, (rows, columns), W m⁻² sr⁻¹.
    gain_pattern, bias_pattern
        Standard normal deviates that broadcast against the picture: a scalar for one detector
        (line scanner), (1, columns) or (rows, 1) for a line of detectors, (rows, columns) for an
        array.
    gain_percent, bias_percent
        Spread among detectors in percent (1 means 0.01), 0 or above.
    mean_radiance
        Mean of the picture, W m⁻² sr⁻¹.
    model
        One of the above.

    Returns
    -------
    New picture of the same shape and type.

    Raises
    ------
    ParameterError
        For an unknown model or a negative or non-finite percentage.

    Source: Tantalo 1996, eq. 4.59. Erratum: as printed it multiplies the picture by a number of
    the order of the gain error; the text above it describes `published`.
    """
    for name, percent in (("gain_percent", gain_percent), ("bias_percent", bias_percent)):
        if not 0.0 <= percent < float("inf"):
            raise ParameterError(name, percent, "must be 0 or above and finite", unit="%")
    gain, bias = gain_percent / 100.0, bias_percent / 100.0
    kind = radiance.dtype
    offset = bias * mean_radiance * _typed(bias_pattern, radiance)
    deviation = gain * _typed(gain_pattern, radiance)
    if model == "per_pixel":
        result = radiance * (1.0 + deviation).astype(kind, copy=False)
        result += offset.astype(kind, copy=False)
        return result
    if model == "published":
        return radiance + (mean_radiance * deviation + offset).astype(kind, copy=False)
    if model == "literal":
        return radiance * kind.type(gain * mean_radiance) + kind.type(bias * mean_radiance)
    raise ParameterError("gain_model", model, f"must be one of {', '.join(get_args(GainModel))}")


def _typed(pattern: ArrayLike, radiance: NDArray[Any]) -> NDArray[Any]:
    """In double while small, in its own type where every sample has its own."""
    values = np.asarray(pattern)
    return values if values.size >= radiance.size else values.astype(float)
