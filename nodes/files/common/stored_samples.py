"""Samples in the type that a file stores: whole, in its range, or refused."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError, several

DIGITAL_NUMBER = "DN"
"""Unit of a converter's numbers, which integer files hold as they are."""

SAMPLE_TYPES: Mapping[str, np.dtype[Any]] = MappingProxyType(
    {
        "half": np.dtype(np.float16),
        "float": np.dtype(np.float32),
        "double": np.dtype(np.float64),
        "uint8": np.dtype(np.uint8),
        "uint16": np.dtype(np.uint16),
    }
)
_BLOCK_ROWS = 256


def as_picture(array: ArrayLike) -> NDArray[Any]:
    """Real samples as (rows, columns, channels), not empty; else `DataError`."""
    samples = np.asarray(array)
    if samples.dtype.kind not in "buif":
        raise DataError(
            f"samples of type {samples.dtype} cannot be written as a picture; allowed: real numbers"
        )
    if samples.ndim == 2:
        samples = samples[:, :, None]
    if samples.ndim != 3 or samples.size == 0:
        raise DataError(
            f"an array of shape {np.shape(array)} cannot be written as a picture; "
            "allowed: (rows, columns) or (rows, columns, channels), not empty"
        )
    return samples


def as_stored(
    samples: NDArray[Any], dtype: str, low: float | None, high: float | None
) -> NDArray[Any]:
    """Samples (rows, columns, channels) in the type of that name in `SAMPLE_TYPES`, C order.

    For the integer types `low` and `high` become 0 and the largest integer (linear, nearest,
    clipped); without them the samples must be whole numbers within the range already.
    """
    kind = SAMPLE_TYPES[dtype]
    if kind.kind == "u":
        stored = np.empty(samples.shape, kind)
        for top in range(0, len(samples), _BLOCK_ROWS):  # as doubles they take four times as much
            stored[top : top + _BLOCK_ROWS] = _as_integers(
                samples[top : top + _BLOCK_ROWS], kind, low, high, top
            )
        return stored
    if low is not None or high is not None:
        raise ParameterError(
            "low, high",
            (low, high),
            f"leave low and high empty with dtype {dtype}; only uint8 and uint16 are scaled",
        )
    return _as_floats(samples, kind)


def integer_type(samples: NDArray[Any], unit: str, allowed: tuple[str, ...]) -> str | None:
    """The integer type that holds the numbers of a picture as they are, of those allowed.

    None for a picture in another unit, or one whose samples are not whole, negative, or too large:
    of a camera without a converter, say.
    """
    if unit != DIGITAL_NUMBER or "uint16" not in allowed:
        return None
    top = np.iinfo(np.uint16).max
    for start in range(0, samples.shape[0], _BLOCK_ROWS):
        rows = samples[start : start + _BLOCK_ROWS]
        if rows.min() < 0 or rows.max() > top or (rows != np.rint(rows)).any():
            return None
    return "uint16"


def _as_floats(samples: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    if samples.dtype == dtype:
        return np.ascontiguousarray(samples)
    with np.errstate(over="ignore", invalid="ignore"):
        stored = np.ascontiguousarray(samples, dtype=dtype)
    largest = float(np.finfo(dtype).max)
    overflowed = np.isinf(stored) & np.isfinite(samples)
    if overflowed.any():
        row, column, _ = np.argwhere(overflowed)[0]
        raise DataError(
            f"the range of {dtype}, ±{largest:.6g}, is too small for "
            f"{several(int(overflowed.sum()), 'sample')}, the first at row {row}, column {column}"
        )
    return stored


def _as_integers(
    samples: NDArray[Any], dtype: np.dtype[Any], low: float | None, high: float | None, first: int
) -> NDArray[Any]:
    top = np.iinfo(dtype).max
    values = samples.astype(np.float64)
    if not np.isfinite(values).all():
        row, column, _ = np.argwhere(~np.isfinite(values))[0]
        raise DataError(
            f"the sample at row {first + row}, column {column} is not finite and cannot be stored "
            f"as {dtype}"
        )
    if low is None and high is None:
        wrong = (values != np.rint(values)) | (values < 0) | (values > top)
        if wrong.any():
            row, column, _ = np.argwhere(wrong)[0]
            raise DataError(
                f"sample {values[row, column].ravel()[0]:g} at row {first + row}, column {column} "
                f"does not fit {dtype} (whole numbers, 0 to {top}); give low and high to scale the "
                "samples"
            )
        return values.astype(dtype)
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high - low)):
        raise ParameterError("low, high", (low, high), "two finite numbers or none")
    if not high > low:
        raise ParameterError("high", high, f"above low = {low:g}")
    # Clipped first: a sample far outside the range could overflow in the division.
    values = (np.clip(values, low, high) - low) / (high - low)
    return np.rint(values * top).astype(dtype)
