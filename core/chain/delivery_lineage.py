"""What becomes of a picture in a filtered image: its factors, and its pixels' means, in one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, Protocol

from core.chain.wires import Magnitude, Phase
from core.evaluation.work import Work
from core.lineage.linear_change import Axis, Blocks, Filtering, Linear, Vector
from core.lineage.pixel_samples import PixelSamples
from core.noise.noise_power import NoisePower
from core.spectrum.band_mean import weighted_factors
from core.spectrum.band_stack import BandStack, Row
from core.transfer.factors import Factor
from core.transfer.grid import Edges, Grid


class Filtered(Protocol):
    """A `core.chain.back_transformed.Delivered`, whose file imports this one."""

    @property
    def magnitude(self) -> Magnitude: ...  # noqa: D102
    @property
    def phase(self) -> Phase: ...  # noqa: D102
    @property
    def factor_x(self) -> int: ...  # noqa: D102
    @property
    def factor_y(self) -> int: ...  # noqa: D102
    @property
    def mode(self) -> Literal["mean", "sum"]: ...  # noqa: D102
    @property
    def sampled(self) -> PixelSamples | None: ...  # noqa: D102
    @property
    def weights(self) -> Row | None: ...  # noqa: D102
    @property
    def bands(self) -> BandStack: ...  # noqa: D102
    @property
    def mirrored(self) -> bool: ...  # noqa: D102
    @property
    def plain(self) -> bool: ...  # noqa: D102


@dataclass(frozen=True)
class Delivery(Linear):
    """What a delivered image's factors and pixel means do, in one."""

    recipe: Filtered

    @property
    def _filtering(self) -> Filtering:
        magnitude, phase = self.recipe.magnitude, self.recipe.phase
        edges: Edges = "reflect" if self.recipe.mirrored else "periodic"
        factors: tuple[Factor, ...] = (*magnitude.factors, *phase.factors)
        if self.recipe.weights is not None:
            factors = weighted_factors(factors, self.recipe.bands, self.recipe.weights)
        return Filtering(factors, magnitude.grid, edges)

    @property
    def _pixels(self) -> Blocks | PixelSamples:
        recipe = self.recipe
        if recipe.sampled is not None:
            return recipe.sampled
        return Blocks(recipe.factor_x, recipe.factor_y, recipe.mode, recipe.magnitude.grid.shape)

    @property
    def gain(self) -> float:
        """Factor by which a sum of pixels scales a uniform picture."""
        return self._pixels.gain

    @property
    def combines_pixels(self) -> bool:
        """Whether a factor is above 1, or pixels are sampled."""
        return not self.recipe.plain

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:  # noqa: ARG002
        """Rows and columns of the spectrum."""
        return self.recipe.magnitude.grid.shape

    def grid_before(self, grid: Grid) -> Grid:
        """That of the spectrum, in the unit of the image's."""
        before = self.recipe.magnitude.grid
        ratios = self._ratios(grid)
        if ratios is None:
            return before
        x, y = before.interval_x_mrad * ratios[0], before.interval_y_mrad * ratios[1]
        return replace(before, interval_x_mrad=x, interval_y_mrad=y)

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        """All factors, those of the phase last, and the pixel means."""
        factors = self._filtering.factors
        ratios = self._ratios(after)
        if ratios is not None:
            factors = tuple(factor.rescaled(*ratios) for factor in factors)
        return (*factors, *self._pixels.transfer(before, after, node))

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        """Filtered, and combined."""
        return self._pixels.noise(work, self._filtering.noise(work, power))

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        """Filtered, and combined."""
        return self._pixels.row(work, self._filtering.row(work, row, axis), axis)

    def _ratios(self, grid: Grid) -> tuple[float, float] | None:
        """Intervals of the image over the spectrum's; None where these are in the same unit.

        A spectrum's frequencies may be in units of its own, such as cycles a sample.
        """
        recipe, before = self.recipe, self.recipe.magnitude.grid
        samples: tuple[float, float] = (recipe.factor_x, recipe.factor_y)
        if recipe.sampled is not None:
            samples = recipe.sampled.ratio_x, recipe.sampled.ratio_y
        x = grid.interval_x_mrad / (before.interval_x_mrad * samples[0])
        y = grid.interval_y_mrad / (before.interval_y_mrad * samples[1])
        return (x, y) if max(abs(x - 1.0), abs(y - 1.0)) > 1e-9 else None
