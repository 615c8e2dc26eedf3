"""Blocks of rows of the planar factors: by low rank, kept whole, or evaluated anew."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.cross import cross_approximation
from core.factors import Planar
from core.grid import Grid
from core.product import Product
from core.recipes import Recipe
from core.work import Work

Array = NDArray[Any]
Axes = Literal["mirrored", "periodic"]

SINGLE_TOLERANCE = 1e-7  # below the rounding of single-precision samples
BLOCK_SAMPLES = 1 << 16  # samples of a plane per block of rows
RADII = 1 << 12  # intervals of the table that stands for a radial factor
SMALLEST = 128  # smaller planes are evaluated sooner than approximated


class Planes:
    """The product of a chain's planar factors, symmetric ones only, by blocks of rows."""

    def __init__(self, work: Work, product: Product, grid: Grid, axes: Axes) -> None:
        self._work = work
        self._parts: list[tuple[Planar, tuple[Array, ...]]] = []
        self.xi, self.eta = axes_of(grid, axes)
        for factor in product.planar:
            self._parts.append((factor, self._known(factor, grid, axes)))

    def block(self, rows: slice) -> Array | None:
        """Product at all columns of these rows; None without planar factors."""
        result: Array | None = None
        for factor, known in self._parts:
            if len(known) == 2:
                part = known[0][rows] @ known[1]
            elif known:
                part = known[0][rows]
            else:
                eta = self.eta[rows]
                value = factor.transfer(self._work, self.xi[np.newaxis, :], eta[:, np.newaxis])
                part = value.astype(self._work.policy.dtype)  # the same bits as one kept
            result = part if result is None else result * part
        return result

    def _known(self, factor: Planar, grid: Grid, axes: Axes) -> tuple[Array, ...]:
        """What is kept of a pupil; other factors are quick to evaluate, and small planes too."""
        if not factor.smooth or min(len(self.xi), len(self.eta)) < SMALLEST:
            return ()
        found: tuple[Array, ...] = self._work.value(Known(factor, grid, axes, node=factor.node))
        return found


@dataclass(frozen=True, eq=False)
class Known(Recipe):
    """One factor on one grid: two thin matrices, else the plane, else nothing.

    The plane is kept where it takes at most a quarter of the store. Low rank is for single
    precision: kinks that lie between its probes can cost 1e-7.
    """

    factor: Planar
    grid: Grid
    axes: Axes
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.factor.key, self.grid, self.axes

    def compute(self, work: Work) -> tuple[Array, ...]:
        """Compute in double, keep in the evaluation's precision."""
        thin = self._thin(work) if work.policy.precision == "single" else ()
        return thin or self._whole(work)

    def _whole(self, work: Work) -> tuple[Array, ...]:
        xi, eta = axes_of(self.grid, self.axes)
        dtype = work.policy.dtype
        if len(xi) * len(eta) * dtype.itemsize > work.store.capacity_bytes // 4:
            return ()
        plane = np.empty((len(eta), len(xi)), dtype)
        height = max(1, BLOCK_SAMPLES // len(xi))

        def one(start: int) -> None:
            rows = slice(start, start + height)
            plane[rows] = self.factor.transfer(work, xi[np.newaxis, :], eta[rows, np.newaxis])

        work.each(one, range(0, len(eta), height))
        return (plane,)

    def _thin(self, work: Work) -> tuple[Array, ...]:
        xi, eta = axes_of(self.grid, self.axes)
        table = self._radial_table(work, xi, eta) if self.factor.radial else None

        def evaluate(rows: Array, columns: Array) -> Array:
            work.check()
            across, along = xi[columns][np.newaxis, :], eta[rows][:, np.newaxis]
            if table is not None:
                return np.asarray(np.interp(np.hypot(across, along), *table))
            return np.asarray(self.factor.transfer(work, across, along), np.float64)

        thin = cross_approximation(evaluate, len(eta), len(xi), SINGLE_TOLERANCE)
        if thin is None:
            return ()
        return tuple(part.astype(work.policy.dtype) for part in thin)

    def _radial_table(self, work: Work, xi: Array, eta: Array) -> tuple[Array, Array] | None:
        """Radii and values that linear interpolation serves, or None where it would not."""
        corner = float(np.hypot(np.abs(xi).max(), np.abs(eta).max()))
        radii = np.linspace(0.0, corner, 2 * RADII + 1)
        values = np.asarray(self.factor.transfer(work, radii, np.zeros(1)), np.float64)
        between = 0.5 * (values[:-1:2] + values[2::2])
        # Half the interval has a quarter of the error that is seen here.
        fits = np.abs(between - values[1::2]).max() <= 0.5 * SINGLE_TOLERANCE
        return (radii, values) if fits else None


def axes_of(grid: Grid, axes: Axes) -> tuple[Array, Array]:
    """The frequencies across and along of a mirrored or a periodic spectrum."""
    if axes == "mirrored":
        return grid.xi_mirrored(), grid.eta_mirrored()
    return grid.xi_half(), grid.eta()
