"""Wavefront errors: Zernike polynomials in Noll's order, and maps from a file."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core import kernels
from core.arrays import Array, Complex
from core.errors import DataError, ParameterError
from core.kernels import special
from core.physics.numerics import finite

HIGHEST_NOLL_INDEX = 861  # 40 radial orders; beyond, samples of a pupil do not resolve them


def noll_order(*, noll_index: int) -> tuple[int, int]:
    """Radial order n and signed azimuthal order m (negative: sine) of Noll's index."""
    if not 1 <= noll_index <= HIGHEST_NOLL_INDEX:
        raise ParameterError("noll_index", noll_index, f"1 to {HIGHEST_NOLL_INDEX}")
    n = (math.isqrt(8 * noll_index - 7) - 1) // 2
    place = noll_index - n * (n + 1) // 2 - 1
    m = 2 * ((place + 1) // 2) if n % 2 == 0 else 2 * (place // 2) + 1
    return n, m if noll_index % 2 == 0 else -m


def zernike(*, noll_index: int, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
    """Zernike polynomial of unit rms over the unit disc.

    Parameters
    ----------
    noll_index : int
        Noll's index: 1 piston, 2 and 3 tilts in x and y, 4 defocus, 5 and 6 astigmatisms,
        7 and 8 comas, 11 spherical aberration.
    x, y : array_like
        Position over the pupil's radius; they broadcast. Outside the disc the polynomial goes on.

    Returns
    -------
    ndarray
        Value, dimensionless.

    Source: Noll 1976, JOSA 66, 207, eqs. 1 and 2; the radial part as a Jacobi polynomial, whose
    recurrence does not cancel as Noll's sum of factorials does.
    """
    n, m = noll_order(noll_index=noll_index)
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    order = abs(m)
    depth = (n - order) // 2
    radial = (-1) ** depth * special("eval_jacobi")(depth, order, 0, 1.0 - 2.0 * (x * x + y * y))
    azimuthal = (x + 1j * y) ** order
    part = azimuthal.imag if m < 0 else azimuthal.real
    scale = math.sqrt(n + 1) if m == 0 else math.sqrt(2 * (n + 1))
    return np.asarray(scale * radial * part)


def wavefront_waves(
    *,
    x: ArrayLike,
    y: ArrayLike,
    coefficients_waves: Sequence[float] = (),
    defocus_waves: float = 0.0,
) -> NDArray[np.float64]:
    """Wavefront error of a pupil in waves, from Zernike coefficients and Seidel defocus.

    x and y are over the pupil's radius and broadcast; the coefficients are in Noll's order from j =
    1 (piston) on, in waves rms. `defocus_waves` is W20, the defocus at the rim: W = W20 (x² + y²).
    """
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    w20 = finite("defocus_waves", defocus_waves, unit="waves")
    waves = np.zeros(np.broadcast_shapes(x.shape, y.shape)) + w20 * (x * x + y * y)
    for index, coefficient in enumerate(coefficients_waves, start=1):
        if finite(f"coefficients_waves[{index}]", coefficient, unit="waves") != 0.0:
            waves += coefficient * zernike(noll_index=index, x=x, y=y)
    return np.asarray(waves, dtype=np.float64)


# Wavefront maps: where one is known, and what its numbers are in waves.

# Waves of the map's wavelength, or µm of optical path, in one of each.
_IN_WAVES = {"waves": 1.0, "rad": 1.0 / (2.0 * math.pi)}
_IN_MICROMETRES = {"um": 1.0, "nm": 1e-3}
UNITS = (*_IN_WAVES, *_IN_MICROMETRES)


def map_scale(unit: str, wavelength_um: float | None) -> tuple[float, float | None]:
    """What a map's numbers are multiplied by, and the wavelength of which they then are waves.

    The unit is ``waves``, ``rad``, ``um`` or ``nm``. The wavelength is of the map, for waves and
    rad; None for the mean of whatever band it is used in. It is 1 for a path in µm, which is its
    number of waves of 1 µm.
    """
    if unit in _IN_WAVES:
        return _IN_WAVES[unit], wavelength_um
    if unit not in _IN_MICROMETRES:
        raise ParameterError("unit", unit, "one of " + ", ".join(UNITS))
    return _IN_MICROMETRES[unit], 1.0


def known_wavefront(samples: ArrayLike) -> NDArray[np.float64]:
    """A wavefront map with NaN wherever it is not known.

    Parameters
    ----------
    samples : array_like, shape (rows, columns)
        NaN outside the aperture, as interferometers write it; or, where no sample is NaN, zeros
        from the border of the array up to the aperture, as lens design programs do. Zeros within
        the outline, on a line where the wavefront changes its sign, stay. A map without zeros at
        its border is known everywhere.
    """
    values = np.array(samples, np.float64)
    if values.ndim != 2 or values.size == 0:
        raise DataError(
            f"the wavefront map has shape {values.shape}; it must be two-dimensional "
            "(rows, columns) and not empty"
        )
    if np.isinf(values).any():
        row, column = np.argwhere(np.isinf(values))[0]
        raise DataError(f"the wavefront map is infinite at row {row}, column {column}")
    if not np.isnan(values).any():
        empty = values == 0.0
        # Clear to a border across and to one along: of a convex outline all that is outside.
        values[_clear(empty, 1) & _clear(empty, 0)] = np.nan
    if np.isnan(values).all():
        raise DataError(
            "the wavefront map is 0 or NaN everywhere, so the aperture is unknown: set path to an "
            "aperture file"
        )
    return values


def wrapped_waves(amplitude: ArrayLike) -> NDArray[np.float64]:
    """Wavefront of a complex amplitude transmission, waves, modulo 1 between ±1/2."""
    return np.asarray(np.angle(np.asarray(amplitude, np.complex128)) / (2.0 * np.pi), np.float64)


def _clear(empty: NDArray[np.bool_], axis: int) -> NDArray[np.bool_]:
    """Where all is empty up to the first or to the last sample along an axis."""
    up = np.logical_and.accumulate(empty, axis=axis)
    back = np.flip(np.logical_and.accumulate(np.flip(empty, axis), axis=axis), axis)
    return np.asarray(up | back)


# OTF of a sampled exit pupil: autocorrelation, interpolation and an estimate of the error.

Indices = NDArray[np.int64]
INTERPOLATIONS = ("linear", "bilinear")


def complex_pupil(*, transmission: ArrayLike, wavefront_waves: ArrayLike = 0.0) -> Complex:
    """Amplitude transmission of a pupil with a wavefront error in waves: t · exp(2πi W).

    The wavefront is of the same shape or a scalar, and ignored where nothing is transmitted.
    """
    amplitude = np.asarray(transmission, dtype=np.float64)
    waves = np.where(amplitude != 0.0, np.asarray(wavefront_waves, dtype=np.float64), 0.0)
    return np.asarray(amplitude * np.exp(2j * np.pi * waves), dtype=np.complex128)


def autocorrelation(pupil: ArrayLike, *, workers: int | None = None) -> Complex:
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
    padded = tuple(kernels.next_fast_len(size) for size in shape)
    spectrum = kernels.fft2(samples, padded, workers=workers)
    power = spectrum.real**2 + spectrum.imag**2
    raw = kernels.ifft2(power, workers=workers, overwrite_x=True)
    lags_y, lags_x = np.arange(1 - rows, rows), np.arange(1 - columns, columns)
    raw = raw[np.ix_(lags_y, lags_x)]
    raw = 0.5 * (raw + np.conj(raw[::-1, ::-1]))
    raw /= np.sum(np.abs(samples) ** 2)
    if not np.any(samples.imag):
        raw.imag = 0.0
    raw[rows - 1, columns - 1] = 1.0
    return np.asarray(raw, dtype=np.complex128)


def _checked(pupil: ArrayLike) -> Complex:
    samples: Complex = np.asarray(pupil, dtype=np.complex128)
    if samples.ndim != 2 or samples.size == 0:
        raise DataError(
            f"the pupil has shape {samples.shape}; it must be two-dimensional (rows, columns) and "
            "not empty"
        )
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
        raise DataError("the pupil's OTF was requested at a lag that is not finite")
    height, width = correlation.shape
    near_x, far_x, part_x = _beside(x, width // 2)
    near_y, far_y, part_y = _beside(y, height // 2)

    def at(row: Indices, column: Indices) -> Array:
        inside = ((row >= 0) & (row < height)) & ((column >= 0) & (column < width))
        known = correlation[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)]
        return np.where(inside, known, 0.0)

    nearest, farthest = at(near_y, near_x), at(far_y, far_x)
    if interpolation == "bilinear":
        top = nearest * (1.0 - part_x) + at(near_y, far_x) * part_x
        bottom = at(far_y, near_x) * (1.0 - part_x) + farthest * part_x
        return np.asarray(top * (1.0 - part_y) + bottom * part_y)
    third = np.where(part_x >= part_y, at(near_y, far_x), at(far_y, near_x))
    larger, smaller = np.maximum(part_x, part_y), np.minimum(part_x, part_y)
    return np.asarray(nearest * (1.0 - larger) + third * (larger - smaller) + farthest * smaller)


def _beside(lag: NDArray[np.float64], reach: int) -> tuple[Indices, Indices, NDArray[np.float64]]:
    """Places of the two integer lags that each lag lies between, and how far it is from the first.

    Counted away from zero lag, so that opposite lags use the same weights.
    """
    inside = np.minimum(np.abs(lag), reach + 1.0)
    lower = np.floor(inside)
    side, index = np.where(lag < 0.0, -1, 1), lower.astype(np.int64)
    return reach + side * index, reach + side * (index + 1), inside - lower
