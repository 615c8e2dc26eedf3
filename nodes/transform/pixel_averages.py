"""Averages over a detector's area that a picture has gone through already."""

from __future__ import annotations

from core.chain.wires import Image
from core.lineage.step_lineage import lineage_of
from core.physics.detector.detector_aperture import aperture_mtf
from core.transfer.factors import Separable
from core.transfer.grid import Grid


def detector_averages(image: Image) -> list[Separable]:
    """The factors of detectors' areas on the way to a picture, the last one first."""
    here = Grid(*image.shape, image.interval_x_mrad or 1.0, image.interval_y_mrad or 1.0)
    recipe, averages = image.recipe, []
    while (lineage := lineage_of(recipe)) is not None and lineage.picture is not None:
        before = lineage.linear.grid_before(here)
        averages += [
            factor
            for factor in lineage.linear.transfer(before, here, recipe.node)
            if isinstance(factor, Separable) and any(_is_of_area(law) for law in factor.laws)
        ]
        recipe, here = lineage.picture, before
    return averages


def _is_of_area(law: object) -> bool:
    return getattr(law, "function", None) is aperture_mtf


def width_mrad(average: Separable, axis: str) -> float:
    """How wide an average is along an axis; 0 where it is none."""
    law = average.x if axis == "x" else average.y
    width: float = 0.0 if law is None else dict(law.parameters)["effective_ifov_mrad"] * law.scale
    return width
