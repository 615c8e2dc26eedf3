"""Filtering along the scan lines (x) only: electronics that see one line after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from core.evaluation.float_guard import require_finite
from core.evaluation.work import Work
from core.transfer.factors import Edges, Grid, Separable
from core.transfer.periodic import fourier
from core.transfer.product import Product

Array = NDArray[Any]
BLOCK_SAMPLES = 1 << 16  # samples of a block of lines, to stay in a core's cache


def filter_lines(
    work: Work, image: Array, *, factors: tuple[Separable, ...], grid: Grid, edges: Edges
) -> Array:
    """Multiply each line's spectrum by the factors' x laws; their y laws must be empty.

    A line's mean passes by H(0), exactly where that is 1.
    """
    product = Product(factors)
    xi = grid.xi_mirrored() if edges == "reflect" else grid.xi_half()
    response = product.across(work, xi)
    result = np.empty(image.shape, work.policy.dtype)
    height = max(1, BLOCK_SAMPLES // image.shape[1])

    def one(start: int) -> None:
        lines = slice(start, min(start + height, image.shape[0]))
        mean = np.mean(image[lines], axis=1, keepdims=True, dtype=np.float64)
        values = np.subtract(image[lines], mean, dtype=result.dtype)
        filtered = (
            _mirrored(values, response) if edges == "reflect" else _periodic(values, response)
        )
        require_finite(filtered)
        np.add(filtered, (mean * response[0].real).astype(result.dtype), out=result[lines])

    work.for_each(one, range(0, image.shape[0], height))
    return result


def _mirrored(values: Array, response: Array) -> Array:
    """Even part by the DCT-II, odd part, moved by one index, by the DST-II, as in `mirrored`."""
    spectrum = scipy.fft.dct(values, type=2, axis=1, overwrite_x=True)
    real = spectrum * response.real.astype(spectrum.dtype)
    result = scipy.fft.idct(real, type=2, axis=1, overwrite_x=True)
    if np.iscomplexobj(response):
        odd = np.zeros_like(spectrum)
        np.multiply(spectrum[:, 1:], -response.imag[1:].astype(spectrum.dtype), out=odd[:, :-1])
        result += scipy.fft.idst(odd, type=2, axis=1, overwrite_x=True)
    return np.asarray(result)


def _periodic(values: Array, response: Array) -> Array:
    size = values.shape[1]
    if size == 1:
        return values
    spectrum = fourier().rfft(values, axis=1, overwrite_x=True)
    if size % 2 == 0:
        response = response.copy()
        response[-1] = response[-1].real  # at Nyquist the Hermitian part acts
    spectrum *= response.astype(spectrum.dtype)
    return np.asarray(fourier().irfft(spectrum, n=size, axis=1, overwrite_x=True))
