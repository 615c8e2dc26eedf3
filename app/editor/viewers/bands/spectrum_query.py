"""The queries of a picture's spectra: its mean, and that of one sample."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from app.editor.viewers.pixels.band_choice import bands_of
from core.chain.engine import Plan

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class MeanSpectrumQuery(Query):
    """The mean of every band of the picture on a port; None where it has no bands.

    It waits until edits pause: the whole of a file may have to be read for it.
    """

    waits: ClassVar[bool] = True

    port: str

    def key(self, plan: Plan) -> Hashable:
        """The bands."""
        bands = bands_of(plan.output(self.port))
        return bands and bands.key

    def answer(self, passing: Passing) -> Vector | None:
        """Means, (bands,)."""
        bands = bands_of(passing.plan.output(self.port))
        return None if bands is None else np.asarray(passing.work.value(bands.means()))


@dataclass(frozen=True)
class SampleSpectrumQuery(Query):
    """All bands of one sample of the picture on a port.

    None where the picture has no bands or no such sample, or every band would have to be filtered.
    """

    urgency: ClassVar[int] = 1

    port: str
    row: int
    column: int

    def key(self, plan: Plan) -> Hashable:
        """The bands, and where."""
        bands = bands_of(plan.output(self.port))
        return bands and (bands.key, self.row, self.column)

    def answer(self, passing: Passing) -> Vector | None:
        """The spectrum, (bands,)."""
        image: Any = passing.plan.output(self.port)
        bands = bands_of(image)
        if bands is None or not (0 <= self.row < image.rows and 0 <= self.column < image.columns):
            return None
        recipe = bands.spectrum(self.row, self.column)
        return None if recipe is None else np.asarray(passing.work.value(recipe))
