"""Blur from motion during one exposure: a straight smear."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.numerics.scalar_checks import finite, non_negative, positive
from core.physics.numerics.sinc import sinc


def blur_mrad(*, velocity_m_per_s: float, time_s: float, range_m: float) -> float:
    """Angle the scene moves through during one exposure.

    Parameters
    ----------
    velocity_m_per_s : float
        Velocity across the line of sight in m/s, of either sign: platform − image.
    time_s : float
        Integration time in s, zero or above.
    range_m : float
        Distance to the target in m, above zero.

    Returns
    -------
    float
        1000·v·t/range in mrad, with the sign of the velocity.

    Raises
    ------
    ParameterError
        When a value is out of range or the blur is not finite.

    Notes
    -----
    Source: Tantalo 1996, eqs. 4.24-4.35. Erratum: the widths 134, 160 and 201 there are
    cycles/rad, not cycles/mrad: the blur is 1000 times what they give.
    """
    velocity = finite("velocity_m_per_s", velocity_m_per_s, unit="m/s")
    path_m = velocity * non_negative("time_s", time_s, unit="s")
    blur = 1000.0 * path_m / positive("range_m", range_m, unit="m")
    if not math.isfinite(blur):
        raise ParameterError("blur of motion", blur, "a finite angle", unit="mrad")
    return blur


def scan_blur_mrad(*, scan_velocity_mrad_per_s: float, dwell_time_s: float) -> float:
    """Angle a scan moves through during one dwell time.

    Parameters
    ----------
    scan_velocity_mrad_per_s : float
        Angular velocity in mrad/s, of either sign.
    dwell_time_s : float
        Dwell time in s, zero or above.

    Returns
    -------
    float
        v·t in mrad.

    Raises
    ------
    ParameterError
        When a value is out of range or the blur is not finite.

    Notes
    -----
    Source: Tantalo 1996, section 4.4.1 and eq. 4.26.
    """
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    blur = velocity * non_negative("dwell_time_s", dwell_time_s, unit="s")
    return finite("blur of scanning", blur, unit="mrad")


def motion_mtf(*, frequency: ArrayLike, blur_mrad: float) -> NDArray[np.float64]:
    """MTF of a uniform smear along one axis, signed.

    Parameters
    ----------
    frequency : array_like
        Frequencies along this axis in cycles/mrad, any shape, finite.
    blur_mrad : float
        Length of the smear in mrad, of either sign.

    Returns
    -------
    ndarray of float64
        sinc(blur·frequency); exactly 1 everywhere for no blur.

    Raises
    ------
    ParameterError
        When the blur is not finite.

    Notes
    -----
    Source: Tantalo 1996, eqs. 4.26 and 4.31; in x and y the published form is the product.
    """
    width = finite("blur_mrad", blur_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        return sinc(width * np.asarray(frequency, dtype=np.float64))


def line_motion_mtf(
    *, xi: ArrayLike, eta: ArrayLike, blur_x_mrad: float, blur_y_mrad: float
) -> NDArray[np.float64]:
    """MTF of a smear along a straight line in any direction, signed.

    Parameters
    ----------
    xi, eta : array_like
        Frequencies in x and y in cycles/mrad, finite, of shapes that broadcast.
    blur_x_mrad, blur_y_mrad : float
        Components of the smear in mrad, of either sign.

    Returns
    -------
    ndarray of float64
        sinc(bx·xi + by·eta), of the common shape; it does not separate.

    Raises
    ------
    ParameterError
        When a component is not finite.

    Notes
    -----
    Source: Fourier transform of a line of uniform weight. Erratum: Tantalo 1996, eq. 4.31, has the
    product of two sincs, which is a blur over a whole rectangle.
    """
    width_x = finite("blur_x_mrad", blur_x_mrad, unit="mrad")
    width_y = finite("blur_y_mrad", blur_y_mrad, unit="mrad")
    largest = 1e300  # two such opposite terms still add up to a number
    with np.errstate(over="ignore"):
        along_x = np.clip(width_x * np.asarray(xi, dtype=np.float64), -largest, largest)
        along_y = np.clip(width_y * np.asarray(eta, dtype=np.float64), -largest, largest)
    return sinc(along_x + along_y)
