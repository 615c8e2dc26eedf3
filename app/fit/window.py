"""The part of a picture about an edge."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_found import FoundEdge

Matrix = NDArray[np.float64]

MARGIN = 32  # samples about an edge, beyond which nothing is looked at


@dataclass(frozen=True)
class Window:
    """A part of a picture; beyond its frame the nearest samples stand.

    Parameters
    ----------
    samples : ndarray
        Shape (rows, columns).
    top, left : int
        Row and column of the first sample in the picture.
    """

    samples: Matrix
    top: int
    left: int


def window_about(*, picture: Matrix, edge: FoundEdge) -> Window:
    """The picture about an edge, a margin wide, in a shape that is good to transform."""
    (x1, y1), (x2, y2) = edge.ends
    wide = edge.reach + MARGIN
    first, count = [], []
    for one, other in ((y1, y2), (x1, x2)):
        start = math.floor(min(one, other) - wide)
        first.append(start)
        count.append(scipy.fft.next_fast_len(math.ceil(max(one, other) + wide) + 1 - start, True))
    rows, columns = (
        np.clip(start + np.arange(many), 0, length - 1)
        for start, many, length in zip(first, count, picture.shape, strict=True)
    )
    samples = np.asarray(picture[np.ix_(rows, columns)], np.float64)
    return Window(samples, first[0], first[1])
