"""A picture in bands of wavelength, of which only weighted sums are ever made.

A detector sums the bands of what reaches it, each by its weight, and all before it is linear: what
is wanted of a stack is L ↦ Σ w_b·L_b for a few rows of weights w. A stack that attenuates, filters
or samples another one makes its sums of that one's, with weights of its own; no cube need ever be
in memory.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np

from core.arrays import Array
from core.chain.step_lineage import LevelChange, Linear, picture_step
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, content_key, ends_lineage, in_blocks
from core.evaluation.work import Work
from core.machine import StripArray
from core.records import dataclass, field, replace
from core.transfer.factors import Edges, Factor, Grid, Law, Planar, Product
from core.transfer.mirrored import BLOCK_SAMPLES, MeanFree, mirrored_spectrum
from core.transfer.periodic import periodic_spectrum
from core.transfer.planar_blocks import Planes

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

    # Of the next two each is made of the other: a stack has one of its own.

    def sums(self, weights: Rows) -> Recipe:
        """Recipe of weighted sums of the bands, (len(weights), rows, columns)."""
        return Step.of(_stacked, *(self.picture(row) for row in weights))

    def picture(self, weights: Row) -> Recipe:
        return Step.of(_first, self.sums((weights,)))

    @abstractmethod
    def means(self) -> Recipe:
        """Recipe of the mean of every band, (bands,), double."""

    def band(self, index: int) -> Recipe:
        return self.picture(tuple(float(place == index) for place in range(self.count)))

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe | None:  # noqa: ARG002
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
        return self._applied(self.before.means())

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe | None:
        before = self.before.spectrum(row, column, rows=rows, columns=columns)
        return None if before is None else self._applied(before)

    def _applied(self, values: Recipe) -> Recipe:
        return Step.of(_attenuated, values, node=self.node, gain=self.gain, offset=self.offset)

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
    def of(cls, before: BandStack, step: Step, *, gain: float = 1.0, **more: Any) -> "SteppedBands":
        """Bands behind the step that the sum of them passes."""
        made = (before, step.function, step.parameters, gain, step.node)
        return cls(before.centres_um, before.widths_um, *made, density=before.density, **more)

    def _content(self) -> tuple[object, ...]:
        return self.before.key, self.function, self.parameters

    @property
    def in_blocks(self) -> bool:
        return self.before.in_blocks and self.picture(self.whole).in_blocks

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


def over_bands(factor: Planar, bands: BandStack, weights: Row) -> Planar:
    """A factor as the mean over a picture's bands, by the light that the weights count.

    A factor that does not depend on wavelength is left as it is; so is one whose laws hold recipes.
    """
    if factor.by_wavelength is None:
        return factor
    laws = tuple(factor.by_wavelength(wavelength) for wavelength in bands.centres_um)
    if any(law.inputs for law in laws):
        return factor
    shares = Step.of(_shares, bands.means(), node=factor.node, weights=weights)
    return replace(factor, law=Law.of(band_mean_otf, laws=laws, shares=shares))


def weighted_factors(
    factors: Sequence[Factor], bands: BandStack, weights: Row
) -> tuple[Factor, ...]:
    """Every factor as the mean over a picture's bands."""
    return tuple(
        over_bands(one, bands, weights) if isinstance(one, Planar) else one for one in factors
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


# The spectrum of a sum of bands, each filtered at its own wavelength.
#
# Σ_b w_b·H(f, λ_b)·F(L_b) is the sum of a few products H(f, λ_j)·F(Σ_b p_jb·w_b·L_b): the bands are
# read once, and as many transforms made as there are wavelengths chosen.
#
# Few wavelengths stand for those of all bands: H(f, λ) = Σ_j H(f, λ_j)·p_j(λ) to within an error
# that is read off the transfer function alone, whatever the scene. The λ_j are bands of the
# picture, chosen by pivoted orthogonalisation; the p_j fit all others in least squares with
# Σ_j p_j = 1, so that a uniform picture stays what it is (interpolative decomposition; Cheng,
# Gimbutas, Martinsson and Rokhlin 2005, SIAM J. Sci. Comput. 26, 1389).

RADII = 1537
"""Places along the radius on which radial functions are fitted and, between them, judged."""
ACROSS = 49
"""The same along either axis for functions that are not radial."""
_USUAL = {"single": 1e-4, "double": 1e-13}
"""Largest error where no tolerance is chosen; in pictures it is about a hundredth of that."""
_FEW = 64
"""Are looked for in any case; more only while a step costs less than the spectra that it saves."""
_SHARE = 0.5
"""Of a chosen error budget; the rest is for stages that are left out."""


@dataclass(frozen=True)
class WavelengthRank:
    """Wavelengths that stand for all: `chosen` bands, and p_j at every band, (chosen, bands).

    `bound` is the largest |H − Σ_j p_j·H_j| of any band at any frequency: by Parseval's theorem no
    band's picture changes by more than this times the rms of its contrast. 0 where nothing is
    approximated.
    """

    chosen: tuple[int, ...]
    shares: Array
    bound: float


@ends_lineage
def chosen_wavelengths(
    work: Work, *_: Any, factors: tuple[Planar, ...], centres_um: Row, grid: Grid
) -> WavelengthRank:
    """The wavelengths that factors need at a grid's frequencies within the error budget.

    They are fitted on every other place, and judged on those between.
    """
    count = len(centres_um)
    if not factors:
        return WavelengthRank((0,), np.ones((1, count)), 0.0)
    if work.policy.budget == 0.0 or count == 1:
        return WavelengthRank(tuple(range(count)), np.eye(count), 0.0)
    xi, eta = _places(factors, grid)
    # The whole square of frequencies has its corner where a radius reaches furthest.
    table = np.empty((xi.size, count), complex)
    for band, wavelength in enumerate(centres_um):
        work.check()
        table[:, band] = transfer_at(work, factors, wavelength, xi, eta)
    if not table.imag.any():
        table = np.ascontiguousarray(table.real)
    chosen = work.policy.tolerance
    tolerance = _USUAL[work.policy.precision] if chosen is None else _SHARE * chosen
    samples = grid.rows * grid.columns
    most = max(_FEW, int(samples * math.log2(samples) / len(table)))
    return few_wavelengths(table[::2], table[1::2], tolerance=tolerance, most=most)


def transfer_at(
    work: Work | None, factors: Sequence[Planar], wavelength_um: float, xi: Array, eta: Array
) -> Array:
    """Product of factors at one wavelength, at pairs of frequencies."""
    total: Array = np.ones(np.broadcast_shapes(np.shape(xi), np.shape(eta)))
    for factor in factors:
        total = total * factor.at(wavelength_um).transfer(work, xi, eta)
    return np.asarray(total)


def few_wavelengths(
    fitted: Array, judged: Array, *, tolerance: float, most: int = 1 << 30
) -> WavelengthRank:
    """As few columns of a table as span all others.

    `fitted` and `judged`, (places, bands), are transfer functions at two sets of frequencies. Where
    not even all but one column reach the tolerance, all are taken; so are they where more than
    `most` are needed.
    """
    count = fitted.shape[1]
    order: list[int] = []
    # No weights leave less of a column than its distance: the largest error is a √places-th of it
    # at least. Twice that, for rounding.
    hopeless = 2.0 * tolerance * math.sqrt(fitted.shape[0])
    for furthest, left in islice(_pivots(fitted), min(most, count - 1)):
        order.append(furthest)
        if left > hopeless:
            continue
        chosen = np.sort(order)
        shares = _fitted_shares(fitted, chosen)
        error = max(
            float(np.abs(table - table[:, chosen] @ shares).max()) for table in (fitted, judged)
        )
        if error <= tolerance:
            return WavelengthRank(tuple(map(int, chosen)), shares, error)
    return WavelengthRank(tuple(range(count)), np.eye(count), 0.0)


def _pivots(table: Array) -> Iterator[tuple[int, float]]:
    """Columns in the order in which each is furthest from all before, by Gram and Schmidt.

    With each the largest distance that is left. One at a time: of a thousand a few are wanted.
    """
    rest = table.copy()
    distances = np.linalg.norm(rest, axis=0)
    taken = np.zeros(table.shape[1], bool)
    for _ in range(len(taken)):
        furthest = int(np.argmax(np.where(taken, -1.0, distances)))
        taken[furthest] = True
        if distances[furthest] > 0.0:
            along = rest[:, furthest] / distances[furthest]
            for _ in range(2):  # once more for what rounding has left
                rest -= np.multiply.outer(along, along.conj() @ rest)
            distances = np.linalg.norm(rest, axis=0)
        yield furthest, float(distances.max(where=~taken, initial=0.0))


def _fitted_shares(table: Array, chosen: Array) -> Array:
    """Least-squares weights of the chosen columns whose sum is 1 for every column."""
    base, rest = chosen[0], chosen[1:]
    shares = np.zeros((len(chosen), table.shape[1]))
    if len(rest):
        against = table[:, rest] - table[:, [base]]
        target = table - table[:, [base]]
        if np.iscomplexobj(table):
            against = np.vstack([against.real, against.imag])
            target = np.vstack([target.real, target.imag])
        shares[1:] = np.linalg.lstsq(against, target, rcond=None)[0]
    shares[0] = 1.0 - shares[1:].sum(axis=0)
    shares[:, chosen] = np.eye(len(chosen))
    return shares


def _places(factors: Sequence[Planar], grid: Grid) -> tuple[Array, Array]:
    """Pairs of frequencies that cover the grid's."""
    if all(factor.radial and factor.ratios == factors[0].ratios for factor in factors) and (
        factors[0].ratios[0] == factors[0].ratios[1]
    ):
        radii = np.hypot(grid.nyquist_x, grid.nyquist_y) * np.linspace(0.0, 1.0, RADII)
        return radii, np.zeros(RADII)
    quarter = all(factor.symmetric for factor in factors)
    along = np.linspace(0.0 if quarter else -1.0, 1.0, ACROSS if quarter else 2 * ACROSS - 1)
    xi, eta = np.meshgrid(grid.nyquist_x * np.linspace(0.0, 1.0, ACROSS), grid.nyquist_y * along)
    return xi.ravel(), eta.ravel()


def spectral_of(factors: Sequence[Factor]) -> tuple[tuple[Planar, ...], tuple[Factor, ...]]:
    """Factors that depend on wavelength, and the others."""
    spectral = tuple(f for f in factors if isinstance(f, Planar) and f.by_wavelength is not None)
    return spectral, tuple(factor for factor in factors if factor not in spectral)


SAMPLES_AT_ONCE = 1 << 26
"""Of the sums that are made in one pass over the bands: 256 MB in single precision."""


def used_bands(weights: Row) -> tuple[int, ...]:
    """Indices of the bands that count; all where none does."""
    used = tuple(place for place, weight in enumerate(weights) if weight)
    return used or tuple(range(len(weights)))


@dataclass(frozen=True, eq=False)
class FilteredSum(Recipe):
    """A weighted sum of bands, each filtered at its own wavelength; as a recipe, its spectrum.

    `factors` are those that depend on wavelength; without any it is the sum as it is. The spectrum
    is made where they are real and even in both axes, so that it is that of a frame which goes on
    as the bands' did.
    """

    bands: BandStack
    weights: Row
    factors: tuple[Planar, ...]
    grid: Grid
    axes: Edges
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.bands.key, self.weights, self.wavelengths.key, self.grid, self.axes

    @cached_property
    def wavelengths(self) -> Step:
        """Recipe of those that stand for all bands that count."""
        centres = tuple(self.bands.centres_um[place] for place in used_bands(self.weights))
        laws = (
            factor.by_wavelength(wavelength)
            for factor in self.factors
            for wavelength in centres
            if factor.by_wavelength is not None
        )
        bound = [one for law in laws for one in law.inputs]
        how: dict[str, Any] = {"factors": self.factors, "centres_um": centres, "grid": self.grid}
        return Step.of(chosen_wavelengths, *bound, node=self.node, **how)

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """The choice; which sums are made depends on it."""
        return (self.wavelengths,)

    @property
    def in_blocks(self) -> bool:
        return self.bands.in_blocks

    @property
    def in_words(self) -> str:
        return "filtering every band at its own wavelength"

    @property
    def _is_even(self) -> bool:
        return all(factor.symmetric and factor.take == "real" for factor in self.factors)

    @property
    def _transform(self) -> Callable[..., MeanFree]:
        return mirrored_spectrum if self.axes == "reflect" else periodic_spectrum

    @cached_property
    def recipes(self) -> tuple[Recipe, ...]:
        """What `spectra` reads."""
        if not self.factors:
            picture = self.bands.picture(self.weights)
            return (Step.of(self._transform, picture, node=self.node),)
        return (self,) if self._is_even else (self.wavelengths,)

    def spectra(self, work: Work) -> Iterator[tuple[MeanFree, tuple[Factor, ...]]]:
        """Spectra, and the factors that have still to be applied to each before they are added.

        One where all factors are even: a frame that goes on mirrored then still does. Otherwise one
        for every wavelength that was chosen.
        """
        if not self.factors or self._is_even:
            yield work.value(self.recipes[0]), ()
            return
        for picture, factors in self._components(work):
            yield self._transform(work, picture), factors

    def compute(self, work: Work) -> MeanFree:
        """Transform, multiply and add, one wavelength after the other."""
        total: Any = None  # an array, or strips on disk
        mean = 0.0
        for picture, factors in self._components(work):
            product = Product(factors)
            values, mean_of_part = self._transform(work, picture)
            mean += mean_of_part * product.at_zero(work)
            total = self._added(work, total, values, product)
        assert total is not None
        return total, mean

    def _components(self, work: Work) -> Iterator[tuple[Array, tuple[Planar, ...]]]:
        """The sums of bands that belong to the chosen wavelengths, and the factors at each.

        Where wavelengths are many there are several passes over the bands: otherwise all of a cube
        would be in memory where none of its bands stands for others.
        """
        rank: WavelengthRank = work.value(self.wavelengths)
        used = np.array(used_bands(self.weights))
        weights = np.zeros((len(rank.chosen), len(self.weights)))
        weights[:, used] = rank.shares * np.array(self.weights)[used]
        rows = tuple(tuple(row) for row in weights.tolist())
        at_once = max(1, SAMPLES_AT_ONCE // (self.grid.rows * self.grid.columns))
        parts = [rows[start : start + at_once] for start in range(0, len(rows), at_once)]
        passes = work.one_by_one(map(self.bands.sums, parts), forgetting=len(parts) > 1)
        pictures = (picture for several in passes for picture in several)
        for place, picture in zip(rank.chosen, pictures, strict=True):
            work.check()
            wavelength = self.bands.centres_um[used[place]]
            yield picture, tuple(factor.at(wavelength) for factor in self.factors)

    def _added(self, work: Work, total: Any, values: Any, product: Product) -> Any:
        if not product.planar and total is None:
            return values
        planes = Planes(work, product, self.grid, self.axes) if product.planar else None
        height = max(1, BLOCK_SAMPLES // values.shape[1])
        made: Any = values if total is None else total

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
