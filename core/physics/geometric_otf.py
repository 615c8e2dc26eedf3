"""Exact OTF of a geometric exit pupil without wavefront error."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.annular_otf import annular_otf
from core.physics.overlap_area import half_disc_overlap_area
from core.physics.pupil_shapes import PupilShape, vane_direction
from core.physics.strip_overlap import Strip, StripPupil, strip_overlap_area, strip_pupil_area

Floats = NDArray[np.float64]


def geometric_otf(shape: PupilShape, *, lag_x: ArrayLike, lag_y: ArrayLike) -> Floats:
    """OTF of a geometric pupil: the overlap with itself moved, over its own area.

    Parameters
    ----------
    shape : PupilShape
        The pupil.
    lag_x, lag_y : array_like
        Lags across and along [samples], of either sign; they broadcast. For frequencies, wavelength
        times frequency over the size of a pupil sample.

    Returns
    -------
    ndarray
        Real OTF in [0, 1], even in either lag, exactly 1 at zero lag.

    Raises
    ------
    DataError
        If a lag is not finite.

    Notes
    -----
    Closed form in arcs and chords, absolute error near 1e-15. Source: Goodman 2005, Introduction
    to Fourier Optics, eq. 6-31; Tantalo 1996, eqs. 4.15 and 4.16.
    """
    x, y = np.broadcast_arrays(
        np.abs(np.asarray(lag_x, dtype=np.float64)), np.abs(np.asarray(lag_y, dtype=np.float64))
    )
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise DataError("a lag of the pupil's OTF is not finite")
    # In radii, and no further than beyond the diameter, so that no size overflows.
    x, y = (np.minimum(lag, 3.0 * shape.radius) / shape.radius for lag in (x, y))
    hole = shape.inner_radius / shape.radius
    strips = _strips(shape)
    if shape.shape == "half_moon":
        otf = half_disc_overlap_area(radius=1.0, lag_x=x, lag_y=y) / (0.5 * np.pi)
    elif not strips:
        otf = annular_otf(frequency_ratio=np.hypot(x, y) / 2.0, obscuration_ratio=hole)
    else:
        otf = _strip_otf(StripPupil(1.0, hole, strips), x, y)
    return np.where((x == 0.0) & (y == 0.0), 1.0, np.minimum(otf, 1.0))


def _strip_otf(pupil: StripPupil, x: Floats, y: Floats) -> Floats:
    otf = np.zeros(x.shape)
    lag = np.hypot(x, y)
    inside = (lag > 0.0) & (lag < 2.0)
    overlap = strip_overlap_area(pupil=pupil, lag_x=x[inside], lag_y=y[inside])
    otf[inside] = overlap / strip_pupil_area(pupil=pupil)
    return otf


def _strips(shape: PupilShape) -> tuple[Strip, ...]:
    """The shape's bar or vanes, for unit radius; opposite vanes are one bar."""
    if shape.bar_width > 0.0:
        half = shape.bar_width / (2.0 * shape.radius)
        return (Strip(0.0, 1.0, -half, half, False),)
    count = shape.vane_count
    half = shape.vane_width / (2.0 * shape.radius)
    paired = count % 2 == 0
    directions = [
        vane_direction(index=index, count=count) for index in range(count // 2 if paired else count)
    ]
    return tuple(Strip(cos, sin, -half, half, not paired) for cos, sin in directions)
