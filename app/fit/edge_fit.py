"""Edges' samples against their spreads: what is an edge's own is fitted to each by itself.

An edge's levels, place, turn and bend, and the slope of its sides where they are not level, are no
parameters of the chain. For every set of these they take the values that fit best, and what is
left of the samples is a function of the chain's parameters alone: variable projection (Golub and
Pereyra 1973), with Kaufman's (1975) form of the derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.fit.patch import Patch
from app.fit.spread_table import SpreadTable

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_PASSES = 12
_SETTLED = 1e-6  # samples
_MOST_MOVE = 0.5  # samples in one pass
_OWN = 3  # place, turn and bend
_LEVEL = 0.005  # of the step: what is nearer to a level counts as that
_LEAST_LEVEL = 50  # samples of a side, of which its noise is taken


@dataclass(frozen=True)
class EdgeAt:
    """An edge fitted with a given spread.

    Parameters
    ----------
    residual : ndarray
        Samples less the model, in standard deviations of their noise.
    model : ndarray
        In the picture's unit.
    basis : ndarray
        Orthonormal, of what an edge's own parameters can do to the weighted samples.
    weight : ndarray
        Inverse standard deviation of each sample.
    distance : ndarray
        From the edge as fitted.
    step : float
        High level less low level.
    own : ndarray
        Place (samples), turn and bend (samples at the ends).
    """

    residual: Vector
    model: Vector
    basis: Matrix
    weight: Vector
    distance: Vector
    step: float
    own: Vector

    @property
    def cost(self) -> float:
        """Sum of squares."""
        return float(self.residual @ self.residual)


class EdgeFit:
    """One patch; begins each time from where the edge was last."""

    def __init__(self, patch: Patch) -> None:
        self.patch = patch
        half = float(np.abs(patch.along).max(initial=0.0)) or 1.0
        self._along = patch.along / half
        self._own = np.zeros(_OWN)
        reach = patch.reach
        self._slope = patch.distance / reach
        self._frozen: Vector | None = None

    def freeze(self, at: EdgeAt, spread: Vector) -> None:
        """Take the noise of the residuals on the level sides, and weights that stay.

        They are no part of what is fitted from now on.
        """
        left = at.residual / at.weight
        variances = []
        for side, before in (
            (spread < _LEVEL, self.patch.low_variance),
            (spread > 1.0 - _LEVEL, self.patch.high_variance),
        ):
            count = int(np.count_nonzero(side))
            far = left[side]
            # As many degrees are lost as the level and what goes with it have.
            seen = float(far @ far) / max(1, count - (self.own_parameters - _OWN) / 2.0)
            least = self.patch.least_variance
            variances.append(max(seen, least) if count >= _LEAST_LEVEL else before)
        self.patch = replace(self.patch, low_variance=variances[0], high_variance=variances[1])
        self._frozen = None
        self._frozen = self._weight(spread)

    def at(self, table: SpreadTable, edge: int) -> EdgeAt:
        """The best fit with that spread."""
        patch, own = self.patch, self._own.copy()
        reach = patch.reach
        for _ in range(_PASSES):
            distance = self._moved(own)
            spread, slope = table.at(edge, distance)
            weight = self._weight(spread)
            linear = self._linear(spread)
            step = self._step(linear, weight)
            moves = -step * np.column_stack(
                [slope, slope * self._along, slope * (self._along**2 - 1.0 / 3.0)]
            )
            columns = np.hstack([linear, moves])
            solution, *_ = np.linalg.lstsq(
                columns * weight[:, np.newaxis], patch.value * weight, rcond=1e-10
            )
            change = np.clip(solution[linear.shape[1] :], -_MOST_MOVE, _MOST_MOVE)
            if not np.all(np.isfinite(change)):
                break
            own = np.clip(own + change, -0.4 * reach, 0.4 * reach)
            if float(np.abs(change).max()) < _SETTLED:
                break
        self._own = own
        distance = self._moved(own)
        spread, slope = table.at(edge, distance)
        weight = self._weight(spread)
        linear = self._linear(spread)
        weighted = linear * weight[:, np.newaxis]
        solution, *_ = np.linalg.lstsq(weighted, patch.value * weight, rcond=1e-10)
        model = linear @ solution
        step = float(solution[1])
        moves = np.column_stack([slope, slope * self._along, slope * (self._along**2 - 1.0 / 3.0)])
        basis, _ = np.linalg.qr(np.hstack([weighted, moves * weight[:, np.newaxis]]))
        return EdgeAt((patch.value - model) * weight, model, basis, weight, distance, step, own)

    def derivative(self, at: EdgeAt, table: SpreadTable, other: SpreadTable, edge: int) -> Vector:
        """Residuals' change from one spread to another, all of the edge's own fitted anew."""
        before, _ = table.at(edge, at.distance)
        after, _ = other.at(edge, at.distance)
        change = (before - after) * (at.step * at.weight)
        return np.asarray(change - at.basis @ (at.basis.T @ change), np.float64)

    @property
    def own_parameters(self) -> int:
        """How many are fitted to the edge by itself."""
        return _OWN + (5 if self.patch.shaded else 2)

    def _moved(self, own: Vector) -> Vector:
        along = self._along
        return np.asarray(
            self.patch.distance - own[0] - own[1] * along - own[2] * (along**2 - 1.0 / 3.0),
            np.float64,
        )

    def _linear(self, spread: Vector) -> Matrix:
        columns = [np.ones(len(spread)), spread]
        if self.patch.shaded:
            columns += [self._along, self._slope * (1.0 - spread), self._slope * spread]
        return np.column_stack(columns)

    def _weight(self, spread: Vector) -> Vector:
        if self._frozen is not None:
            return self._frozen
        patch = self.patch
        share = np.clip(spread, 0.0, 1.0)
        variance = patch.low_variance + (patch.high_variance - patch.low_variance) * share
        return np.asarray(1.0 / np.sqrt(variance), np.float64)

    def _step(self, linear: Matrix, weight: Vector) -> float:
        solution, *_ = np.linalg.lstsq(
            linear * weight[:, np.newaxis], self.patch.value * weight, rcond=1e-10
        )
        return float(solution[1])


class EdgeFits:
    """All patches together."""

    def __init__(self, patches: Sequence[Patch]) -> None:
        self.edges = tuple(EdgeFit(patch) for patch in patches)

    def at(self, table: SpreadTable) -> tuple[EdgeAt, ...]:
        """Each fitted with its own spread."""
        return tuple(edge.at(table, number) for number, edge in enumerate(self.edges))

    def derivative(
        self, fitted: Sequence[EdgeAt], table: SpreadTable, other: SpreadTable
    ) -> Vector:
        """As `EdgeFit.derivative`, of all."""
        return np.concatenate(
            [
                edge.derivative(at, table, other, number)
                for number, (edge, at) in enumerate(zip(self.edges, fitted, strict=True))
            ]
        )

    def freeze(self, fitted: Sequence[EdgeAt], table: SpreadTable) -> None:
        """As `EdgeFit.freeze`, of all."""
        for number, (edge, at) in enumerate(zip(self.edges, fitted, strict=True)):
            edge.freeze(at, table.at(number, at.distance)[0])

    @property
    def patches(self) -> tuple[Patch, ...]:
        """The patches, with their noise as it is known now."""
        return tuple(edge.patch for edge in self.edges)

    @property
    def degrees(self) -> int:
        """Samples less what is fitted to each edge."""
        return sum(len(edge.patch.value) - edge.own_parameters for edge in self.edges)
