"""Transfer factors that a picture has gone through already."""

from __future__ import annotations

from core.chain.wires import Image
from core.lineage.step_lineage import lineage_of
from core.transfer.factors import Factor
from core.transfer.grid import Grid


def passed_factors(image: Image) -> list[Factor]:
    """The factors on the way to a picture, those of the last step first."""
    here = Grid(*image.shape, image.interval_x_mrad or 1.0, image.interval_y_mrad or 1.0)
    recipe = image.recipe
    factors: list[Factor] = []
    while (lineage := lineage_of(recipe)) is not None and lineage.picture is not None:
        before = lineage.linear.grid_before(here)
        factors += lineage.linear.transfer(before, here, recipe.node)
        recipe, here = lineage.picture, before
    return factors
