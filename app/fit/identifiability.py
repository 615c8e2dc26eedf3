"""Which parameters the edges determine, and which combination of those that they do not.

The derivatives of the residuals, each over its own length, have small singular values where
parameters do the same to the samples (Belsley, Kuh and Welsch 1980, Regression Diagnostics, ch. 3).
What then stays the same along the line on which nothing changes is looked for among the
combinations that there are in such chains: the root of the sum of squares (widths of blurs), the
sum, and the product or ratio; each is walked along a good way, and the one that changes nothing is
the one that is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.fit.chain_fit import ChainFit, scales_of
from app.fit.parameter_search import places

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Cost = Callable[[Vector], float]

_ALIKE = 3e-3  # of the largest singular value, below which two do the same but for differences
_NO_EFFECT = 1.0  # standard deviations by which a whole scale's change moves all samples together
_SHARE = 0.1  # of a direction, from which on a parameter is part of it
_FAR = 0.5  # of the way from a parameter to nothing, that a combination is walked
_UNCHANGED, _HALVINGS = 1.0, 30  # of the sum of squares
_MATCH = 0.02  # by which ratios may differ from those of a combination with whole factors


@dataclass(frozen=True)
class Combination:
    """What is known of parameters that are not told apart."""

    members: tuple[int, ...]  # their places among the free parameters
    text: str  # the combination, in the parameters' names
    # its value and standard error
    value: float
    sigma: float
    unit: str  # its unit; empty where it has none that is plain


@dataclass(frozen=True)
class Identified:
    # of the parameters that are determined; NaN in rows and columns of the others
    covariance: Matrix
    # parameters at an end of their range where the edges change with their square only: the
    # standard error is how far they may be from it
    limited: tuple[int, ...]
    without_effect: tuple[int, ...]  # parameters of which the edges show nothing
    combinations: tuple[Combination, ...]  # of those that are not told apart

    @property
    def undetermined(self) -> frozenset[int]:
        together = {index for one in self.combinations for index in one.members}
        return frozenset(together | set(self.without_effect))


def identified(fit: ChainFit, cost: Cost) -> Identified:
    count = len(fit.free)
    scales = scales_of(fit.free, fit.values)
    lengths = np.linalg.norm(fit.jacobian, axis=0)
    flat = [int(i) for i in np.flatnonzero(lengths * scales < _NO_EFFECT)]
    reaches = {i: _reach(fit, cost, i) for i in flat}
    none = tuple(i for i in flat if reaches[i] is None)
    seen = [i for i in range(count) if i not in flat]
    covariance = np.full((count, count), np.nan)
    for i, reach in reaches.items():
        if reach is not None:
            covariance[i, :] = covariance[:, i] = 0.0
            covariance[i, i] = reach**2 * max(fit.misfit.excess, fit.misfit.noise_excess)
    limited = tuple(i for i in flat if reaches[i] is not None)
    if not seen:
        return Identified(covariance, limited, none, ())
    unit = fit.jacobian[:, seen] / lengths[seen]
    _, singular, rows = np.linalg.svd(unit, full_matrices=False)
    good = singular >= _ALIKE * singular[0]
    inverse = (rows[good].T / singular[good] ** 2) @ rows[good]
    inverse /= np.outer(lengths[seen], lengths[seen])
    # Directions in which nothing changes, in the parameters' own units.
    blind = rows[~good] / lengths[seen]
    groups = _groups(rows[~good])
    lost = {i for group in groups for i in group}
    for a, i in enumerate(seen):
        for b, j in enumerate(seen):
            if a not in lost and b not in lost:
                covariance[i, j] = inverse[a, b]
    combinations: list[Combination] = []
    for group in groups:
        inside = blind[:, group][np.linalg.norm(rows[~good][:, group], axis=1) > 0.5]
        members = [seen[a] for a in group]
        combinations += _combinations(fit, cost, members, inside, inverse[np.ix_(group, group)])
    return Identified(covariance, limited, none, tuple(combinations))


def _reach(fit: ChainFit, cost: Cost, index: int) -> float | None:
    """How far a parameter moves until the sum of squares is more by 1; None where it never is."""
    here, parameter = cost(fit.values), fit.free[index]
    value = float(fit.values[index])

    def rise(other: float) -> float:
        changed = fit.values.copy()
        changed[index] = other
        return cost(changed) - here

    tried = sorted((p for p in places(parameter) if p != value), key=lambda p: abs(p - value))
    seen = next((float(p) for p in tried if _UNCHANGED < rise(float(p)) < math.inf), None)
    if seen is None:
        return None
    near, far = value, seen
    for _ in range(_HALVINGS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if rise(middle) < _UNCHANGED else (near, middle)
    return abs(far - value)


def _groups(blind: Matrix) -> list[list[int]]:
    """Parameters that share directions in which nothing changes."""
    groups: list[set[int]] = []
    for row in blind:
        members = set(np.flatnonzero(np.abs(row) > _SHARE * np.abs(row).max()).tolist())
        touching = [group for group in groups if group & members]
        groups = [group for group in groups if not group & members]
        groups.append(members.union(*touching))
    return [sorted(group) for group in groups]


def _combinations(
    fit: ChainFit, cost: Cost, members: list[int], blind: Matrix, inverse: Matrix
) -> list[Combination]:
    """What is known of a group: combinations that stay the same in its blind directions.

    The first parameters, as many as there are such directions, take part in the combination of
    every other one.
    """
    count = len(blind)
    order = _order(blind)
    values = fit.values[members]
    names = [fit.free[i].port for i in members]
    units = {fit.free[i].unit for i in members}
    candidates = []
    for power in (2, 1, 0):
        if power != 1 and not np.all(values > 0.0):
            continue
        # of the values' squares, of themselves, or of their logarithms
        steps = blind / values if power == 0 else blind * values ** (power - 1)
        # Factors of the first ones that undo what a blind direction does to another one.
        solved, *_ = np.linalg.lstsq(steps[:, order[:count]], steps[:, order[count:]], rcond=None)
        factors = np.asarray(-solved, np.float64)
        form = _Form(power, tuple(order), count, factors)
        candidates.append((_change(fit, cost, members, form, values), form))
    form = min(candidates, key=lambda pair: pair[0])[1]
    unit = units.pop() if len(units) == 1 and form.power else ""
    made = []
    for number in range(len(members) - count):
        weights = form.weights(number)
        text, value, gradient = _written(form.power, weights, names, values)
        variance = float(gradient @ inverse @ gradient)
        taken = tuple(i for i, w in zip(members, weights, strict=True) if w != 0.0)
        made.append(Combination(taken, text, value, math.sqrt(max(variance, 0.0)), unit))
    return made


def _order(blind: Matrix) -> list[int]:
    """The parameters that blind directions move, those first that take part in all combinations."""
    if len(blind) == 1:
        row = blind[0]
        # The one whose sign differs from all others, so that sums and not differences are known.
        signs = [int(np.sum(np.sign(row) == np.sign(value))) for value in row]
        first = int(np.argmin(signs))
        return [first, *(i for i in range(len(row)) if i != first)]
    chosen: list[int] = []
    left = blind.copy()
    for _ in range(len(blind)):
        lengths = np.linalg.norm(left, axis=0)
        lengths[chosen] = -1.0
        chosen.append(int(np.argmax(lengths)))
        axis = left[:, chosen[-1]] / max(float(np.linalg.norm(left[:, chosen[-1]])), 1e-300)
        left = left - np.outer(axis, axis @ left)
    return [*chosen, *(i for i in range(blind.shape[1]) if i not in chosen)]


@dataclass(frozen=True)
class _Form:
    """Σ of others and first ones times factors, of values to a power, or of logarithms (0)."""

    power: int
    order: tuple[int, ...]
    firsts: int
    factors: Matrix

    def weights(self, number: int) -> Vector:
        """Of each member in one combination."""
        weights = np.zeros(len(self.order))
        weights[self.order[self.firsts + number]] = 1.0
        for place, factor in enumerate(self.factors[:, number]):
            weights[self.order[place]] = _whole(float(factor))
        return weights

    def moved(self, values: Vector, factor: float) -> Vector | None:
        """The first parameters multiplied, the others so that every combination stays."""
        changed = values.copy()
        firsts, others = list(self.order[: self.firsts]), list(self.order[self.firsts :])
        changed[firsts] *= factor
        if self.power == 0:
            rise = np.log(factor) * self.factors.sum(axis=0)
            changed[others] *= np.exp(-rise)
            return changed
        rise = (changed[firsts] ** self.power - values[firsts] ** self.power) @ self.factors
        left = values[others] ** self.power - rise
        if self.power == 2:
            if np.any(left < 0.0):
                return None
            left = np.sqrt(left)
        changed[others] = left
        return changed


def _whole(factor: float) -> float:
    """A whole factor where it is one but for the differences' error."""
    near = round(factor)
    return float(near) if near and abs(factor - near) < _MATCH * abs(near) else factor


def _written(
    power: int, weights: Vector, names: Sequence[str], values: Vector
) -> tuple[str, float, Vector]:
    taken = [(n, float(w)) for n, w in zip(names, weights, strict=True) if w != 0.0]
    if power == 0:
        value = float(np.prod(np.abs(values) ** weights))
        text = " · ".join(name if w == 1.0 else f"{name}^{w:.4g}" for name, w in taken)
        return text, value, value * weights / values
    square = "²" if power == 2 else ""
    parts = [f"{n}{square}" if w == 1.0 else f"{w:.4g}·{n}{square}" for n, w in taken]
    text = " + ".join(parts).replace("+ -", "− ")
    total = float(weights @ values**power)
    if power == 1:
        return text, total, weights
    root = math.sqrt(max(total, 1e-300))
    return f"sqrt({text})", root, weights * values / root


def _change(fit: ChainFit, cost: Cost, members: list[int], form: _Form, values: Vector) -> float:
    """How much the sum of squares changes along the form, a good way to both sides."""
    before = cost(fit.values)
    worst, walked = 0.0, False
    for factor in (1.0 - _FAR, 1.0 + 0.3 * _FAR):
        moved = form.moved(values, factor)
        free = [fit.free[i] for i in members]
        if moved is None or any(
            not p.low <= value <= p.high for p, value in zip(free, moved, strict=True)
        ):
            continue
        changed = fit.values.copy()
        changed[members] = moved
        walked = True
        worst = max(worst, abs(cost(changed) - before))
    return worst if walked else math.inf
