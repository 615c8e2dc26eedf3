"""Blur from motion during one exposure: a straight smear."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import finite, non_negative, positive
from core.physics.numerics import sinc


def blur_mrad(*, velocity_m_per_s: float, time_s: float, range_m: float) -> float:
    """Angle the scene moves through during one exposure: 1000·v·t/range.

    The velocity is that of the platform less that of the image, of either sign, and gives the sign.

    Source: Tantalo 1996, eqs. 4.24-4.35. Erratum: the widths 134, 160 and 201 there are
    cycles/rad, not cycles/mrad: the blur is 1000 times what they give.
    """
    velocity = finite("velocity_m_per_s", velocity_m_per_s, unit="m/s")
    path_m = velocity * non_negative("time_s", time_s, unit="s")
    blur = 1000.0 * path_m / positive("range_m", range_m, unit="m")
    if not math.isfinite(blur):
        raise ParameterError("motion blur", blur, "a finite angle", unit="mrad")
    return blur


def scan_blur_mrad(*, scan_velocity_mrad_per_s: float, dwell_time_s: float) -> float:
    """Angle a scan moves through in one dwell time (Tantalo 1996, section 4.4.1 and eq. 4.26)."""
    velocity = finite("scan_velocity_mrad_per_s", scan_velocity_mrad_per_s, unit="mrad/s")
    blur = velocity * non_negative("dwell_time_s", dwell_time_s, unit="s")
    return finite("scan blur", blur, unit="mrad")


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


# Mixed sampling of a line scanner: equal angles along the scan, equal ground steps in flight.
#
# Over flat ground the scan lines are as far apart on the ground at every view angle, but the
# farther the ground, the smaller the angle between them. Each column of the frame, seen at one view
# angle, so has a sampling interval of its own in flight, and one transfer function acts on it at
# frequencies of its own.
#
# Source: Tantalo 1996, section 2 and figure 2.3a, which treats the whole frame at one scale and
# leaves the comparison to later work.

Vector = NDArray[np.float64]


def view_angles_rad(*, columns: int, interval_mrad: float, look_angle_rad: float = 0.0) -> Vector:
    """Angle from nadir of each sample of a scan line, whose middle is at the look angle.

    Refused where the scan reaches the horizon.
    """
    step = positive("interval_mrad", interval_mrad, unit="mrad") / 1000.0
    if (columns - 1) * step >= math.pi:
        raise ParameterError(
            "interval_mrad", interval_mrad, f"below {1000 * math.pi / (columns - 1):g}", unit="mrad"
        )
    aside = 0.5 * (columns - 1) * step
    if not abs(look_angle_rad) + aside < 0.5 * math.pi:
        raise ParameterError(
            "look_angle_rad", look_angle_rad, f"within ±{0.5 * math.pi - aside:g}", unit="rad"
        )
    return np.asarray(look_angle_rad + (np.arange(columns) - 0.5 * (columns - 1)) * step)


def line_intervals_mrad(
    *, line_spacing_m: float, altitude_m: float, view_angle_rad: ArrayLike
) -> Vector:
    """Angle between neighbouring scan lines as seen from the sensor, over flat ground.

    1000·spacing/range of the view angles' shape; the range is altitude/cos(view angle).
    """
    spacing = positive("line_spacing_m", line_spacing_m, unit="m")
    altitude = positive("altitude_m", altitude_m, unit="m")
    angle = np.asarray(view_angle_rad, np.float64)
    farthest = float(np.max(np.abs(angle), initial=0.0))
    if not farthest < 0.5 * math.pi:
        raise ParameterError("view_angle_rad", farthest, "within ±π/2", unit="rad")
    return np.asarray(1000.0 * spacing / altitude * np.cos(angle))


def scale_nodes_mrad(*, intervals_mrad: ArrayLike, count: int) -> Vector:
    """Intervals for which whole frames are filtered, so that `scale_weights` can blend them.

    `count` Chebyshev nodes between the smallest and largest of the scales 1/interval.
    """
    scales = 1.0 / np.asarray(intervals_mrad, np.float64)
    middle, reach = 0.5 * (scales.max() + scales.min()), 0.5 * (scales.max() - scales.min())
    nodes = middle + reach * np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return np.asarray(1.0 / nodes)


def scale_weights(*, nodes_mrad: ArrayLike, intervals_mrad: ArrayLike) -> Vector:
    """Weights of whole frames, each filtered at one node's interval, in each column.

    Lagrange's polynomials in the scale 1/interval, shape (nodes, columns); each column adds to 1.

    Source: Trefethen 2013, Approximation Theory and Approximation Practice, chapters 5 and 8: for
    a transfer function smooth in frequency the error falls geometrically with the nodes.
    """
    nodes, scales = (1.0 / np.asarray(one, np.float64) for one in (nodes_mrad, intervals_mrad))
    weights = np.ones((nodes.size, scales.size))
    for index, node in enumerate(nodes):
        for other in np.delete(nodes, index):
            weights[index] *= (scales - other) / (node - other)
    return weights
