"""Response of a pixel behind its microlens, over the field."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.checks import all_from_zero, positive, within
from core.physics.optics.tabulated_mtf import tabulated_mtf

Row = tuple[float, ...]
MOST_DEG = 75.0


def microlens_response(
    *,
    tangent: ArrayLike,
    corner: float,
    chief_ray_deg: float,
    matched_deg: float,
    half_response_deg: float = 20.0,
    angles: Row = (),
    values: Row = (),
) -> NDArray[np.float64]:
    """Response to the chief ray, 1 where it meets the microlens as the pixel is made for.

    Both angles grow as rays from one point do: their tangents are in proportion to the height.
    The response is R(δ) of the angle δ between the ray and the one that the microlens is shifted
    for: half at `half_response_deg`, R = 2^(−(δ/δ_half)²), or a measured curve.

    Parameters
    ----------
    tangent : array_like
        Tangent of the field angle, 0 or above; the image height over the focal length.
    corner : float
        The same at the corner of the detector, above 0.
    chief_ray_deg, matched_deg : float
        Angle at the corner of the lens's chief ray, and of that for which the microlenses are
        shifted, from −75 to 75 degrees.
    half_response_deg : float
        Angle δ at which half of the response is left, degrees.
    angles, values : tuple of float
        Measured R over δ in degrees, which rises from 0: a monotone cubic (PCHIP). Beyond the last
        point its value holds. Empty: none.

    Source: Catrysse and Wandell 2002, J. Opt. Soc. Am. A 19, 1610 (pixel vignetting, and
    microlenses shifted for the chief ray).
    """
    height = all_from_zero("tangent", tangent) / positive("corner", corner)
    ray, lens = (
        np.arctan(height * math.tan(math.radians(within(name, angle, -MOST_DEG, MOST_DEG))))
        for name, angle in (("chief_ray_deg", chief_ray_deg), ("matched_deg", matched_deg))
    )
    apart = np.degrees(np.abs(ray - lens))
    if angles:
        apart = np.minimum(apart, angles[-1])
        return np.asarray(tabulated_mtf(frequency=apart, frequencies=angles, values=values))
    half = positive("half_response_deg", half_response_deg, unit="deg")
    return np.asarray(np.exp2(-np.square(apart / half)))
