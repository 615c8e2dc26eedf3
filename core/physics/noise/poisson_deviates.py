"""Photon noise: the means of its Poisson deviates, and pictures from the deviates."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError, ParameterError

Floats = TypeVar("Floats", NDArray[np.float32], NDArray[np.float64])

_ROUNDING = 1e-5  # of the largest value: what a Fourier blur in single precision can undershoot


def published_means(local_mean: Floats, *, percent: float, out: Floats | None = None) -> Floats:
    """Mean of the Poisson deviate that is added to each sample: a percentage of the local mean.

    Parameters
    ----------
    local_mean
        Gaussian-weighted local mean of the picture, (rows, columns), in the picture's unit.
    percent
        0 or above; 1 means 0.01.
    out
        Where to put the means, if not in a new array.

    Returns
    -------
    Means of the same shape and type, 0 or above. The deviate is added to the picture as it is,
    which ties the strength of the noise to the unit.

    Raises
    ------
    ParameterError
        For a percentage out of range.
    DataError
        For a local mean below 0 beyond rounding.

    Source: Tantalo 1996, section 4.3 (Poisson noise module).
    """
    if not 0.0 <= percent < float("inf"):
        raise ParameterError("percent", percent, "must be 0 or above and finite", unit="%")
    share = local_mean.dtype.type(percent / 100.0)
    return _without_undershoot(np.multiply(local_mean, share, out=out))


def photon_means(radiance: Floats, *, photons_per_unit: float, out: Floats | None = None) -> Floats:
    """Mean photon count of each sample: radiance times the photons one unit of it stands for.

    Parameters
    ----------
    radiance
        Picture, (rows, columns), 0 or above.
    photons_per_unit
        Photons per sample for 1 W m⁻² sr⁻¹, above 0.
    out
        Where to put the means, if not in a new array.

    Returns
    -------
    Means of the same shape and type.

    Raises
    ------
    ParameterError
        For `photons_per_unit` out of range.
    DataError
        For radiance below 0 beyond rounding.
    """
    _require_photons(photons_per_unit)
    unit = radiance.dtype.type(photons_per_unit)
    return _without_undershoot(np.multiply(radiance, unit, out=out))


def radiance_of_photons(
    counts: Floats, *, photons_per_unit: float, out: Floats | None = None
) -> Floats:
    """Picture that photon counts stand for: the way back from `photon_means`."""
    _require_photons(photons_per_unit)
    return np.divide(counts, counts.dtype.type(photons_per_unit), out=out)


def _require_photons(photons_per_unit: float) -> None:
    if not 0.0 < photons_per_unit < float("inf"):
        raise ParameterError("photons_per_unit", photons_per_unit, "must be above 0 and finite")


def _without_undershoot(means: Floats) -> Floats:
    if not means.size:
        return means
    lowest = float(means.min())
    if lowest >= 0.0:
        return means
    highest = float(means.max())
    if not (np.isfinite(lowest) and np.isfinite(highest)):
        raise DataError("Poisson noise: the picture has samples that are not finite")
    if lowest < -_ROUNDING * max(highest, 0.0):
        raise DataError(
            f"Poisson noise: {np.count_nonzero(means < 0.0)} of {means.size} means are below 0,"
            f" the lowest is {lowest:.6g}: photons cannot be counted below 0"
        )
    return np.maximum(means, means.dtype.type(0.0), out=means)
