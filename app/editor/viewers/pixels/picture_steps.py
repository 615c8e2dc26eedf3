"""Steps from what is on a wire to the samples that are shown, kept in the store like any other."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from app.editor.viewers.pixels.grey_levels import Range, Spread, quantiles, spread_of
from core.chain.realize import realize, spectrum
from core.chain.wires import SpectrumWire, Transfer
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from nodes.files.read import check_finite

Array = NDArray[Any]
INNER = (0.005, 0.995)


@ends_lineage
def centred_plane(work: Work, *, value: SpectrumWire | Transfer) -> Array:
    """Samples of a magnitude, phase or transfer function with zero frequency in the middle."""
    samples: Array = realize(value, work)
    return np.asarray(scipy.fft.fftshift(real(work, samples)))


@ends_lineage
def centred_modulus(work: Work, image: Array) -> Array:
    """Modulus of the unnormalised spectrum of an image, zero frequency in the middle."""
    return np.asarray(scipy.fft.fftshift(np.abs(spectrum(work, image))))


@ends_lineage
def real(_work: Work, samples: Array) -> Array:
    """The samples, or of complex ones the modulus."""
    return np.abs(samples) if np.iscomplexobj(samples) else samples


@ends_lineage
def logarithm(_work: Work, samples: Array) -> Array:
    """Decimal logarithm of the modulus; 0 becomes the least other modulus."""
    modulus = np.abs(samples)
    lit = modulus > 0
    least = modulus.min(where=lit, initial=np.inf) if lit.any() else 1.0
    np.maximum(modulus, modulus.dtype.type(least), out=modulus)
    return np.asarray(np.log10(modulus, out=modulus))


@ends_lineage
def difference(_work: Work, samples: Array, other: Array) -> Array:
    """Samples less those of another picture."""
    return np.asarray(samples - other)


@ends_lineage
def one_of(_work: Work, pictures: Array, *, index: int) -> Array:
    """One of several pictures that are made together."""
    return np.asarray(pictures[index])


@ends_lineage
def spread(work: Work, samples: Array, *, name: str) -> Spread:
    """Extremes and histogram.

    Raises
    ------
    DataError
        If samples are not finite.
    """
    with np.errstate(invalid="ignore"):
        low, high = float(samples.min()), float(samples.max())
    if not (np.isfinite(low) and np.isfinite(high)):
        check_finite(samples, name)
    return spread_of(samples, for_each=work.for_each)


@ends_lineage
def inner_range(work: Work, samples: Array, whole: Spread) -> Range:
    """From the 0.5 % to the 99.5 % quantile; the extremes where these are equal."""
    low, high = quantiles(samples, whole, INNER, for_each=work.for_each)
    return (low, high) if high > low else (whole.low, whole.high)
