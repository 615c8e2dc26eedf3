"""Floating-point faults become errors of the node they happen on, never NaN or infinity."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError


@contextmanager
def watched(node: str | None) -> Iterator[None]:
    """Refuse overflow, division by zero and invalid operations inside the block.

    Raises
    ------
    DataError
        Placed on `node`.
    """
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except ArithmeticError as error:
        raise DataError(
            f"the numbers leave the range of floating point ({error}): "
            "a parameter or a sample is too large or too small",
            node=node,
        ) from error


def require_finite(values: NDArray[Any]) -> None:
    """Refuse a transform of numbers too large for it, which raises no error by itself.

    Raises
    ------
    FloatingPointError
        For `watched` to make a `DataError` of.
    """
    # One bad sample spreads over its whole transform, so that the sum cannot miss it.
    if not np.isfinite(np.sum(values, dtype=np.result_type(values.dtype, np.float64))):
        raise FloatingPointError("overflow encountered in transform")
