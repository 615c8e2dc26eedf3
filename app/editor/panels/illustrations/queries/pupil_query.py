"""The query for the samples of a pupil that has no geometric shape."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.queries.shrinking import shrunk
from core.chain.engine import Plan
from core.chain.wires import Pupil

MOST_SAMPLES = 256  # across or along, of what is drawn


@dataclass(frozen=True, eq=False)
class SmallPupil:
    """A pupil's transmission, ready to be drawn.

    Parameters
    ----------
    levels : ndarray of uint8, shape (high, wide)
        0 opaque to 255 transparent, C order.
    rows, columns : int
        Of the pupil array itself.
    open_share : float
        Mean transmission of the array.
    """

    levels: NDArray[np.uint8]
    rows: int
    columns: int
    open_share: float


@dataclass(frozen=True)
class PupilQuery(Query):
    """What the file of an exit pupil holds."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        """The pupil."""
        pupil: Pupil = plan.output(f"{self.node}.pupil")
        return pupil.key

    def answer(self, passing: Passing) -> SmallPupil | None:
        """The samples, fewer of them; None for a geometric shape."""
        pupil: Pupil = passing.plan.output(f"{self.node}.pupil")
        if pupil.shape is not None:
            return None
        samples = passing.work.value(pupil.samples)
        small = shrunk(samples, MOST_SAMPLES)
        levels = np.rint(255 * np.clip(small, 0, 1)).astype(np.uint8)
        return SmallPupil(levels, pupil.rows, pupil.columns, float(samples.mean()))
