"""The bands of a cube in memory: sums are made of it as of a file's."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.lineage.step_lineage import source_step
from core.physics.radiometry.radiance_units import RadianceUnit
from core.spectrum.band_stack import BandStack, Row, Rows
from nodes.files.headers.envi_cube import CubeInMemory, band_totals, mean_spectrum, weighted_sums
from nodes.input_output.file_bands import chosen_bands
from nodes.input_output.held_samples import HeldSamples

Array = NDArray[Any]


@dataclass(frozen=True)
class HeldBands(BandStack):
    """Bands of a cube in memory.

    Parameters
    ----------
    held : HeldSamples
        The cube.
    places : tuple of int
        Index in it of every band.
    factors : tuple of float
        What its samples are multiplied by.
    node : str, optional
        Node an error belongs to.
    """

    held: HeldSamples
    places: tuple[int, ...]
    factors: Row
    node: str | None = field(default=None, compare=False)

    @classmethod
    def of(
        cls,
        held: HeldSamples,
        *,
        unit: RadianceUnit | None,
        scale: float,
        interval_um: tuple[float, float] | None,
        node: str,
    ) -> HeldBands:
        """The bands within an interval; parameters and errors as `chosen_bands`."""
        chosen = chosen_bands(held.info, unit=unit, scale=scale, interval_um=interval_um)
        return cls(
            chosen.centres_um,
            chosen.widths_um,
            held,
            chosen.places,
            chosen.factors,
            node,
            density=unit is not None,
        )

    def _content(self) -> tuple[object, ...]:
        return self.held.key, self.places, self.factors

    def _row(self, row: Row) -> Row:
        """Weights of the cube's bands."""
        weights = np.zeros(len(self.held.samples))
        weights[list(self.places)] = np.array(row) * np.array(self.factors)
        return tuple(map(float, weights))

    def sums(self, weights: Rows) -> Recipe:
        """Weighted sums of the bands."""
        rows = tuple(self._row(row) for row in weights)
        return Step.of(_sums, node=self.node, held=self.held, weights=rows)

    def picture(self, weights: Row) -> Recipe:
        """One sum."""
        return Step.of(_sum, node=self.node, held=self.held, weights=self._row(weights))

    def means(self) -> Recipe:
        """Means of the bands."""
        return Step.of(
            _means, node=self.node, held=self.held, places=self.places, factors=self.factors
        )

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe:
        """Bands of a sample, or their mean over some."""
        where = {"rows": (row, row + rows), "columns": (column, column + columns)}
        return Step.of(
            _spectrum,
            node=self.node,
            held=self.held,
            places=self.places,
            factors=self.factors,
            **where,
        )


def _made(work: Work, held: HeldSamples, rows: Rows) -> Array:
    cube = CubeInMemory(held.samples)
    dtype = work.policy.dtype
    return weighted_sums(cube, np.array(rows), dtype=dtype, for_each=work.for_each)


@ends_lineage
def _sums(work: Work, *, held: HeldSamples, weights: Rows) -> Array:
    return _made(work, held, weights)


@source_step(area_means=False)  # as a scene in a file, it may be blurred by anything
def _sum(work: Work, *, held: HeldSamples, weights: Row) -> Array:
    """One weighted sum of the bands."""
    return np.asarray(_made(work, held, (weights,))[0])


@ends_lineage
def _means(work: Work, *, held: HeldSamples, places: tuple[int, ...], factors: Row) -> Array:
    totals, counts = band_totals(CubeInMemory(held.samples), for_each=work.for_each)
    return np.asarray((totals / counts)[list(places)] * np.array(factors))


@ends_lineage
def _spectrum(
    _: Work,
    *,
    held: HeldSamples,
    places: tuple[int, ...],
    factors: Row,
    rows: tuple[int, int],
    columns: tuple[int, int],
) -> Array:
    stored = mean_spectrum(CubeInMemory(held.samples), slice(*rows), slice(*columns))
    return np.asarray(stored[list(places)] * np.array(factors))
