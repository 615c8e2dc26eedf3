"""What the thesis' row average of an upright edge should show, computed in one dimension.

The edge lies at one place among the samples. What they cannot show of it beyond their Nyquist
frequency is folded back, and an interpolated picture differs from place to place: no product of
MTFs gives what is measured. But all rows are alike, so that one of them is soon followed through
every step, and measured in the same way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.lineage.linear_change import Axis, Linear
from core.lineage.step_lineage import lineage_of

Vector = NDArray[np.float64]


def edge_row(work: Work, recipe: Recipe, source: Recipe, axis: Axis, samples: int) -> Vector:
    """A row, or column, of a picture whose source is an edge through the middle of `samples`.

    Raises
    ------
    DataError
        Where a step of the picture is not known as a transfer function.
    """
    changes: list[Linear] = []
    while recipe.key != source.key:
        lineage = lineage_of(recipe)
        if lineage is None or lineage.picture is None:
            raise DataError(f"what {recipe.node} does to the picture is not known")
        changes.append(lineage.linear)
        recipe = lineage.picture
    row = np.clip(np.arange(samples) + 1.0 - samples / 2, 0.0, 1.0)
    for change in reversed(changes):
        row = change.row(work, row, axis)
    return np.asarray(row, np.float64)
