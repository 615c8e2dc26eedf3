"""Who makes an array leaves it to the caller where it lies: in memory, or on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Empty = Callable[[tuple[int, ...], np.dtype[Any]], NDArray[Any]]
"""Makes an array of a shape and type to be filled in: `numpy.empty`, or `Work.empty`."""
