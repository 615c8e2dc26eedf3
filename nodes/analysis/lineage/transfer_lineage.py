"""The transfer functions on the way to a picture, from its source on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from core.chain.back_transformed import Delivered, block_combine
from core.chain.wires import Image
from core.evaluation.recipes import Recipe, Step
from core.physics.sampling.interpolation import (
    block_mean_mtf,
    interpolation_mtf,
    interpolation_ptf,
    takes_the_later,
)
from core.transfer.factors import Factor, Separable
from core.transfer.grid import Grid
from nodes.analysis.lineage.line_transfer import Stage, stages_of
from nodes.analysis.space.spatial_blur import blurred
from nodes.electronics.noise_steps import (
    filtered_lines,
    quantized,
    read_out,
    with_amplifier_noise,
    with_detector_noise,
)
from nodes.electronics.periodic_noise import summed
from nodes.optics.poisson_noise import added, photon_counts
from nodes.shared.factor_helpers import separable
from nodes.transform.interpolate import resampled

# Their first input is the picture, which they pass on with noise.
PASSING: tuple[Any, ...] = (
    added,
    photon_counts,
    summed,
    with_detector_noise,
    read_out,
    with_amplifier_noise,
    quantized,
)


Behind = tuple[Recipe, Grid, tuple[Factor, ...]]


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
    """

    stages: tuple[Stage, ...]
    grid: Grid
    source_grid: Grid
    source: Recipe
    gain: float | None = 1.0

    @property
    def factors(self) -> tuple[Factor, ...]:
        """All factors, MTF and PTF, of all stages."""
        return tuple(factor for stage in self.stages for factor in stage.factors)

    def part(self, part: str) -> tuple[Stage, ...]:
        """The stages with the factors of their MTF, or of their PTF, alone."""
        kept = (Stage(s.label, tuple(f for f in s.factors if f.part == part)) for s in self.stages)
        return tuple(stage for stage in kept if stage.factors)


def transfer_of(image: Image) -> ImageTransfer:
    """Every transfer function between the scene and the picture.

    Interpolation counts with the mean over its samples; what folds back from beyond the Nyquist
    frequency is no part of it.

    Raises
    ------
    DataError
        If the picture does not say its sampling interval.
    """
    grid = image.grid()
    factors: list[Factor] = []
    recipe, here, gain = image.recipe, grid, 1.0
    known = True
    while True:
        found = _before(recipe, here)
        if found is None:
            stages = stages_of(tuple(factors))
            return ImageTransfer(stages, grid, here, recipe, gain if known else None)
        gain *= _summed_pixels(recipe)
        known = known and not _is_literal(recipe)
        recipe, here, stage = found
        factors = [*stage, *factors]


def _before(recipe: Recipe, grid: Grid) -> Behind | None:
    """What a picture was made of, its sampling, and the transfer function in between."""
    if isinstance(recipe, Delivered):
        return _before_transform(recipe, grid)
    if not isinstance(recipe, Step) or not recipe.inputs:
        return None
    if recipe.function in PASSING:
        return recipe.inputs[0], grid, ()
    known = _KNOWN.get(recipe.function)
    return known(recipe, dict(recipe.parameters), grid) if known else None


def _summed_pixels(recipe: Recipe) -> int:
    """Pixels whose sum is taken, 1 of a mean."""
    if isinstance(recipe, Delivered):
        return recipe.factor_x * recipe.factor_y if recipe.mode == "sum" else 1
    values = dict(recipe.parameters) if isinstance(recipe, Step) else {}
    if isinstance(recipe, Step) and recipe.function is block_combine and values["mode"] == "sum":
        return int(values["factor_x"] * values["factor_y"])
    return 1


def _is_literal(recipe: Recipe) -> bool:
    if not isinstance(recipe, Step) or recipe.function is not read_out:
        return False
    return bool(dict(recipe.parameters)["model"] == "literal")


def _before_transform(recipe: Delivered, grid: Grid) -> Behind | None:
    source = recipe.magnitude.image
    if source is None or not recipe.one_source:
        return None
    before = recipe.magnitude.grid
    factors = (*recipe.magnitude.factors, *recipe.phase.factors)
    ratio_x = grid.interval_x_mrad / (before.interval_x_mrad * recipe.factor_x)
    ratio_y = grid.interval_y_mrad / (before.interval_y_mrad * recipe.factor_y)
    if max(abs(ratio_x - 1.0), abs(ratio_y - 1.0)) > 1e-9:
        # Its frequencies are in units of its own, such as cycles a sample.
        factors = tuple(factor.rescaled(ratio_x, ratio_y) for factor in factors)
        x, y = before.interval_x_mrad * ratio_x, before.interval_y_mrad * ratio_y
        before = replace(before, interval_x_mrad=x, interval_y_mrad=y)
    blocks = _combined(before, recipe.factor_x, recipe.factor_y, recipe.node)
    return source.recipe, before, (*factors, *blocks)


def _before_lines(recipe: Step, values: dict[str, Any], grid: Grid) -> Behind:
    named = (replace(f, label="Electronics", node=recipe.node) for f in values["factors"])
    return recipe.inputs[0], grid, tuple(named)


def _before_convolution(recipe: Step, values: dict[str, Any], grid: Grid) -> Behind:
    kernels = recipe.inputs[1]
    assert isinstance(kernels, Step)
    return recipe.inputs[0], grid, tuple(dict(kernels.parameters)["factors"])


def _before_blocks(recipe: Step, values: dict[str, Any], grid: Grid) -> Behind:
    x, y = values["factor_x"], values["factor_y"]
    before = Grid(
        grid.rows * y, grid.columns * x, grid.interval_x_mrad / x, grid.interval_y_mrad / y
    )
    return recipe.inputs[0], before, _combined(before, x, y, recipe.node)


def _before_interpolation(recipe: Step, values: dict[str, Any], grid: Grid) -> Behind:
    rows, columns = values["old"]
    before = Grid(
        rows,
        columns,
        grid.interval_x_mrad * grid.columns / columns,
        grid.interval_y_mrad * grid.rows / rows,
    )
    return recipe.inputs[0], before, _interpolated(before, grid, values["order"], recipe.node)


_KNOWN: dict[Any, Callable[[Step, dict[str, Any], Grid], Behind]] = {
    filtered_lines: _before_lines,
    blurred: _before_convolution,
    block_combine: _before_blocks,
    resampled: _before_interpolation,
}


def _combined(grid: Grid, factor_x: int, factor_y: int, node: str | None) -> tuple[Separable, ...]:
    if (factor_x, factor_y) == (1, 1):
        return ()
    return separable(
        block_mean_mtf,
        x={"interval_mrad": grid.interval_x_mrad, "samples": factor_x} if factor_x > 1 else None,
        y={"interval_mrad": grid.interval_y_mrad, "samples": factor_y} if factor_y > 1 else None,
        label="Combined pixels",
        node=node,
    )


def _interpolated(before: Grid, after: Grid, order: int, node: str | None) -> tuple[Separable, ...]:
    axes: list[dict[str, Any] | None] = [
        {"interval_mrad": interval, "order": order, "old": old, "new": new} if old != new else None
        for interval, old, new in (
            (before.interval_x_mrad, before.columns, after.columns),
            (before.interval_y_mrad, before.rows, after.rows),
        )
    ]
    moved = [
        axis if axis and takes_the_later(order=order, old=axis["old"], new=axis["new"]) else None
        for axis in axes
    ]
    named: dict[str, Any] = {"label": "Interpolation", "node": node}
    return (
        *separable(interpolation_mtf, x=axes[0], y=axes[1], **named),
        *separable(interpolation_ptf, x=moved[0], y=moved[1], part="ptf", **named),
    )
