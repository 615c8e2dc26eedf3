"""OTF of a sampled exit pupil: autocorrelation, interpolation and an estimate of the error."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from core.errors import DataError, ParameterError

Complexes = NDArray[np.complex128]
INTERPOLATIONS = ("linear", "bilinear")


def complex_pupil(*, transmission: ArrayLike, wavefront_waves: ArrayLike = 0.0) -> Complexes:
    """Amplitude transmission of a pupil with a wavefront error: t · exp(2πi W).

    Parameters
    ----------
    transmission : array_like
        Amplitude transmission, shape (rows, columns).
    wavefront_waves : array_like
        Wavefront error [waves], same shape or a scalar; ignored where nothing is transmitted.

    Returns
    -------
    ndarray
        Complex pupil, shape (rows, columns).
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

    Raises
    ------
    DataError
        If the pupil is not a 2-D array of finite samples with some transmission.

    Notes
    -----
    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-28; Tantalo 1996, eq. 4.15.
    """
    samples = _checked(pupil)
    rows, columns = samples.shape
    shape = (2 * rows - 1, 2 * columns - 1)
    padded = tuple(fft.next_fast_len(size) for size in shape)
    spectrum = fft.fft2(samples, padded, workers=workers)
    power = spectrum.real**2 + spectrum.imag**2
    raw = fft.ifft2(power, workers=workers, overwrite_x=True)
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
        raise DataError(
            f"a pupil must be an array of rows and columns, not of shape {samples.shape}"
        )
    if not np.all(np.isfinite(samples)):
        raise DataError("the pupil holds a sample that is not finite")
    peak = np.max(np.abs(samples))
    if peak == 0.0:
        raise DataError("the pupil transmits nothing: every sample is 0")
    return np.asarray(samples / peak, dtype=np.complex128)


def sampled_otf(
    correlation: Complexes, *, lag_x: ArrayLike, lag_y: ArrayLike, interpolation: str = "bilinear"
) -> Complexes:
    """OTF between the integer lags of a raw autocorrelation.

    Parameters
    ----------
    correlation : ndarray
        From `autocorrelation`, odd sizes, zero lag in the middle.
    lag_x, lag_y : array_like
        Lags [samples of the pupil]; they broadcast. 0 is returned beyond the array.
    interpolation : str
        ``bilinear`` over the four lags around, or ``linear`` over the triangle of three that the
        cell's diagonal through its corner nearest to zero lag leaves.

    Returns
    -------
    ndarray
        Complex OTF, Hermitian to the last bit: H(-lag) = conj(H(lag)).

    Raises
    ------
    ParameterError
        If the interpolation is not one of the two.
    DataError
        If a lag is not finite.

    Notes
    -----
    Source: Tantalo 1996, section 4.3 (the two choices of interpolation).
    """
    if interpolation not in INTERPOLATIONS:
        raise ParameterError("interpolation", interpolation, "one of " + ", ".join(INTERPOLATIONS))
    x, y = np.broadcast_arrays(
        np.asarray(lag_x, dtype=np.float64), np.asarray(lag_y, dtype=np.float64)
    )
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise DataError("a lag of the pupil's OTF is not finite")
    reach_y, reach_x = (size // 2 for size in correlation.shape)
    # Cells count away from zero lag, so that opposite lags use the same weights.
    column, part_x = _cell(np.abs(x), reach_x)
    row, part_y = _cell(np.abs(y), reach_y)
    side_x, side_y = np.where(x < 0.0, -1, 1), np.where(y < 0.0, -1, 1)
    framed = np.pad(correlation, 2)

    def corner(down: int | NDArray[np.int64], right: int | NDArray[np.int64]) -> Complexes:
        lag_rows, lag_columns = side_y * (row + down), side_x * (column + right)
        found: Complexes = framed[lag_rows + reach_y + 2, lag_columns + reach_x + 2]
        return found

    near, far = corner(0, 0), corner(1, 1)
    if interpolation == "bilinear":
        top = near * (1.0 - part_x) + corner(0, 1) * part_x
        bottom = corner(1, 0) * (1.0 - part_x) + far * part_x
        otf: Complexes = top * (1.0 - part_y) + bottom * part_y
        return otf
    across = part_x >= part_y
    third = corner(np.where(across, 0, 1), np.where(across, 1, 0))
    larger, smaller = np.maximum(part_x, part_y), np.minimum(part_x, part_y)
    otf = near * (1.0 - larger) + third * (larger - smaller) + far * smaller
    return np.asarray(otf, dtype=np.complex128)


def _cell(lag: NDArray[np.float64], reach: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Lower corner and fraction of a lag; beyond the array a corner of the zero frame."""
    inside = np.minimum(lag, reach + 1.0)
    lower = np.floor(inside)
    return lower.astype(np.int64), inside - lower
