"""Pictures of a camera that are given as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.measure.picture_loading import NO_DATA, limits_of
from core.errors import DataError

_FRAMES = 3  # dimensions


def frames_of_arrays(pictures: Sequence[Any]) -> list[list[NDArray[np.float64]]]:
    """The frames of each array, (rows, columns) or (frames, rows, columns), in double precision.

    Raises
    ------
    DataError
        An array is no picture, or has samples that are not finite.
    """
    return [_frames(np.asarray(picture), number) for number, picture in enumerate(pictures, 1)]


def limits_of_arrays(pictures: Sequence[Any]) -> tuple[float, float] | None:
    """Ends of whole numbers, where all arrays have the same."""
    ends = {limits_of(np.asarray(picture).dtype) for picture in pictures}
    return ends.pop() if len(ends) == 1 else None


def _frames(array: NDArray[Any], number: int) -> list[NDArray[np.float64]]:
    if array.dtype.kind not in "buif" or array.ndim not in (2, _FRAMES) or 0 in array.shape:
        raise DataError(
            f"picture {number} is an array of {array.dtype} of shape {array.shape}; allowed: "
            "real numbers, (rows, columns) or (frames, rows, columns)"
        )
    if not np.isfinite(array).all():
        raise DataError(f"picture {number} has samples that are not finite; {NO_DATA}")
    own = [*array] if array.ndim == _FRAMES else [array]
    return [np.asarray(frame, np.float64) for frame in own]
