"""Few wavelengths whose transfer functions stand for those of all bands.

H(f, λ) = Σ_j H(f, λ_j)·p_j(λ) to within an error that is read off the transfer function alone,
whatever the scene. The λ_j are bands of the picture, chosen by pivoted orthogonalisation; the p_j
fit all others in least squares with Σ_j p_j = 1, so that a uniform picture stays what it is
(interpolative decomposition; Cheng, Gimbutas, Martinsson and Rokhlin 2005, SIAM J. Sci. Comput. 26,
1389).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.band_stack import Row
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.transfer.factors import Factor, Grid, Planar

Array = NDArray[Any]
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


@dataclass(frozen=True, eq=False)
class ChosenWavelengths(Recipe):
    """The wavelengths that factors need at a grid's frequencies within the error budget."""

    factors: tuple[Planar, ...]
    centres_um: Row
    grid: Grid
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return tuple(factor.key for factor in self.factors), self.centres_um, self.grid

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """What the laws at single wavelengths are made of."""
        laws = [
            factor.by_wavelength.at(wavelength)
            for factor in self.factors
            for wavelength in self.centres_um
            if factor.by_wavelength is not None
        ]
        return tuple(one for law in laws for one in law.inputs)

    def compute(self, work: Work) -> WavelengthRank:
        """Fit on every other place, judge on those between."""
        count = len(self.centres_um)
        if not self.factors:
            return WavelengthRank((0,), np.ones((1, count)), 0.0)
        if work.policy.budget == 0.0 or count == 1:
            return WavelengthRank(tuple(range(count)), np.eye(count), 0.0)
        xi, eta = _places(self.factors, self.grid)
        # The whole square of frequencies has its corner where a radius reaches furthest.
        table = np.empty((xi.size, count), complex)
        for band, wavelength in enumerate(self.centres_um):
            work.check()
            table[:, band] = transfer_at(work, self.factors, wavelength, xi, eta)
        if not np.iscomplexobj(table) or not table.imag.any():
            table = np.ascontiguousarray(table.real)
        chosen = work.policy.tolerance
        tolerance = _USUAL[work.policy.precision] if chosen is None else _SHARE * chosen
        samples = self.grid.rows * self.grid.columns
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
