"""OTF of a sampled exit pupil: autocorrelation, interpolation and an estimate of the error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError

Array = NDArray[Any]
Complexes = NDArray[np.complex128]
Indices = NDArray[np.int64]
Corner = Callable[[int, int], Array]  # of the cells: (0 near or 1 far along, likewise across)
INTERPOLATIONS = ("linear", "bilinear")


def complex_pupil(*, transmission: ArrayLike, wavefront_waves: ArrayLike = 0.0) -> Complexes:
    """Amplitude transmission of a pupil with a wavefront error in waves: t · exp(2πi W).

    The wavefront is of the same shape or a scalar, and ignored where nothing is transmitted.
    """
    amplitude = np.asarray(transmission, dtype=np.float64)
    waves = np.where(amplitude != 0.0, np.asarray(wavefront_waves, dtype=np.float64), 0.0)
    return np.asarray(amplitude * np.exp(2j * np.pi * waves), dtype=np.complex128)


def autocorrelation(pupil: ArrayLike, *, workers: int | None = None) -> Complexes:
    """Raw autocorrelation of a sampled pupil at integer lags, 1 at zero lag.

    Parameters
    ----------
    pupil : array_like
        Real or complex amplitude transmission, shape (rows, columns).
    workers : int, optional
        Threads of the transforms.

    Returns
    -------
    ndarray
        Complex, shape (2 rows - 1, 2 columns - 1): lags -(rows - 1) … rows - 1 and likewise across,
        zero lag in the middle. C(s) = Σ P(p + s) P*(p) / Σ |P|², exactly Hermitian.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-28; Tantalo 1996, eq. 4.15.
    """
    samples = _checked(pupil)
    rows, columns = samples.shape
    shape = (2 * rows - 1, 2 * columns - 1)
    padded = tuple(scipy.fft.next_fast_len(size) for size in shape)
    spectrum = scipy.fft.fft2(samples, padded, workers=workers)
    power = spectrum.real**2 + spectrum.imag**2
    raw = scipy.fft.ifft2(power, workers=workers, overwrite_x=True)
    lags_y, lags_x = np.arange(1 - rows, rows), np.arange(1 - columns, columns)
    raw = raw[np.ix_(lags_y, lags_x)]
    raw = 0.5 * (raw + np.conj(raw[::-1, ::-1]))
    raw /= np.sum(np.abs(samples) ** 2)
    if not np.any(samples.imag):
        raw.imag = 0.0
    raw[rows - 1, columns - 1] = 1.0
    return np.asarray(raw, dtype=np.complex128)


def _checked(pupil: ArrayLike) -> Complexes:
    samples: Complexes = np.asarray(pupil, dtype=np.complex128)
    if samples.ndim != 2 or samples.size == 0:
        raise DataError(f"a pupil must be an array (rows, columns), not of shape {samples.shape}")
    if not np.all(np.isfinite(samples)):
        raise DataError("the pupil holds a sample that is not finite")
    peak = np.max(np.abs(samples))
    if peak == 0.0:
        raise DataError("the pupil transmits nothing: every sample is 0")
    return np.asarray(samples / peak, dtype=np.complex128)


def sampled_otf(
    correlation: Array, *, lag_x: ArrayLike, lag_y: ArrayLike, interpolation: str = "bilinear"
) -> Array:
    """OTF between the integer lags of a raw autocorrelation.

    Parameters
    ----------
    correlation : ndarray
        From `autocorrelation`, or its real part; odd sizes, zero lag in the middle.
    lag_x, lag_y : array_like
        Lags [samples of the pupil]; they broadcast, soonest as one row and one column. 0 is
        returned beyond the array.
    interpolation : str
        ``bilinear`` over the four lags around, or ``linear`` over the triangle of three that the
        cell's diagonal through its corner nearest to zero lag leaves.

    Returns
    -------
    ndarray
        OTF, complex as the autocorrelation is; Hermitian to the last bit: H(-lag) = conj(H(lag)).

    Source: Tantalo 1996, section 4.3 (the two choices of interpolation).
    """
    if interpolation not in INTERPOLATIONS:
        raise ParameterError("interpolation", interpolation, "one of " + ", ".join(INTERPOLATIONS))
    x, y = np.asarray(lag_x, dtype=np.float64), np.asarray(lag_y, dtype=np.float64)
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise DataError("the pupil's OTF is needed at a lag that is not finite")
    interpolate = _bilinear if interpolation == "bilinear" else _linear
    rows, columns = (size // 2 for size in correlation.shape)
    across, along = _Cells.of(x, columns), _Cells.of(y, rows)
    if x.ndim == y.ndim == 2 and x.shape[0] == y.shape[1] == 1:
        lines, near, far = along.lines()
        rows_framed = _framed(correlation, lines)
        beside = [np.take(rows_framed, index[0], axis=1) for index in (across.near, across.far)]

        def corner(down: int, right: int) -> Array:
            part: Array = beside[right][(far if down else near)[:, 0]]
            return part

    else:
        framed = np.pad(correlation, FRAME)

        def corner(down: int, right: int) -> Array:
            part: Array = framed[
                along.far if down else along.near, across.far if right else across.near
            ]
            return part

    return interpolate(corner, across.part, along.part)


FRAME = 2  # zeros around the autocorrelation, in which lags beyond it end


@dataclass(frozen=True)
class _Cells:
    """Places in a framed array of the lags that a lag lies between, and how far it is from one.

    Cells count away from zero lag, so that opposite lags use the same weights.
    """

    near: Indices
    far: Indices
    part: NDArray[np.float64]

    @classmethod
    def of(cls, lag: NDArray[np.float64], reach: int) -> _Cells:
        inside = np.minimum(np.abs(lag), reach + 1.0)
        lower = np.floor(inside)
        side, index = np.where(lag < 0.0, -1, 1), lower.astype(np.int64)
        middle = reach + FRAME
        return cls(middle + side * index, middle + side * (index + 1), inside - lower)

    def lines(self) -> tuple[Indices, Indices, Indices]:
        """Every place once, without the frame, and where among them near and far ones are."""
        places, index = np.unique(np.stack([self.near, self.far]), return_inverse=True)
        near, far = index.reshape(2, *self.near.shape)
        return places - FRAME, near, far


def _framed(correlation: Array, lines: Indices) -> Array:
    """Rows of the autocorrelation in their frame of zeros."""
    height, width = correlation.shape
    inside = (lines >= 0) & (lines < height)
    framed = np.zeros((len(lines), width + 2 * FRAME), correlation.dtype)
    framed[inside, FRAME:-FRAME] = correlation[lines[inside]]
    return framed


def _bilinear(corner: Corner, part_x: NDArray[np.float64], part_y: NDArray[np.float64]) -> Array:
    top = corner(0, 0) * (1.0 - part_x) + corner(0, 1) * part_x
    bottom = corner(1, 0) * (1.0 - part_x) + corner(1, 1) * part_x
    otf: Array = top * (1.0 - part_y) + bottom * part_y
    return otf


def _linear(corner: Corner, part_x: NDArray[np.float64], part_y: NDArray[np.float64]) -> Array:
    third = np.where(part_x >= part_y, corner(0, 1), corner(1, 0))
    larger, smaller = np.maximum(part_x, part_y), np.minimum(part_x, part_y)
    otf: Array = corner(0, 0) * (1.0 - larger) + third * (larger - smaller) + corner(1, 1) * smaller
    return otf
