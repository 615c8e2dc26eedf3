"""Blocks of rows of the planar factors: by low rank, kept whole, tabulated or evaluated anew."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.transfer.factors import Planar
from core.transfer.grid import Grid
from core.transfer.low_rank import cross_approximation, thin_product
from core.transfer.product import Product
from core.transfer.quadrant import MARGIN, Quarter
from core.transfer.radial_table import Function, RadialTable

Array = NDArray[Any]
Axes = Literal["mirrored", "periodic"]

SINGLE_TOLERANCE = 1e-7  # below the rounding of single-precision samples
BLOCK_SAMPLES = 1 << 16  # samples of a plane per block of rows
SMALLEST = 128  # smaller planes are evaluated sooner than approximated or kept
THIN_SAMPLES = 1 << 19  # smaller planes are read from a radial table sooner than approximated


class Planes:
    """The product of a chain's planar factors, symmetric ones only, by blocks of rows."""

    def __init__(self, work: Work, product: Product, grid: Grid, axes: Axes) -> None:
        self._work = work
        self.xi, self.eta = axes_of(grid, axes)
        self._parts: list[tuple[Planar, Quarter, Precomputed]] = []
        for factor in product.planar:
            quarter = Quarter.of(self.xi, self.eta, factor.cutoff)
            known = NOTHING_PRECOMPUTED
            if _is_precomputed(grid, axes):
                known = work.value(Known(factor, grid, axes, node=factor.node))
            self._parts.append((factor, quarter, known))

    def block(self, rows: slice) -> Array | None:
        """Product at all columns of these rows; None without planar factors."""
        result: Array | None = None
        for factor, quarter, known in self._parts:
            part = self._part(factor, quarter, known, rows)
            result = part if result is None else result * part
        return result

    def _part(self, factor: Planar, quarter: Quarter, known: Precomputed, rows: slice) -> Array:
        lines, which = quarter.rows(rows)
        values = known.rows(lines)
        if values is None:
            values = _evaluated(self._work, factor, known.table, quarter, lines)
        if which is None and len(quarter.xi) == quarter.columns:
            return values
        height = len(values) if which is None else len(which)
        part = np.zeros((height, quarter.columns), values.dtype)
        part[slice(None) if which is None else which, : len(quarter.xi)] = values
        return part


@dataclass(frozen=True)
class Precomputed:
    """What is known of a factor on a quarter: two thin matrices, the plane, a table, or nothing."""

    thin: tuple[Array, Array] | None = None
    plane: Array | None = None
    table: RadialTable | None = None

    @property
    def description(self) -> str:
        """What is stored, in words."""
        if self.thin is not None:
            return "low rank kept"
        if self.plane is not None:
            return "whole plane kept"
        return "evaluated anew each time" if self.table is None else "radial table kept"

    def rows(self, lines: slice | Array) -> Array | None:
        """Values at rows; None where they are evaluated anew."""
        if self.thin is not None:
            return thin_product(self.thin[0][lines], self.thin[1])
        return None if self.plane is None else np.asarray(self.plane[lines])


NOTHING_PRECOMPUTED = Precomputed()


@dataclass(frozen=True, eq=False)
class Known(Recipe):
    """One factor on one grid.

    The plane is kept where it takes at most a quarter of the store. Tables and low rank are for
    single precision: kinks that lie between its probes can cost 1e-7.
    """

    factor: Planar
    grid: Grid
    axes: Axes
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.factor.key, self.grid, self.axes

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """What the factor's law is made of."""
        return self.factor.law.inputs

    def compute(self, work: Work) -> Precomputed:
        """Compute in double, keep in the evaluation's precision."""
        factor = self.factor
        quarter = Quarter.of(*axes_of(self.grid, self.axes), factor.cutoff)
        table = None
        if work.policy.precision == "single":
            table = _radial_table(work, factor, quarter)
            thin = _thin(work, factor, table, quarter)
            if thin is not None:
                return Precomputed(thin=thin)
        dtype = work.policy.dtype
        if quarter.samples * dtype.itemsize > work.store.capacity_bytes // 4:
            return Precomputed(table=table)
        plane = np.empty((len(quarter.eta), len(quarter.xi)), dtype)
        height = max(1, BLOCK_SAMPLES // len(quarter.xi))

        def one(start: int) -> None:
            rows = slice(start, start + height)
            plane[rows] = _evaluated(work, factor, table, quarter, rows)

        work.for_each(one, range(0, len(quarter.eta), height))
        return Precomputed(plane=plane)


def known_planes(product: Product, grid: Grid, axes: Axes) -> list[Recipe]:
    """The recipes that `Planes` reads."""
    if not product.symmetric or not _is_precomputed(grid, axes):
        return []
    return [Known(factor, grid, axes, node=factor.node) for factor in product.planar]


def _is_precomputed(grid: Grid, axes: Axes) -> bool:
    """Whether planes of this size are worth keeping."""
    columns = grid.columns if axes == "mirrored" else grid.columns // 2 + 1
    return min(columns, grid.rows) >= SMALLEST


def _evaluated(
    work: Work, factor: Planar, table: RadialTable | None, quarter: Quarter, lines: slice | Array
) -> Array:
    """Rows of the factor, with the same bits whether they are then kept or not."""
    across, along = quarter.xi[np.newaxis, :], quarter.eta[lines][:, np.newaxis]
    if table is not None:
        values = table.at(_square(factor, across, along), _of_radius(work, factor))
    else:
        values = factor.transfer(work, across, along)
    return values.astype(work.policy.dtype)


def _square(factor: Planar, across: Array, along: Array) -> Array:
    """Square of a radial factor's frequency."""
    across, along = across * factor.ratios[0], along * factor.ratios[1]
    return across * across + along * along


def _radial_table(work: Work, factor: Planar, quarter: Quarter) -> RadialTable | None:
    if not factor.radial or quarter.samples == 1:
        return None
    reach = float(np.sqrt(_square(factor, quarter.xi[-1], quarter.eta[-1])))
    if factor.cutoff is not None:
        reach = min(reach, (1.0 + MARGIN) * factor.cutoff[0] * factor.ratios[0])
    function = _of_radius(work, factor)
    return RadialTable.of(function, reach=reach, error=0.5 * SINGLE_TOLERANCE)


def _of_radius(work: Work, factor: Planar) -> Function:
    ratio, zero = factor.ratios[0], np.zeros(1)
    return lambda radii: np.asarray(factor.transfer(work, radii / ratio, zero), np.float64)


def _thin(
    work: Work, factor: Planar, table: RadialTable | None, quarter: Quarter
) -> tuple[Array, Array] | None:
    """Thin matrices of a radial factor without kinks, such as the edge of a support is."""
    if table is None or table.rough or quarter.samples < THIN_SAMPLES:
        return None
    function = _of_radius(work, factor)

    def evaluate(rows: Array, columns: Array) -> Array:
        across, along = quarter.xi[columns][np.newaxis, :], quarter.eta[rows][:, np.newaxis]
        return table.at(_square(factor, across, along), function)

    thin = cross_approximation(evaluate, len(quarter.eta), len(quarter.xi), SINGLE_TOLERANCE)
    if thin is None:
        return None
    dtype = work.policy.dtype
    return thin[0].astype(dtype), thin[1].astype(dtype)


def axes_of(grid: Grid, axes: Axes) -> tuple[Array, Array]:
    """The frequencies across and along of a mirrored or a periodic spectrum."""
    if axes == "mirrored":
        return grid.xi_mirrored(), grid.eta_mirrored()
    return grid.xi_half(), grid.eta()
