"""The spectrum of a sum of bands, each filtered at its own wavelength.

Σ_b w_b·H(f, λ_b)·F(L_b) is the sum of a few products H(f, λ_j)·F(Σ_b p_jb·w_b·L_b): the bands are
read once, and as many transforms made as there are wavelengths chosen.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.band_stack import BandStack, Row, Rows
from core.chain.wavelength_rank import ChosenWavelengths, WavelengthRank
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.scratch import StripArray
from core.transfer.factors import Factor, Grid, Planar
from core.transfer.mirrored import BLOCK_SAMPLES, MeanFree, mirrored_spectrum
from core.transfer.periodic import periodic_spectrum
from core.transfer.planar_blocks import Axes, Planes
from core.transfer.product import Product

Array = NDArray[Any]
SAMPLES_AT_ONCE = 1 << 26
"""Of the sums that are made in one pass over the bands: 256 MB in single precision."""


def used_bands(weights: Row) -> tuple[int, ...]:
    """Indices of the bands that count; all where none does."""
    used = tuple(place for place, weight in enumerate(weights) if weight)
    return used or tuple(range(len(weights)))


@dataclass(frozen=True, eq=False)
class ComponentSums(Recipe):
    """The weighted sums of bands that belong to the chosen wavelengths, (chosen, rows, columns)."""

    bands: BandStack
    weights: Row
    wavelengths: ChosenWavelengths
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.bands.key, self.weights, self.wavelengths.key

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """The choice; which sums are made depends on it."""
        return (self.wavelengths,)

    @property
    def in_blocks(self) -> bool:
        return self.bands.in_blocks

    @property
    def in_words(self) -> str:
        """What takes pictures as a whole."""
        return "a weighted sum of bands"

    def compute(self, work: Work) -> Array:
        """One pass over the bands."""
        return np.asarray(work.value(self.bands.sums(self._rows(work))))

    def pictures(self, work: Work, *, samples: int) -> Iterator[Array]:
        """The sums one after the other, of pictures of so many samples.

        Where wavelengths are many there are several passes over the bands: otherwise all of a cube
        would be in memory where none of its bands stands for others.
        """
        rows = self._rows(work)
        at_once = max(1, SAMPLES_AT_ONCE // samples)
        if len(rows) <= at_once:
            yield from work.value(self)
            return
        parts = (rows[start : start + at_once] for start in range(0, len(rows), at_once))
        for several in work.one_by_one(map(self.bands.sums, parts), forgetting=True):
            yield from several

    def _rows(self, work: Work) -> Rows:
        rank: WavelengthRank = work.value(self.wavelengths)
        weights = np.array(self.weights)
        rows = np.zeros((len(rank.chosen), len(weights)))
        used = np.array(used_bands(self.weights))
        rows[:, used] = rank.shares * weights[used]
        return tuple(tuple(row) for row in rows.tolist())


@dataclass(frozen=True, eq=False)
class SummedSpectrum(Recipe):
    """The spectrum of a weighted sum of bands behind factors that depend on wavelength.

    The factors are real and even in both axes, so that the product is the spectrum of a frame that
    goes on as the bands' did.
    """

    sums: ComponentSums
    grid: Grid
    axes: Axes
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.sums.key, self.grid, self.axes

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """The choice of wavelengths, and the sums."""
        return self.sums.wavelengths, self.sums

    def first(self, work: Work) -> tuple[Recipe, ...]:  # noqa: ARG002  (as every recipe's)
        """The choice alone: how many sums there are decides how they are made."""
        return (self.sums.wavelengths,)

    @property
    def in_blocks(self) -> bool:
        return self.sums.in_blocks

    @property
    def in_words(self) -> str:
        """What takes pictures as a whole."""
        return "filtering every band at its own wavelength"

    def compute(self, work: Work) -> MeanFree:
        """Transform, multiply and add, one wavelength after the other."""
        rank: WavelengthRank = work.value(self.sums.wavelengths)
        pictures = self.sums.pictures(work, samples=self.grid.rows * self.grid.columns)
        factors, centres = self.sums.wavelengths.factors, self.sums.wavelengths.centres_um
        transform = mirrored_spectrum if self.axes == "mirrored" else periodic_spectrum
        total: Any = None  # an array, or strips on disk
        mean = 0.0
        for place, picture in zip(rank.chosen, pictures, strict=True):
            work.check()
            product = Product(tuple(factor.at(centres[place]) for factor in factors))
            part = transform(work, picture)
            mean += part.mean * product.at_zero(work)
            total = self._added(work, total, part.values, product)
        assert total is not None
        return MeanFree(total, mean)

    def _added(
        self,
        work: Work,
        total: Array | StripArray | None,
        values: Array | StripArray,
        product: Product,
    ) -> Array | StripArray:
        if not product.planar and total is None:
            return values
        planes = Planes(work, product, self.grid, self.axes) if product.planar else None
        height = max(1, BLOCK_SAMPLES // values.shape[1])
        made = values if total is None else total

        def one(start: int) -> None:
            rows = slice(start, start + height)
            part = values[rows]  # a copy where strips lie on disk
            if planes is not None:
                part *= planes.block(rows)
            if total is not None:
                made[rows] += part
            elif isinstance(made, StripArray):
                made[rows] = part

        work.for_each(one, range(0, len(values), height))
        return made


@dataclass(frozen=True)
class FilteredSum:
    """A weighted sum of bands, each filtered at its own wavelength.

    `factors` are those that depend on wavelength; without any it is the sum as it is.
    """

    bands: BandStack
    weights: Row
    factors: tuple[Planar, ...]
    grid: Grid
    axes: Axes
    node: str | None = None

    @cached_property
    def wavelengths(self) -> ChosenWavelengths:
        """Recipe of those that stand for all bands that count."""
        centres = tuple(self.bands.centres_um[place] for place in used_bands(self.weights))
        return ChosenWavelengths(self.factors, centres, self.grid, self.node)

    @property
    def sums(self) -> ComponentSums:
        """Recipe of the sums of bands that belong to those wavelengths."""
        return ComponentSums(self.bands, self.weights, self.wavelengths, self.node)

    @property
    def _is_even(self) -> bool:
        return all(factor.symmetric and factor.take == "real" for factor in self.factors)

    @cached_property
    def recipes(self) -> tuple[Recipe, ...]:
        """What `spectra` reads."""
        transform = mirrored_spectrum if self.axes == "mirrored" else periodic_spectrum
        if not self.factors:
            return (Step.of(transform, self.bands.picture(self.weights), node=self.node),)
        if self._is_even:
            return (SummedSpectrum(self.sums, self.grid, self.axes, self.node),)
        return (self.wavelengths,)

    def spectra(self, work: Work) -> Iterator[tuple[MeanFree, tuple[Factor, ...]]]:
        """Spectra, and the factors that have still to be applied to each before they are added.

        One where all factors are even: a frame that goes on mirrored then still does. Otherwise one
        for every wavelength that was chosen.
        """
        if not self.factors or self._is_even:
            yield work.value(self.recipes[0]), ()
            return
        rank: WavelengthRank = work.value(self.wavelengths)
        transform = mirrored_spectrum if self.axes == "mirrored" else periodic_spectrum
        pictures = self.sums.pictures(work, samples=self.grid.rows * self.grid.columns)
        for place, picture in zip(rank.chosen, pictures, strict=True):
            work.check()
            wavelength = self.wavelengths.centres_um[place]
            yield transform(work, picture), tuple(one.at(wavelength) for one in self.factors)
