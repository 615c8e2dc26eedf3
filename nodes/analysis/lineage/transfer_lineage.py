"""The transfer functions on the way to a picture, from its source on."""

from __future__ import annotations

from dataclasses import dataclass

from core.chain.wires import Image
from core.evaluation.recipes import Recipe
from core.lineage.step_lineage import lineage_of
from core.transfer.factors import Factor
from core.transfer.grid import Grid
from nodes.analysis.lineage.line_transfer import Stage, stages_of


@dataclass(frozen=True)
class ImageTransfer:
    """The linear stages of a picture.

    Parameters
    ----------
    stages : tuple of Stage
        In order, each under a name of its own; none for a picture straight from its source.
    grid : Grid
        Sampling of the picture.
    source_grid : Grid
        Sampling of the scene it stems from.
    source : Recipe
        Makes the scene's samples; of a step whose transfer function is not known, its result.
    gain : float or None
        What a uniform scene is multiplied by, such as the pixels of a sum; None where it is left
        to chance (a gain error as printed).
    area_means : bool
        Whether the source's samples are known to be means over their area, which blurs too.
    levels : tuple of Recipe
        Of the `LevelChange` of each stage whose gain depends on the picture, in order.
    gain_before : float
        What a uniform scene is multiplied by up to the first of these.
    """

    stages: tuple[Stage, ...]
    grid: Grid
    source_grid: Grid
    source: Recipe
    gain: float | None = 1.0
    area_means: bool = False
    levels: tuple[Recipe, ...] = ()
    gain_before: float = 1.0

    @property
    def factors(self) -> tuple[Factor, ...]:
        """All factors, MTF and PTF, of all stages."""
        return tuple(factor for stage in self.stages for factor in stage.factors)

    def part(self, part: str) -> tuple[Stage, ...]:
        """The stages with the factors of their MTF, or of their PTF, alone."""
        stages = (
            Stage(s.label, tuple(f for f in s.factors if f.part == part)) for s in self.stages
        )
        return tuple(stage for stage in stages if stage.factors)


def transfer_of(image: Image, *, of_camera: bool = False) -> ImageTransfer:
    """Every transfer function between the scene and the picture.

    Interpolation counts with the mean over its samples; what folds back from beyond the Nyquist
    frequency is no part of it. `of_camera`: gain and levels count from what reaches the camera on,
    behind the air, as its data sheet has them; the transfer functions are all the same.

    Raises
    ------
    DataError
        If the picture has no sampling interval.
    """
    grid = image.grid()
    factors: list[Factor] = []
    recipe, here, gain, known = image.recipe, grid, 1.0, True
    levels: list[Recipe] = []
    gain_before, counted = 1.0, True
    while (lineage := lineage_of(recipe)) is not None and lineage.picture is not None:
        change = lineage.linear
        before = change.grid_before(here)
        factors = [*change.transfer(before, here, recipe.node), *factors]
        counted = counted and not (of_camera and change.before_camera)
        if counted:
            gain *= change.gain
            gain_before *= change.gain
            if change.level is not None:
                levels.insert(0, change.level)
                gain_before = 1.0
            known = known and not change.by_chance
        recipe, here = lineage.picture, before
    return ImageTransfer(
        stages_of(tuple(factors)),
        grid,
        here,
        recipe,
        gain if known else None,
        area_means=lineage is not None and lineage.area_means,
        levels=tuple(levels),
        gain_before=gain_before,
    )
