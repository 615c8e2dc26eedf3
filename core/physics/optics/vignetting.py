"""Relative illumination over the field of a lens: natural vignetting and measured curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.checks import all_from_zero
from core.physics.optics.tabulated_mtf import tabulated_mtf

Row = tuple[float, ...]


def relative_illumination(
    *,
    tangent: ArrayLike,
    natural: bool,
    scale: float | None = None,
    heights: Row = (),
    values: Row = (),
    coefficients: Row = (),
) -> NDArray[np.float64]:
    """Illumination of the focal plane, 1 on the axis.

    Parameters
    ----------
    tangent : array_like
        Tangent of the field angle, 0 or above.
    natural : bool
        Whether cos⁴ of the field angle is a factor.
    scale : float, optional
        Makes the height of the tangent: the focal length for mm. None: the height is the field
        angle in degrees.
    heights, values : tuple of float
        Measured curve, a monotone cubic (PCHIP) between its points; the heights rise from 0. Beyond
        the last point its value holds. Empty: none.
    coefficients : tuple of float
        c₁, c₂, … of a factor 1 + c₁h² + c₂h⁴ + …, h the height.

    Source: Kingslake 1983, Optical System Design, chapter 6 (cos⁴ law).
    """
    t = all_from_zero("tangent", tangent)
    light = 1.0 / np.square(1.0 + t * t) if natural else np.ones(t.shape)
    if heights or coefficients:
        height = np.degrees(np.arctan(t)) if scale is None else t * scale
        if heights:
            within = np.minimum(height, heights[-1])
            light *= tabulated_mtf(frequency=within, frequencies=heights, values=values)
        square = height * height
        light *= np.polynomial.polynomial.polyval(square, (1.0, *coefficients))
    return np.asarray(light, np.float64)
