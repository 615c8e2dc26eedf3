"""The picture without noise: what its noise is measured against."""

from __future__ import annotations

from core.chain.frame_sequence import Remaking
from core.evaluation.recipes import Recipe
from core.lineage.step_lineage import lineage_of


def noise_free(recipe: Recipe, *, but: Recipe | None = None) -> Recipe:
    """The same picture with every noise at its expected value, and nothing rounded.

    Parameters
    ----------
    recipe : Recipe
        Makes the picture.
    but : Recipe, optional
        A step on the way that keeps what it adds.

    Raises
    ------
    DataError
        Where a gain error as printed scales the whole picture.
    """

    def change(part: Recipe) -> Recipe | None:
        lineage = lineage_of(part)
        if lineage is None or lineage.noise is None:
            return None
        picture = made.of(lineage.noise.picture)
        alone = but is not None and part.key == but.key
        return lineage.noise.on(picture) if alone else lineage.noise.free(picture)

    made = Remaking(change)
    return made.of(recipe)
