"""Pictures in a converter's numbers, which integer files hold as they are."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

DIGITAL_NUMBER = "DN"
_BLOCK_ROWS = 256


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
