"""The transfer function of a whole band: the mean of those of its wavelengths, by their light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.spectrum.band_stack import BandStack, Row
from core.transfer.factors import Factor, Law, Planar

Array = NDArray[Any]


def band_mean_otf(*, laws: tuple[Law, ...], shares: Array, **frequencies: Array) -> Array:
    """Σ_b s_b·H(f, λ_b).

    Parameters
    ----------
    laws : tuple of Law
        One of each wavelength, without recipes among their arguments.
    shares : ndarray, (wavelengths,)
        Their shares of the light; the sum is 1.
    **frequencies : ndarray
        What the laws are called with.
    """
    total: Array | None = None
    for law, share in zip(laws, shares, strict=True):
        part = share * law(None, **frequencies)
        total = part if total is None else total + part
    return np.asarray(total)


def over_bands(
    factor: Planar, bands: BandStack, weights: Row, *, node: str | None = None
) -> Planar:
    """A factor as the mean over a picture's bands, by the light that the weights count.

    A factor that does not depend on wavelength is left as it is; so is one whose laws hold recipes.
    """
    if factor.by_wavelength is None:
        return factor
    laws = tuple(factor.by_wavelength.at(wavelength) for wavelength in bands.centres_um)
    if any(law.inputs for law in laws):
        return factor
    shares = Step.of(_shares, bands.means(), node=node, weights=weights)
    return replace(factor, law=Law.of(band_mean_otf, laws=laws, shares=shares))


def weighted_factors(
    factors: Sequence[Factor], bands: BandStack, weights: Row
) -> tuple[Factor, ...]:
    """Every factor as the mean over a picture's bands."""
    return tuple(
        over_bands(factor, bands, weights, node=factor.node)
        if isinstance(factor, Planar)
        else factor
        for factor in factors
    )


def light_shares(bands: BandStack, weights: Row, *, node: str | None = None) -> Recipe:
    """Recipe of the share that every band has in a weighted sum of the picture's mean."""
    return Step.of(_shares, bands.means(), node=node, weights=weights)


@ends_lineage
def _shares(_: Work, means: Array, *, weights: Row) -> Array:
    light = np.maximum(means * np.array(weights), 0.0)
    total = float(light.sum())
    if not total > 0.0:
        raise DataError("the picture has no light in its bands: no band can be weighted by it")
    return np.asarray(light / total)
