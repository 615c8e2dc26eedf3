"""What the thesis' row average of an upright edge should show, computed in one dimension.

The edge lies at one place among the samples. What they cannot show of it beyond their Nyquist
frequency is folded back, and an interpolated picture differs from place to place: no product of
MTFs tells what is measured. But all rows are alike, so that one of them is soon followed through
every step, and measured in the same way.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.chain.back_transformed import Delivered, block_combine
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.transfer.factors import Factor
from core.transfer.grid import Edges, Grid
from nodes.analysis.lineage.line_transfer import factor_at
from nodes.analysis.space.spatial_blur import blurred
from nodes.electronics.noise_steps import filtered_lines
from nodes.transform.interpolate import resampled, taps

Vector = NDArray[np.float64]
Axis = Literal["x", "y"]


def edge_row(work: Work, recipe: Recipe, source: Recipe, axis: Axis, samples: int) -> Vector:
    """A row, or column, of a picture whose source is an edge through the middle of `samples`.

    Raises
    ------
    DataError
        Where a step of the picture is not known as a transfer function.
    """
    if recipe.key == source.key:
        return np.asarray(np.clip(np.arange(samples) + 1.0 - samples / 2, 0.0, 1.0), np.float64)
    if isinstance(recipe, Delivered) and recipe.magnitude.image is not None:
        before = edge_row(work, recipe.magnitude.image.recipe, source, axis, samples)
        factors = (*recipe.magnitude.factors, *recipe.phase.factors)
        made = _filtered(work, before, factors, recipe.magnitude.grid, axis, recipe.mirrored)
        return _combined(made, recipe.factor_x if axis == "x" else recipe.factor_y)
    if not isinstance(recipe, Step) or not recipe.inputs:
        raise DataError(f"what {recipe.node} does to the picture is not known")
    given, row = dict(recipe.parameters), edge_row(work, recipe.inputs[0], source, axis, samples)
    mirrored = given.get("edges") == "reflect"
    if recipe.function is filtered_lines:
        return _filtered(work, row, given["factors"], given["grid"], axis, mirrored)
    if recipe.function is blurred:
        how: dict[str, Any] = dict(recipe.inputs[1].parameters)  # type: ignore[attr-defined]
        return _filtered(work, row, how["factors"], how["grid"], axis, mirrored)
    if recipe.function is block_combine:
        return _combined(row, given["factor_x" if axis == "x" else "factor_y"])
    if recipe.function is resampled:
        new = given["new"][1 if axis == "x" else 0]
        return row if new == len(row) else _resampled(row, new, given["order"], given["edges"])
    raise DataError(f"what {recipe.node} does to the picture is not known")


def _filtered(
    work: Work, row: Vector, factors: Iterable[Factor], grid: Grid, axis: Axis, mirrored: bool
) -> Vector:
    """The row filtered; mirrored at its ends, or repeated."""
    whole = np.concatenate([row, row[::-1]]) if mirrored else row
    interval = grid.interval_x_mrad if axis == "x" else grid.interval_y_mrad
    frequency = np.asarray(scipy.fft.rfftfreq(len(whole), interval), np.float64)
    none = np.zeros_like(frequency)
    spectrum = scipy.fft.rfft(whole)
    for factor in factors:
        values = factor_at(work, factor, *((frequency, none) if axis == "x" else (none, frequency)))
        spectrum = spectrum * (values if factor.part == "mtf" else np.exp(1j * values))
    return np.asarray(scipy.fft.irfft(spectrum, len(whole))[: len(row)], np.float64)


def _combined(row: Vector, factor: int) -> Vector:
    whole = len(row) // factor
    return np.asarray(row[: whole * factor].reshape(whole, factor).mean(axis=1), np.float64)


def _resampled(row: Vector, new: int, order: int, edges: Edges | None) -> Vector:
    base, further = taps(len(row), new, order, edges)
    made = row[base]
    for index, weight in further:
        made = made + weight * (row[index] - row[base])
    return np.asarray(made, np.float64)
