"""What a fit gives: parameters with errors and correlations, and what is not determined."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.fit.chain_fit import ChainFit
from app.fit.identifiability import Combination, Identified, identified
from core.physics.measurement.sample_noise import LevelVariance

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_UNCERTAIN = 0.5  # of a value: with a larger error it is hardly measured
_CORRELATED = 0.98
_FEW = 1.5  # edges: less is one that has four fifths of what is known, and nothing checks it
_RIVAL = 4.0  # standard errors, from which on a value is another one


@dataclass(frozen=True)
class FittedParameter:
    # its name and unit
    port: str
    unit: str
    # the value and its standard error; both None where the pictures do not determine it
    value: float | None
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
    # what is known of parameters that are not told apart
    combinations: tuple[Combination, ...] = ()
    warnings: tuple[str, ...] = ()  # one line each
    notes: tuple[str, ...] = ()  # what was assumed
    noise: NoiseComparison | str = ""  # the noise, or why it was not compared
    refused: tuple[str, ...] = ()  # why other candidates for edges were not used

    @property
    def chi2_per_degree(self) -> float:
        return self.fit.misfit.chi2_per_degree


def result_of(fit: ChainFit, cost: Callable[[Vector], float]) -> FitResult:
    """Standard errors, correlations and warnings of a fit; `cost` is its sum of squares."""
    known = identified(fit, cost)
    rivals = _rivals(fit, known)
    undetermined = known.undetermined | set(rivals)
    if fit.misfit.is_hopeless:
        undetermined = undetermined | fit.shown
    lone = tuple(i for i in _lone(fit) if i not in undetermined)
    undetermined = undetermined | set(lone)
    with np.errstate(all="ignore"):
        sigma = np.sqrt(np.diag(known.covariance))
        correlation = known.covariance / np.outer(sigma, sigma)
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
            f"{fit.free[i].port}: its sign has no effect on the edges; it is reported as positive"
            for i in fit.unsigned
            if i not in undetermined
        ),
        *_weak(parameters, correlation),
        *_misfit(fit, lone),
    )
    return FitResult(fit, tuple(parameters), correlation, known.combinations, tuple(warnings))


def _rivals(fit: ChainFit, known: Identified) -> tuple[int, ...]:
    """Parameters that have quite another value in a solution that fits nearly as well."""
    sigma = np.sqrt(np.diag(known.covariance))
    return tuple(
        index
        for index in range(len(fit.free))
        if index not in known.undetermined
        and any(
            abs(float(other[index] - fit.values[index])) > _RIVAL * float(sigma[index])
            for other in fit.rivals
        )
    )


def _lone(fit: ChainFit) -> tuple[int, ...]:
    """Parameters that rest on one edge, while the edges leave much more than noise."""
    if not fit.misfit.is_material:
        return ()
    return tuple(i for i, edges in enumerate(fit.rests_on) if i in fit.shown and edges < _FEW)


def _other_solutions(fit: ChainFit, rivals: tuple[int, ...]) -> list[str]:
    if not rivals:
        return []
    sets = [
        ", ".join(
            f"{fit.free[i].port} = {values[i]:.4g} {fit.free[i].unit}".rstrip() for i in rivals
        )
        for values in (fit.values, *fit.rivals)
    ]
    return [
        f"{' and '.join(sets)} fit the edges nearly equally well, so none of these values is "
        "determined; give narrower ranges, or fix one of them"
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
            f"{names} cannot be separated by the edges{only if texts else ''}; fix one of them, "
            "or measure it in another way"
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
    """Whether a fitted value's standard error says that it may as well be another."""
    return value is not None and sigma is not None and sigma > _UNCERTAIN * abs(value)


def _weak(parameters: Sequence[FittedParameter], correlation: Matrix) -> list[str]:
    lines, many = [], len(parameters) > 1
    for one in parameters:
        if one.value is None or one.sigma is None:
            continue
        if hardly_determined(one.value, one.sigma):
            share = (
                f"{100.0 * one.sigma / abs(one.value):.0f} % of its value"
                if one.sigma <= abs(one.value)
                else "larger than its value"
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
            "the network does not reproduce this noise: the residuals are "
            f"{math.sqrt(noise):.2g} times the errors of the measured levels; the standard "
            "errors of parameters that act on the noise are widened accordingly"
        )
    if excess == 1.0:
        return lines
    if fit.misfit.is_hopeless:
        return [
            *lines,
            "no values in the ranges give edges of this shape: the residuals are "
            f"{100.0 * fit.misfit.material:.2g} % of a step, {math.sqrt(excess):.2g} times the "
            "noise; the picture may be compressed, interlaced, sharpened or nonlinear, or the "
            "chain lacks a stage, so no parameter that acts on the edges is determined",
        ]
    left = f"{math.sqrt(excess):.2g} times"
    lines += [
        f"{fit.free[i].port} is determined by only one of the edges, and the residuals are {left} "
        "the noise: its error cannot be found from the scatter between edges, so the parameter is "
        "treated as not determined"
        for i in lone
    ]
    if fit.rests_on:
        share = 100.0 * fit.misfit.material
        return [
            *lines,
            f"the edge residuals are up to {share:.2g} % of a step, {left} the noise: "
            f"the standard errors come from the scatter between {fit.misfit.edges} edges, or "
            "from all residuals if they are larger; blur that all edges share, "
            "such as softness of the scene, is treated as blur of the chain",
        ]
    return [
        *lines,
        f"the chain does not reproduce these edges: the residuals are {left} the noise; the "
        "standard errors are widened to match, but the values may be off by more; add the "
        "missing effect to the chain and fit again",
    ]
