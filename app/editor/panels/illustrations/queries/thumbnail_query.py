"""The query for a source's picture, answered by a small grey one."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.queries.shrinking import shrunk
from app.editor.viewers.pixels.grey_levels import extremes, grey_levels
from core.chain.engine import Plan
from core.chain.wires import Image

MOST_SAMPLES = 320  # across or along


@dataclass(frozen=True, eq=False)
class Thumbnail:
    """A picture made small.

    Parameters
    ----------
    grey : ndarray of uint8, shape (high, wide)
        From its least to its greatest sample, C order.
    image : Image
        What it is a picture of.
    low, high : float
        Extremes of the picture itself.
    """

    grey: NDArray[np.uint8]
    image: Image
    low: float
    high: float


@dataclass(frozen=True)
class ThumbnailQuery(Query):
    """The picture that the node gives."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        """The picture."""
        image: Image = plan.output(f"{self.node}.image")
        return image.key, image.unit

    def answer(self, passing: Passing) -> Thumbnail:
        """The picture, small."""
        image: Image = passing.plan.output(f"{self.node}.image")
        samples = passing.work.value(image.recipe)
        low, high = extremes(samples, for_each=passing.work.for_each)
        small = shrunk(samples, MOST_SAMPLES)
        return Thumbnail(grey_levels(small, low, high), image, low, high)
