"""The spectrum of a sum of bands, each filtered at its own wavelength.

Σ_b w_b·H(f, λ_b)·F(L_b) is the sum of a few products H(f, λ_j)·F(Σ_b p_jb·w_b·L_b): the bands are
read once, and as many transforms made as there are wavelengths chosen.

Few wavelengths stand for those of all bands: H(f, λ) = Σ_j H(f, λ_j)·p_j(λ) to within an error
that is read off the transfer function alone, whatever the scene. The λ_j are bands of the picture,
chosen by pivoted orthogonalisation; the p_j fit all others in least squares with Σ_j p_j = 1, so
that a uniform picture stays what it is (interpolative decomposition; Cheng, Gimbutas, Martinsson
and Rokhlin 2005, SIAM J. Sci. Comput. 26, 1389).
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np

from core.arrays import Array
from core.chain.band_stack import BandStack, Row
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.records import dataclass, field
from core.scratch import StripArray
from core.transfer.factors import Factor, Grid, Planar, Product
from core.transfer.mirrored import BLOCK_SAMPLES, MeanFree, mirrored_spectrum
from core.transfer.periodic import periodic_spectrum
from core.transfer.planar_blocks import Axes, Planes

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
    if not np.iscomplexobj(table) or not table.imag.any():
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
    fitted: Array, judged: Array, *, tolerance: float, most: int | None = None
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
    for furthest, left in islice(
        _pivots(fitted), count - 1 if most is None else min(most, count - 1)
    ):
        order.append(furthest)
        if left > hopeless:
            continue
        chosen = np.sort(order)
        shares = _shares(fitted, chosen)
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


def _shares(table: Array, chosen: Array) -> Array:
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
    axes: Axes
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.bands.key, self.weights, self.wavelengths.key, self.grid, self.axes

    @cached_property
    def wavelengths(self) -> Step:
        """Recipe of those that stand for all bands that count."""
        centres = tuple(self.bands.centres_um[place] for place in used_bands(self.weights))
        laws = (
            factor.by_wavelength.at(wavelength)
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
        return mirrored_spectrum if self.axes == "mirrored" else periodic_spectrum

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
            part = self._transform(work, picture)
            mean += part.mean * product.at_zero(work)
            total = self._added(work, total, part.values, product)
        assert total is not None
        return MeanFree(total, mean)

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
