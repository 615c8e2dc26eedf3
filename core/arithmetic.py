"""Floating-point faults become errors of the node they happen on, never NaN or infinity."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

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
