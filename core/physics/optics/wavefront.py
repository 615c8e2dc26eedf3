"""Wavefront errors: Zernike polynomials in Noll's order, and maps from a file."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError

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
    radial = (-1) ** depth * scipy.special.eval_jacobi(depth, order, 0, 1.0 - 2.0 * (x * x + y * y))
    azimuthal = (x + 1j * y) ** order
    part = azimuthal.imag if m < 0 else azimuthal.real
    scale = math.sqrt(n + 1) if m == 0 else math.sqrt(2 * (n + 1))
    value: NDArray[np.float64] = scale * radial * part
    return value


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
    if not math.isfinite(defocus_waves):
        raise ParameterError("defocus_waves", defocus_waves, "a finite number", unit="waves")
    waves = np.zeros(np.broadcast_shapes(x.shape, y.shape)) + defocus_waves * (x * x + y * y)
    for index, coefficient in enumerate(coefficients_waves, start=1):
        if not math.isfinite(coefficient):
            name = f"coefficients_waves[{index}]"
            raise ParameterError(name, coefficient, "a finite number", unit="waves")
        if coefficient != 0.0:
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
        raise DataError(f"a wavefront map of shape {values.shape}; allowed: (rows, columns)")
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
