"""What a fit gives: parameters with errors and correlations, and what is not determined."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from app.fit.chain_fit import ChainFit, scales_of
from app.fit.chain_transfer import places
from core.arrays import Matrix, Vector
from core.physics.measurement.sample_noise import LevelVariance
from core.records import dataclass

# Which parameters the edges determine, and which combination of those that they do not.
#
# Small singular values of the scaled derivatives show it (Belsley, Kuh and Welsch 1980, Regression
# Diagnostics, ch. 3). A root of a sum of squares, a sum or a product is then what stays the same.

Cost = Callable[[Vector], float]

_ALIKE = 3e-3  # of the largest singular value, below which two do the same but for differences
_NO_EFFECT = 1.0  # standard deviations by which a whole scale's change moves all samples together
_SHARE = 0.1  # of a direction, from which on a parameter is part of it
_FAR = 0.5  # of the way from a parameter to nothing, that a combination is walked
_UNCHANGED, _HALVINGS = 1.0, 30  # of the sum of squares
_MATCH = 0.02  # by which ratios may differ from those of a combination with whole factors


@dataclass(frozen=True)
class Combination:
    members: tuple[int, ...]  # their places among the free parameters
    text: str  # the combination, in the parameters' names
    value: float  # with its standard error
    sigma: float
    unit: str  # its unit; empty where it has none that is plain


@dataclass(frozen=True)
class Identified:
    covariance: Matrix  # of the parameters that are determined; NaN elsewhere
    # parameters at an end of their range where the edges change with their square only: the
    # standard error is how far they may be from it
    limited: tuple[int, ...]
    without_effect: tuple[int, ...]  # parameters of which the edges show nothing
    together: tuple[tuple[int, ...], ...] = ()  # groups not told apart
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
        # Whole factors where they are so but for the differences' error.
        near = np.rint(ratios)
        ratios = np.where(np.abs(ratios - near) < _MATCH * np.abs(near), near, ratios)
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


# Standard errors, correlations and warnings.

_UNCERTAIN = 0.5  # of a value: with a larger error it is hardly measured
_CORRELATED = 0.98
_FEW = 1.5  # edges: less is one that has four fifths of what is known, and nothing checks it
_RIVAL = 4.0  # standard errors, from which on a value is another one


@dataclass(frozen=True)
class FittedParameter:
    port: str
    unit: str
    value: float | None  # with its standard error; None where not determined
    sigma: float | None
    # what the fitted network has: of parameters with one effect values that fit together, of one
    # without effect what it had; None where that is empty
    used: float | None


@dataclass(frozen=True)
class NoiseComparison:
    measured: tuple[LevelVariance, ...]  # of the pictures
    predicted: tuple[float, ...]  # variance of a sample by the network
    fitted: bool  # whether free parameters have been fitted to it

    @property
    def ratio(self) -> float:
        """Predicted over measured standard deviation, the mean over levels by their samples."""
        weights = np.array([one.samples for one in self.measured], np.float64)
        measured = np.array([one.variance for one in self.measured])
        shares = np.sqrt(np.array(self.predicted) / measured)
        return float(np.average(shares, weights=weights))


@dataclass(frozen=True)
class FitResult:
    fit: ChainFit  # what was fitted to the edges
    parameters: tuple[FittedParameter, ...]  # in the order given
    correlation: Matrix  # of the parameters; NaN where there is none
    combinations: tuple[Combination, ...]  # of parameters not told apart
    warnings: tuple[str, ...]  # one line each
    notes: tuple[str, ...] = ()  # what was assumed
    noise: NoiseComparison | str = ""  # the noise, or why it was not compared

    @property
    def chi2_per_degree(self) -> float:
        return self.fit.misfit.chi2_per_degree


def result_of(fit: ChainFit, cost: Callable[[Vector], float]) -> FitResult:
    """Standard errors, correlations and warnings of a fit; `cost` is its sum of squares."""
    known = identified(fit, cost)
    with np.errstate(all="ignore"):
        sigma = np.sqrt(np.diag(known.covariance))
        correlation = known.covariance / np.outer(sigma, sigma)
    # Parameters that have quite another value in a solution that fits nearly as well.
    away = [np.abs(other - fit.values) for other in fit.rivals]
    determined = [i for i in range(len(fit.free)) if i not in known.undetermined]
    rivals = tuple(i for i in determined if any(one[i] > _RIVAL * sigma[i] for one in away))
    undetermined = known.undetermined | set(rivals)
    if fit.misfit.is_hopeless:
        undetermined = undetermined | fit.shown
    # Those that rest on one edge, while the edges leave much more than noise.
    few = [i for i, edges in enumerate(fit.rests_on) if i in fit.shown and edges < _FEW]
    lone = tuple(i for i in few if fit.misfit.is_material and i not in undetermined)
    undetermined = undetermined | set(lone)
    nowhere = sorted(undetermined)
    correlation[nowhere, :] = correlation[:, nowhere] = np.nan
    for index in range(len(fit.free)):
        if index not in undetermined:
            correlation[index, index] = 1.0
    parameters = []
    for i, (p, value) in enumerate(zip(fit.free, map(float, fit.values), strict=True)):
        if i in undetermined:
            used = p.present if i in known.without_effect else value
            parameters.append(FittedParameter(p.port, p.unit, None, None, used))
        else:
            parameters.append(FittedParameter(p.port, p.unit, value, float(sigma[i]), value))
    warnings = (
        *_unknown(fit, known),
        *_other_solutions(fit, rivals),
        *_at_ends(fit, known),
        *(
            f"{fit.free[i].port}: the sign does not affect the edges; a positive value is given"
            for i in fit.unsigned
            if i not in undetermined
        ),
        *_weak(parameters, correlation),
        *_misfit(fit, lone),
    )
    return FitResult(fit, tuple(parameters), correlation, known.combinations, tuple(warnings))


def _other_solutions(fit: ChainFit, rivals: tuple[int, ...]) -> list[str]:
    if not rivals:
        return []
    free = [(i, fit.free[i]) for i in rivals]
    sets = [
        ", ".join(f"{p.port} = {values[i]:.4g} {p.unit}".rstrip() for i, p in free)
        for values in (fit.values, *fit.rivals)
    ]
    return [
        f"{' and '.join(sets)} fit the edges nearly equally well, so none of these values is "
        "determined. Give narrower ranges, or fix one of the parameters"
    ]


def _unknown(fit: ChainFit, known: Identified) -> list[str]:
    lines = [
        f"{fit.free[i].port} has no effect on the edges of the picture: it is not determined and "
        "keeps its value"
        for i in known.without_effect
    ]
    for members in known.together:
        names = " and ".join(fit.free[i].port for i in members)
        texts = [
            f"{one.text} = {one.value:.6g} ± {one.sigma:.2g} {one.unit}".rstrip()
            for one in known.combinations
            if set(one.members) <= set(members)
        ]
        only = f": only {' and '.join(texts)} {'is' if len(texts) == 1 else 'are'} determined"
        lines.append(
            f"{names} cannot be separated by the edges{only if texts else ''}. Fix one of these "
            "parameters, or measure it in another way"
        )
    return lines


def _at_ends(fit: ChainFit, known: Identified) -> list[str]:
    lines = []
    undetermined = known.undetermined
    for index, (parameter, end) in enumerate(zip(fit.free, fit.at_end, strict=True)):
        if not end or index in undetermined:
            continue
        bound = parameter.low if end == "low" else parameter.high
        lines.append(
            f"{parameter.port} is at the {'lower' if end == 'low' else 'upper'} end of its range, "
            f"{bound:.6g} {parameter.unit}".rstrip()
            + (
                ": the standard error is the distance from this end that the edges still allow"
                if index in known.limited
                else ": the best value may lie beyond this end, so the standard error means little"
            )
        )
    return lines


def hardly_determined(value: float | None, sigma: float | None) -> bool:
    return value is not None and sigma is not None and sigma > _UNCERTAIN * abs(value)


def _weak(parameters: Sequence[FittedParameter], correlation: Matrix) -> list[str]:
    lines, many = [], len(parameters) > 1
    for one in parameters:
        if one.value is None or one.sigma is None:
            continue
        if hardly_determined(one.value, one.sigma):
            share = (
                f"{100.0 * one.sigma / abs(one.value):.0f} % of the value"
                if one.sigma <= abs(one.value)
                else "larger than the value"
            )
            lines.append(
                f"{one.port} is poorly determined: its standard error, {one.sigma:.2g}, is {share}"
                + (
                    "; the errors of the other parameters are valid if this value is about right"
                    if many
                    else ""
                )
            )
    for i, first in enumerate(parameters):
        for j in range(i):
            r = float(correlation[i, j])
            if math.isfinite(r) and abs(r) > _CORRELATED:
                lines.append(
                    f"{parameters[j].port} and {first.port} are nearly inseparable: their errors "
                    f"have a correlation of {r:.4f}"
                )
    return lines


def _misfit(fit: ChainFit, lone: tuple[int, ...]) -> list[str]:
    excess, noise = fit.misfit.excess, fit.misfit.noise_excess
    lines = []
    if noise > 1.0:
        lines.append(
            "the network does not reproduce the picture's noise: the residuals are "
            f"{math.sqrt(noise):.2g} times the errors of the measured variances. The standard "
            "errors of parameters that act on the noise are widened accordingly"
        )
    if excess == 1.0:
        return lines
    if fit.misfit.is_hopeless:
        return [
            *lines,
            "no values in the ranges give edges of this shape: the residuals are "
            f"{100.0 * fit.misfit.material:.2g} % of a step, {math.sqrt(excess):.2g} times the "
            "noise. The picture may be compressed, interlaced, sharpened or nonlinear, or the "
            "chain may lack a stage. No parameter that acts on the edges is determined",
        ]
    left = f"{math.sqrt(excess):.2g} times"
    lines += [
        f"{fit.free[i].port} is determined by only one of the edges, and the residuals are {left} "
        "the noise. A single edge shows no scatter, so the parameter's error is unknown: the "
        "parameter is treated as not determined"
        for i in lone
    ]
    if fit.rests_on:
        share = 100.0 * fit.misfit.material
        return [
            *lines,
            f"the edge residuals are up to {share:.2g} % of a step, {left} the noise. "
            f"The standard errors come from the scatter between {fit.misfit.edges} edges, or from "
            "all residuals, whichever gives larger errors. Blur that all edges share, such as "
            "softness of the scene, is treated as blur of the chain",
        ]
    return [
        *lines,
        f"the chain does not reproduce these edges: the residuals are {left} the noise. The "
        "standard errors are widened to match, but the values may be off by more. Add the "
        "missing effect to the chain and fit again",
    ]
