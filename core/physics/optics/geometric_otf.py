"""Exact OTF of a geometric exit pupil without wavefront error."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.optics.annular_otf import annular_otf
from core.physics.optics.overlap_area import half_disc_overlap_area
from core.physics.optics.pupil_shapes import PupilShape, vane_direction
from core.physics.optics.strip_overlap import (
    Strip,
    StripPupil,
    strip_overlap_area,
    strip_pupil_area,
)
from core.physics.optics.strip_sum import strip_sum_area, strips_add_up
from core.physics.optics.tiles import by_tiles

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
    x, y = (np.abs(np.asarray(lag, dtype=np.float64)) for lag in (lag_x, lag_y))
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise DataError("a lag of the pupil's OTF is not finite")
    # In radii, and no further than beyond the diameter, so that no size overflows.
    x, y = (np.minimum(lag, 3.0 * shape.radius) / shape.radius for lag in (x, y))
    hole, strips = shape.inner_radius / shape.radius, _strips(shape)
    if strips:
        return _strip_otf(StripPupil(1.0, hole, strips), x, y)
    if shape.shape == "half_moon":
        return by_tiles(_half_disc_otf, x, y)
    return by_tiles(partial(_annular_otf, hole), x, y)


def _half_disc_otf(x: Floats, y: Floats) -> Floats:
    otf = half_disc_overlap_area(radius=1.0, lag_x=x, lag_y=y) / (0.5 * np.pi)
    return np.where((x == 0.0) & (y == 0.0), 1.0, np.minimum(otf, 1.0))


def _annular_otf(hole: float, x: Floats, y: Floats) -> Floats:
    return annular_otf(frequency_ratio=0.5 * np.sqrt(x * x + y * y), obscuration_ratio=hole)


def _strip_otf(pupil: StripPupil, x: Floats, y: Floats) -> Floats:
    whole = strip_pupil_area(pupil=pupil)
    if not strips_add_up(pupil=pupil):
        otf = by_tiles(_otf_outside_lens, x, y)
        left = np.isnan(otf)
        x, y = (np.broadcast_to(lag, otf.shape)[left] for lag in (x, y))
        area = strip_overlap_area(pupil=pupil, lag_x=x, lag_y=y)
        otf[left] = np.minimum(area / whole, 1.0)
        return otf
    # The few lags that take long are done together.
    otf = by_tiles(partial(_sum_otf, pupil, whole, complete=False), x, y)
    left = np.isnan(otf)
    if left.any():
        x, y = (np.broadcast_to(lag, otf.shape)[left] for lag in (x, y))
        otf[left] = by_tiles(partial(_sum_otf, pupil, whole, complete=True), x, y)
    return otf


def _otf_outside_lens(x: Floats, y: Floats) -> Floats:
    """1 at zero lag, 0 beyond the diameter, NaN between."""
    square = x * x + y * y
    return np.where(square < 4.0, np.where(square == 0.0, 1.0, np.nan), 0.0)


def _sum_otf(pupil: StripPupil, whole: float, x: Floats, y: Floats, *, complete: bool) -> Floats:
    square = x * x + y * y
    if square.min() >= 4.0:
        return np.zeros(square.shape)
    area = strip_sum_area(pupil=pupil, lag_x=x, lag_y=y, complete=complete)
    otf = np.where(square < 4.0, np.minimum(area / whole, 1.0), 0.0)
    otf[square == 0.0] = 1.0
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
