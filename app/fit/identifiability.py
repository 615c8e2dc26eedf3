"""Which parameters the edges determine, and which combination of those that they do not.

Small singular values of the scaled derivatives show it (Belsley, Kuh and Welsch 1980, Regression
Diagnostics, ch. 3). A root of a sum of squares, a sum or a product is then what stays the same.
"""

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
    # of those that are not told apart: groups, and what is known of a group with one effect
    together: tuple[tuple[int, ...], ...] = ()
    combinations: tuple[Combination, ...] = ()

    @property
    def undetermined(self) -> frozenset[int]:
        return frozenset(self.without_effect).union(*self.together)


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
        return Identified(covariance, limited, none)
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
        if len(inside) == 1 or len(group) - len(inside) == 1:
            members = [seen[a] for a in group]
            own = inverse[np.ix_(group, group)]
            combinations += _combinations(fit, cost, members, inside, own)
    together = tuple(tuple(seen[a] for a in group) for group in groups)
    return Identified(covariance, limited, none, together, tuple(combinations))


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
    """What stays the same in the blind directions of a group.

    In one direction the first parameter makes up for each of the others, so that it takes part in a
    combination with each. In more, all are in one combination.
    """
    values, alone = fit.values[members], len(blind) == 1
    # The one whose sign differs from all others, so that sums and not differences are known.
    signs = [int(np.sum(np.sign(blind[0]) == sign)) for sign in np.sign(blind[0])]
    first = int(np.argmin(signs)) if alone else 0
    others = [i for i in range(len(members)) if i != first]
    candidates = []
    for power in (2, 1, 0):  # of the values' squares, of themselves, or of their logarithms
        if power != 1 and not np.all(values > 0.0):
            continue
        steps = blind / values if power == 0 else blind * values ** (power - 1)
        still = np.linalg.svd(steps)[2][-1]
        # Weight of the first one over that of each other.
        ratios = -steps[0, others] / steps[0, first] if alone else still[first] / still[others]
        ratios = np.array([_whole(float(ratio)) for ratio in ratios])
        by_other = dict(zip(others, map(float, ratios), strict=True))
        moves = [by_other] if alone else [{other: ratio} for other, ratio in by_other.items()]
        worst = max(_change(fit, cost, members, power, first, move) for move in moves)
        candidates.append((worst, power, ratios))
    _, power, ratios = min(candidates, key=lambda one: one[0])
    weights = np.zeros((len(others) if alone else 1, len(members)))
    if alone:
        weights[:, first] = ratios
        weights[np.arange(len(others)), others] = 1.0
    else:
        weights[0, first], weights[0, others] = 1.0, 1.0 / ratios
    names = [fit.free[i].port for i in members]
    units = {fit.free[i].unit for i in members}
    unit = units.pop() if len(units) == 1 and power else ""
    made = []
    for row in weights:
        text, value, gradient = _written(power, row, names, values)
        variance = float(gradient @ inverse @ gradient)
        taken = tuple(i for i, w in zip(members, row, strict=True) if w != 0.0)
        made.append(Combination(taken, text, value, math.sqrt(max(variance, 0.0)), unit))
    return made


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


def _change(
    fit: ChainFit, cost: Cost, members: list[int], power: int, first: int, ratios: dict[int, float]
) -> float:
    """How much the sum of squares changes where the others make up for the first, to both sides."""
    before, values = cost(fit.values), fit.values[members]
    worst, walked = 0.0, False
    for factor in (1.0 - _FAR, 1.0 + 0.3 * _FAR):
        moved = values.copy()
        moved[first] *= factor
        for other, ratio in ratios.items():
            if power == 0:
                moved[other] *= factor**-ratio
                continue
            left = values[other] ** power - ratio * (moved[first] ** power - values[first] ** power)
            moved[other] = left if power == 1 else math.sqrt(left) if left >= 0.0 else math.nan
        changed = fit.values.copy()
        changed[members] = moved
        if all(p.low <= v <= p.high for p, v in zip(fit.free, changed, strict=True)):
            walked = True
            worst = max(worst, abs(cost(changed) - before))
    return worst if walked else math.inf
