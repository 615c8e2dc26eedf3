"""What a fit gives: parameters with errors and correlations, and what cannot be told."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from app.fit.chain_fit import ChainFit

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class FittedParameter:
    """A parameter as fitted.

    Parameters
    ----------
    port, unit : str
        Its name and unit.
    value, sigma : float or None
        The value and its standard error; both None where the pictures do not determine it.
    used : float
        What the fitted network has: of a value that is not determined one of those that fit.
    """

    port: str
    unit: str
    value: float | None
    sigma: float | None
    used: float


@dataclass(frozen=True)
class FitResult:
    """The whole outcome.

    Parameters
    ----------
    fit : ChainFit
        What was fitted to the edges.
    parameters : tuple of FittedParameter
        In the order given.
    correlation : ndarray
        Of the parameters; NaN where there is none.
    chi2_per_degree : float
        Of all samples.
    warnings : tuple of str
        One line each.
    notes : tuple of str
        What was assumed.
    """

    fit: ChainFit
    parameters: tuple[FittedParameter, ...]
    correlation: Matrix
    chi2_per_degree: float
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=())


def result_of(fit: ChainFit) -> FitResult:
    """Standard errors and correlations of a fit."""
    information = fit.jacobian.T @ fit.jacobian
    covariance = np.linalg.pinv(information) * fit.misfit.excess
    sigma = np.sqrt(np.diag(covariance))
    with np.errstate(all="ignore"):
        correlation = covariance / np.outer(sigma, sigma)
    np.fill_diagonal(correlation, 1.0)
    parameters = tuple(
        FittedParameter(p.port, p.unit, float(v), float(s), float(v))
        for p, v, s in zip(fit.free, fit.values, sigma, strict=True)
    )
    return FitResult(fit, parameters, correlation, fit.misfit.chi2_per_degree)
