"""Where a converter ends, from the samples that pile up there."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAST = 64  # samples at the end of the values that make a pile


def clipped_ends(*, picture: Matrix) -> tuple[float | None, float | None]:
    """Lowest and highest value where samples pile up there: clipped.

    Raises
    ------
    DataError
        For samples that are not finite.
    """
    low, high = float(picture.min()), float(picture.max())
    if not (math.isfinite(low) and math.isfinite(high)):
        raise DataError("the picture has samples that are not finite numbers: noise needs finite")
    if low == high:
        return None, None
    return (
        low if _piled_up(picture, low, np.min) else None,
        high if _piled_up(picture, high, np.max) else None,
    )


def _piled_up(picture: Matrix, end: float, nearest: Callable[[Matrix], Any]) -> bool:
    """Whether the end of the values holds at least as many samples as what lies next to it.

    Noise has tails: its last value is a rare one.
    """
    at_end = picture == end
    many = int(np.count_nonzero(at_end))
    if many < _LEAST:
        return False
    others = picture[~at_end]
    return many >= int(np.count_nonzero(others == nearest(others)))


def samples_that_count(
    *, picture: Matrix, avoid: Mask | None, low: float | None, high: float | None
) -> Mask | None:
    """Samples that count: not avoided, and not clipped; None where all do."""
    good = None if avoid is None else ~avoid
    for end in (low, high):
        if end is not None:
            free = picture != end
            good = free if good is None else good & free
    return good
