"""A picture in bands of wavelength, of which only weighted sums are ever made.

A detector sums the bands of what reaches it, each by its weight, and all before it is linear: what
is wanted of a stack is L ↦ Σ w_b·L_b for a few rows of weights w. A stack that attenuates, filters
or samples another one makes its sums of that one's, with weights of its own; no cube need ever be
in memory.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from core.arrays import Array
from core.chain.step_lineage import LevelChange, Linear, picture_step
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, content_key, ends_lineage, in_blocks
from core.evaluation.work import Work
from core.records import dataclass, field, replace
from core.transfer.factors import Factor, Law, Planar

Row = tuple[float, ...]
"""A weight for every band."""
Rows = tuple[Row, ...]


@dataclass(frozen=True)
class BandStack(ABC):
    """Bands of one picture, by their weighted sums.

    Each has its middle wavelength and its width, its share of the spectrum that is summed up. With
    `density` the samples are per µm, as a spectral radiance is; else they are numbers without a
    share, as reflectances are, and all bands together are their mean.
    """

    centres_um: Row
    widths_um: Row
    density: bool = field(default=True, kw_only=True)

    @property
    def count(self) -> int:
        return len(self.centres_um)

    @property
    def band_um(self) -> tuple[float, float]:
        centres, halves = np.array(self.centres_um), np.array(self.widths_um) / 2.0
        return float((centres - halves).min()), float((centres + halves).max())

    @property
    def whole(self) -> Row:
        """Weights of all bands together: their integral, or their mean where they have no share."""
        if self.density:
            return self.widths_um
        total = sum(self.widths_um)
        return tuple(width / total for width in self.widths_um)

    @property
    def in_blocks(self) -> bool:
        """Whether its sums may lie on disk, and are made block by block there."""
        return False

    @cached_property
    def key(self) -> str:
        return content_key(
            type(self).__qualname__, self.centres_um, self.widths_um, self.density, *self._content()
        )

    @abstractmethod
    def _content(self) -> tuple[object, ...]:
        """What beside the bands makes the samples."""

    @abstractmethod
    def sums(self, weights: Rows) -> Recipe:
        """Recipe of weighted sums of the bands, (len(weights), rows, columns)."""

    @abstractmethod
    def means(self) -> Recipe:
        """Recipe of the mean of every band, (bands,), double."""

    def picture(self, weights: Row) -> Recipe:
        return Step.of(_first, self.sums((weights,)))

    def band(self, index: int) -> Recipe:
        return self.picture(tuple(float(place == index) for place in range(self.count)))

    def spectrum(
        self,
        row: int,  # noqa: ARG002  (others have one)
        column: int,  # noqa: ARG002
        *,
        rows: int = 1,  # noqa: ARG002
        columns: int = 1,  # noqa: ARG002
    ) -> Recipe | None:
        """Recipe of all bands of a sample, (bands,), double; NaN where it is missing.

        Of several `rows` and `columns` from there on it is their mean. None where every band would
        have to be filtered whole for it.
        """
        return None


@dataclass(frozen=True)
class AttenuatedBands(BandStack):
    """Every band times a gain, plus an offset (per µm where the samples are): air, or a filter."""

    before: BandStack
    gain: Row
    offset: Row
    node: str | None = field(default=None, compare=False)

    @classmethod
    def of(
        cls, before: BandStack, *, gain: Row, offset: Row | None = None, node: str | None = None
    ) -> "AttenuatedBands":
        offset = (0.0,) * before.count if offset is None else offset
        return cls(
            before.centres_um, before.widths_um, before, gain, offset, node, density=before.density
        )

    def _content(self) -> tuple[object, ...]:
        return self.before.key, self.gain, self.offset

    @property
    def in_blocks(self) -> bool:
        return self.before.in_blocks

    def sums(self, weights: Rows) -> Recipe:
        rows = tuple(self._pulled(row) for row in weights)
        offsets = tuple(self._constant(row) for row in weights)
        return Step.of(_with_constants, self.before.sums(rows), node=self.node, offsets=offsets)

    def picture(self, weights: Row) -> Recipe:
        before = self.before.picture(self._pulled(weights))
        return Step.of(_with_constant, before, node=self.node, offset=self._constant(weights))

    def means(self) -> Recipe:
        return Step.of(
            _attenuated, self.before.means(), node=self.node, gain=self.gain, offset=self.offset
        )

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe | None:
        before = self.before.spectrum(row, column, rows=rows, columns=columns)
        if before is None:
            return None
        return Step.of(_attenuated, before, node=self.node, gain=self.gain, offset=self.offset)

    def _pulled(self, row: Row) -> Row:
        return tuple(float(w * g) for w, g in zip(row, self.gain, strict=True))

    def _constant(self, row: Row) -> float:
        return float(np.dot(row, self.offset))


@dataclass(frozen=True)
class SteppedBands(BandStack):
    """Bands that all pass one linear step, such as blocks of samples averaged.

    `function` is that of a step of one picture. `gain` is what a uniform picture is multiplied by.
    `blocks` are rows and columns of those that the step takes the means of, times the gain; None
    for another step.
    """

    before: BandStack
    function: Callable[..., Any]
    parameters: tuple[tuple[str, Any], ...] = ()
    gain: float = 1.0
    node: str | None = field(default=None, compare=False)
    blocks: tuple[int, int] | None = field(default=None, compare=False)

    @classmethod
    def of(
        cls,
        before: BandStack,
        step: Step,
        *,
        gain: float = 1.0,
        blocks: tuple[int, int] | None = None,
    ) -> "SteppedBands":
        """Bands behind the step that the sum of them passes."""
        waves, made = (before.centres_um, before.widths_um), (step.function, step.parameters)
        density = before.density
        return cls(*waves, before, *made, gain, step.node, blocks, density=density)

    def _content(self) -> tuple[object, ...]:
        return self.before.key, self.function, self.parameters

    @property
    def in_blocks(self) -> bool:
        return self.before.in_blocks and self.picture(self.whole).in_blocks

    def sums(self, weights: Rows) -> Recipe:
        return stacked(tuple(self.picture(row) for row in weights))

    def picture(self, weights: Row) -> Recipe:
        before = self.before.picture(weights)
        return Step(self.function, (before,), self.parameters, self.node)

    def means(self) -> Recipe:
        return self._times_gain(self.before.means())

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe | None:
        """Mean spectrum of the blocks that the samples are made of."""
        if self.blocks is None:
            return None
        high, wide = self.blocks
        size = {"rows": rows * high, "columns": columns * wide}
        before = self.before.spectrum(row * high, column * wide, **size)
        return None if before is None else self._times_gain(before)

    def _times_gain(self, values: Recipe) -> Recipe:
        none, gain = (0.0,) * self.count, (self.gain,) * self.count
        return Step.of(_attenuated, values, gain=gain, offset=none)


def stacked(pictures: tuple[Recipe, ...]) -> Recipe:
    """Recipe of several pictures as one array, (pictures, rows, columns)."""
    return Step.of(_stacked, *pictures)


@in_blocks()
@ends_lineage
def _stacked(work: Work, *pictures: Array) -> Array:
    made: Array = work.empty((len(pictures), *pictures[0].shape), pictures[0].dtype)
    return np.stack(pictures, out=made)


@in_blocks()
@picture_step()
def _first(_: Work, sums: Array) -> Array:
    return np.asarray(sums[0])


@in_blocks()
@ends_lineage
def _with_constants(work: Work, sums: Array, *, offsets: Row) -> Array:
    constants = np.array(offsets, sums.dtype)[:, np.newaxis, np.newaxis]
    return np.asarray(np.add(sums, constants, out=work.empty(sums.shape, sums.dtype)))


@dataclass(frozen=True)
class _Raised(Linear):
    """Light of the air is added before the camera: what its picture was made of is less."""

    before: Recipe

    @property
    def level(self) -> Recipe:
        """No change in contrast, and a mean of which the light of the air is no signal."""
        return Step.of(_unraised, self.before)

    @property
    def before_camera(self) -> bool:
        return True


@in_blocks()
@ends_lineage
def _unraised(_: Work, picture: Array) -> LevelChange:
    mean = float(np.mean(picture, dtype=np.float64))
    return LevelChange(1.0, mean, mean)


@in_blocks()
@picture_step(linear=lambda before, offset: _Raised(before) if offset else Linear())
def _with_constant(work: Work, picture: Array, *, offset: float) -> Array:
    """A picture and the light that is everywhere alike."""
    if not offset:
        return picture
    made = work.empty(picture.shape, picture.dtype)
    return np.asarray(np.add(picture, picture.dtype.type(offset), out=made))


@ends_lineage
def _attenuated(_: Work, means: Array, *, gain: Row, offset: Row) -> Array:
    return np.asarray(means * np.array(gain) + np.array(offset))


# The transfer function of a whole band: the mean of those of its wavelengths, by their light.


def band_mean_otf(*, laws: tuple[Law, ...], shares: Array, **frequencies: Array) -> Array:
    """Σ_b s_b·H(f, λ_b): a law for each wavelength, and its share of the light; their sum is 1."""
    total: Array | None = None
    for law, share in zip(laws, shares, strict=True):
        part = share * law(None, **frequencies)
        total = part if total is None else total + part
    return np.asarray(total)


def over_bands(
    factor: Planar, bands: BandStack, weights: Row, *, node: str | None = None
) -> Planar:
    """A factor as the mean over a picture's bands, by the light that the weights count.

    A factor that does not depend on wavelength is left as it is; so is one whose laws hold recipes.
    """
    if factor.by_wavelength is None:
        return factor
    laws = tuple(factor.by_wavelength.at(wavelength) for wavelength in bands.centres_um)
    if any(law.inputs for law in laws):
        return factor
    shares = Step.of(_shares, bands.means(), node=node, weights=weights)
    return replace(factor, law=Law.of(band_mean_otf, laws=laws, shares=shares))


def weighted_factors(
    factors: Sequence[Factor], bands: BandStack, weights: Row
) -> tuple[Factor, ...]:
    """Every factor as the mean over a picture's bands."""
    return tuple(
        over_bands(factor, bands, weights, node=factor.node)
        if isinstance(factor, Planar)
        else factor
        for factor in factors
    )


@ends_lineage
def _shares(_: Work, means: Array, *, weights: Row) -> Array:
    light = np.maximum(means * np.array(weights), 0.0)
    total = float(light.sum())
    if not total > 0.0:
        raise DataError(
            "the picture has no light in any band, so there is nothing to weight the bands by"
        )
    return np.asarray(light / total)
