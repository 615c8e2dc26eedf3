"""Wavefront maps: where one is known, and what its numbers are in waves."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError

# Waves of the map's wavelength, or µm of optical path, in one of each.
_IN_WAVES = {"waves": 1.0, "rad": 1.0 / (2.0 * math.pi)}
_IN_MICROMETRES = {"um": 1.0, "nm": 1e-3}
UNITS = (*_IN_WAVES, *_IN_MICROMETRES)


def map_scale(unit: str, wavelength_um: float | None) -> tuple[float, float | None]:
    """What a map's numbers are multiplied by, and the wavelength of which they then are waves.

    Parameters
    ----------
    unit : str
        ``waves``, ``rad``, ``um`` or ``nm``.
    wavelength_um : float or None
        Of the map, for waves and rad; None for the mean of whatever band it is used in.

    Returns
    -------
    factor : float
    wavelength_um : float or None
        1 for a path in µm, which is its number of waves of 1 µm.

    Raises
    ------
    ParameterError
        If the unit is none of these.
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
        the outline, on a line where the wavefront changes its sign, stay.

    Returns
    -------
    ndarray of float64
        A map without zeros at its border is known everywhere.

    Raises
    ------
    DataError
        If it is not 2-D, has an infinite sample, or is known nowhere.
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
            "the wavefront map is 0 everywhere or NaN everywhere, and so is known nowhere: give "
            "the aperture by path"
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
