"""Edges' samples against their spreads: what is an edge's own is fitted to each by itself.

An edge's levels, place, turn and bend, and the slope of its sides, are no parameters of the chain.
For every set of these they take the values that fit best, and what is left of the samples is a
function of the chain's parameters alone: variable projection (Golub and Pereyra 1973), with
Kaufman's (1975) form of the derivatives. All edges are fitted at once, in rows of arrays that are
as long as the edge with the most samples needs; what is too many has no weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.fit.patch import Patch
from app.fit.spread_table import SpreadTable

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_PASSES = 12
_SETTLED = 1e-4  # samples: what that leaves of the residuals is of second order
_MOST_MOVE = 0.5  # samples in one pass
_MOST_AWAY = 0.4  # of the reach
_OWN, _LINEAR, _SHADED = 3, 4, 2  # place, turn and bend; levels and slopes; slopes of each side
_LEVEL = 0.005  # of the step: what is nearer to a level counts as that
_LEAST_LEVEL = 50  # samples of a side, of which its noise is taken
_RIDGE = 1e-12


@dataclass(frozen=True)
class EdgesAt:
    """All edges fitted with given spreads; a row of each array for an edge."""

    residual: Matrix  # samples less the model, in standard deviations of their noise
    model: Matrix  # in the picture's unit
    weight: Matrix  # inverse standard deviation of each sample; 0 where there is none
    distance: Matrix  # from the edge as fitted
    spread: Matrix  # there, from 0 to 1
    levels: Matrix  # low level, step, and inclines of each edge
    own: Matrix  # place (samples), turn and bend (samples at the ends) of each edge
    # what edges' own parameters do to the weighted samples, and its products
    columns: NDArray[np.float64]
    gram: NDArray[np.float64]

    @property
    def step(self) -> Vector:
        return np.asarray(self.levels[:, 1], np.float64)

    @property
    def cost(self) -> float:
        return float(np.vdot(self.residual, self.residual))

    def without_own(self, change: Matrix) -> Matrix:
        """A change of the weighted samples less what edges' own parameters can undo."""
        along = np.matmul(self.columns, change[..., np.newaxis])
        factors = np.linalg.solve(self.gram, along)
        undone = np.matmul(np.swapaxes(self.columns, 1, 2), factors)[..., 0]
        return np.asarray(change - undone, np.float64)


class EdgeFits:
    """Patches together; each begins from where it was last."""

    def __init__(self, patches: Sequence[Patch]) -> None:
        self.patches = tuple(patches)
        longest = max(len(patch.value) for patch in patches)

        def rows(arrays: Sequence[Vector]) -> Matrix:
            made = np.zeros((len(arrays), longest))
            for row, array in zip(made, arrays, strict=True):
                row[: len(array)] = array
            return made

        self._inside = rows([np.ones(len(patch.value)) for patch in patches])
        self._distance = rows([patch.distance for patch in patches])
        self._seen = self._value = rows([patch.value for patch in patches])
        reach = np.array([patch.reach for patch in patches])[:, np.newaxis]
        half = np.array([np.abs(patch.along).max() or 1.0 for patch in patches])[:, np.newaxis]
        along = rows([patch.along for patch in patches]) / half
        self._moves = np.stack([np.ones_like(along), along, along**2 - 1.0 / 3.0], axis=1)
        self._slope = self._distance / reach
        self._limit = _MOST_AWAY * reach
        self._shaded = np.array([float(patch.shaded) for patch in patches])[:, np.newaxis]
        self._own = np.zeros((len(patches), _OWN))
        self._step = np.array([patch.high - patch.low for patch in patches])
        self._variances = np.array([(p.low_variance, p.high_variance) for p in patches])
        self._frozen: Matrix | None = None

    def at(self, table: SpreadTable) -> EdgesAt:
        own, step = self._own, self._step
        for last in range(_PASSES, -1, -1):
            distance = self._moved(own)
            spread, slope = table.at_all(distance)
            weight = self._weight(spread)
            columns = self._columns(spread, slope) * weight[:, np.newaxis, :]
            value = self._value * weight
            solution, gram, length = _least_squares(columns, value)
            change = np.clip(solution[:, -_OWN:] / -step[:, np.newaxis], -_MOST_MOVE, _MOST_MOVE)
            change = np.where(np.isfinite(change), change, 0.0)
            if not last or float(np.abs(change).max()) < _SETTLED:
                break
            own = np.clip(own + change, -self._limit, self._limit)
            step = np.where(solution[:, 1] == 0.0, step, solution[:, 1])
        levels, *_ = _least_squares(columns[:, :-_OWN], value)
        self._own, self._step = own, np.where(levels[:, 1] == 0.0, step, levels[:, 1])
        fitted = np.matmul(levels[:, np.newaxis, :], columns[:, :-_OWN])[:, 0]
        with np.errstate(all="ignore"):
            model = np.where(weight > 0.0, fitted / weight, 0.0)
        columns = columns / length[..., np.newaxis]
        return EdgesAt(value - fitted, model, weight, distance, spread, levels, own, columns, gram)

    def derivative(self, fitted: EdgesAt, other: SpreadTable) -> Vector:
        """Residuals' change to other spreads, all of the edges' own fitted anew."""
        after, _ = other.at_all(fitted.distance)
        change = (fitted.spread - after) * fitted.weight * fitted.step[:, np.newaxis]
        return fitted.without_own(change).ravel()

    def leave_out(self, beyond: Sequence[Vector], weight: Matrix) -> float:
        """Take from each edge's samples what is not of the edge.

        Returns the sum of squares, with these weights, by which that differs from what was left
        out before.
        """
        before, self._value = self._value, self._seen.copy()
        for row, array in zip(self._value, beyond, strict=True):
            row[: len(array)] -= array
        return float(np.sum(((self._value - before) * weight) ** 2))

    def freeze(self, fitted: EdgesAt) -> None:
        """Take the noise of the residuals on the level sides, and weights that stay.

        They are no part of what is fitted from now on.
        """
        with np.errstate(all="ignore"):
            left = np.where(fitted.weight > 0.0, fitted.residual / fitted.weight, 0.0)
        variances = self._variances.copy()
        sides = (fitted.spread < _LEVEL, fitted.spread > 1.0 - _LEVEL)
        for number, patch in enumerate(self.patches):
            inside = self._inside[number] > 0.0
            for place, side in enumerate(sides):
                far = left[number][side[number] & inside]
                if len(far) >= _LEAST_LEVEL:
                    seen = float(far @ far) / (len(far) - _LINEAR / 2.0)
                    variances[number, place] = max(seen, patch.least_variance)
        self._variances, self._frozen = variances, None
        self._frozen = self._weight(fitted.spread)

    @property
    def degrees(self) -> int:
        """Samples less what is fitted to each edge."""
        return sum(
            len(patch.value) - _OWN - _LINEAR - (_SHADED if patch.shaded else 0)
            for patch in self.patches
        )

    def _moved(self, own: Matrix) -> Matrix:
        moved = np.matmul(own[:, np.newaxis, :], self._moves)[:, 0]
        return np.asarray(self._distance - moved, np.float64)

    def _columns(self, spread: Matrix, slope: Matrix) -> NDArray[np.float64]:
        moves, incline = self._moves, self._slope
        along = moves[:, 1]
        shaded = self._shaded * spread
        return np.stack(
            [
                moves[:, 0], spread, incline, along, shaded * incline, shaded * along,
                slope, slope * along, slope * moves[:, 2],
            ],
            axis=1,
        )  # fmt: skip

    def _weight(self, spread: Matrix) -> Matrix:
        if self._frozen is not None:
            return self._frozen
        low, high = self._variances[:, :1], self._variances[:, 1:]
        variance = low + (high - low) * np.clip(spread, 0.0, 1.0)
        return np.asarray(self._inside / np.sqrt(variance), np.float64)


def _least_squares(
    columns: NDArray[np.float64], value: Matrix
) -> tuple[Matrix, NDArray[np.float64], Matrix]:
    """Factors of the columns for each edge; products of columns of length 1; their lengths."""
    length = np.sqrt(np.einsum("ekn,ekn->ek", columns, columns)) + 1e-300
    scaled = columns / length[..., np.newaxis]
    gram = np.matmul(scaled, np.swapaxes(scaled, 1, 2))
    index = np.arange(gram.shape[1])
    gram[:, index, index] += _RIDGE  # columns that are alike share; those of nothing get nothing
    products = np.matmul(scaled, value[..., np.newaxis])
    solution = np.linalg.solve(gram, products)[..., 0] / length
    return solution, gram, length
