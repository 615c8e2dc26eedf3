"""OTF of a pupil in angular frequency, for one wavelength or a band."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.checks import positive
from core.physics.optics.diffraction_otf import annular_defocus_otf
from core.physics.optics.overlap_area import annular_otf, half_disc_overlap_area
from core.physics.optics.pupil_shapes import PupilShape, by_tiles, vane_direction
from core.physics.optics.sampled_otf import sampled_otf
from core.physics.optics.strip_overlap import (
    Strip,
    StripPupil,
    strip_overlap_area,
    strip_pupil_area,
)
from core.physics.optics.strip_sum import strip_sum_area, strips_add_up

Array = NDArray[Any]


def geometric_pupil_otf(
    *,
    xi: ArrayLike,
    eta: ArrayLike,
    shape: PupilShape,
    pitch_x_mm: float,
    pitch_y_mm: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
) -> Array:
    """OTF of a geometric pupil without wavefront error, exact.

    Parameters
    ----------
    xi, eta : array_like
        Angular frequencies across and along, cycles/mrad; they broadcast.
    shape : PupilShape
        The pupil, lengths in samples.
    pitch_x_mm, pitch_y_mm : float
        Size of one pupil sample; unequal ones turn circles into ellipses.
    wavelengths_um, weights : tuple of float
        Wavelengths of the band and their weights, which sum to 1.

    Returns
    -------
    ndarray of float64
        Σ w·γ(λ·xi/pitch_x, λ·eta/pitch_y), γ the normalised autocorrelation of the pupil.

    Source: Tantalo 1996, eqs. 4.13 to 4.19 (after Gaskill 1979), with λ in µm times cycles/mrad
    giving the lag in mm. Erratum: the cutoff 12.8 cycles/mrad of eq. 4.21 is that of the array's
    half width; the aperture's is its diameter over the wavelength.
    """
    xi, eta = np.asarray(xi, np.float64), np.asarray(eta, np.float64)
    x_mm = positive("pitch_x_mm", pitch_x_mm, unit="mm")
    y_mm = positive("pitch_y_mm", pitch_y_mm, unit="mm")
    return _over_band(
        (
            geometric_otf(shape, lag_x=wavelength * xi / x_mm, lag_y=wavelength * eta / y_mm)
            for wavelength in wavelengths_um
        ),
        weights,
    )


def circular_pupil_otf(
    *,
    rho: ArrayLike,
    diameter_mm: float,
    obscuration_ratio: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
) -> Array:
    """OTF of a disc or annulus without wavefront error at radial frequencies, cycles/mrad; exact.

    The band as of `geometric_pupil_otf`. Source: as there; Tantalo 1996, appendix E.
    """
    diameter = positive("diameter_mm", diameter_mm, unit="mm")

    def tile(rho: Array) -> Array:
        return _over_band(
            (
                annular_otf(
                    frequency_ratio=wavelength * rho / diameter,
                    obscuration_ratio=obscuration_ratio,
                )
                for wavelength in wavelengths_um
            ),
            weights,
        )

    return by_tiles(tile, np.asarray(rho, np.float64))


def defocused_disc_otf(
    *,
    rho: ArrayLike,
    diameter_mm: float,
    w20_waves: float,
    reference_um: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
) -> Array:
    """OTF of a clear circular pupil with defocus, at radial frequencies in cycles/mrad, exact.

    Real and signed; `w20_waves` is at the rim, in waves of the reference wavelength. The band as of
    `geometric_pupil_otf`. Source: as `annular_defocus_otf`.
    """
    rho = np.asarray(rho, np.float64)
    diameter = positive("diameter_mm", diameter_mm, unit="mm")
    reference = positive("reference_um", reference_um, unit="µm")
    return _over_band(
        (
            annular_defocus_otf(
                frequency_ratio=wavelength * rho / diameter,
                w20_waves=w20_waves * reference / wavelength,
            )
            for wavelength in wavelengths_um
        ),
        weights,
    )


def sampled_pupil_otf(
    *,
    xi: ArrayLike,
    eta: ArrayLike,
    correlations: tuple[Array, ...],
    pitch_x_mm: float,
    pitch_y_mm: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
    interpolation: str,
    real: bool,
) -> Array:
    """OTF of a sampled pupil from its normalised autocorrelation.

    There is one for all wavelengths where there is no wavefront error (the OTF then depends on λ·xi
    only), else one for each wavelength. `interpolation` is "linear" or "bilinear"; `real` says that
    the pupil is real, and with it the OTF. Else as `geometric_pupil_otf`.
    """
    xi, eta = np.asarray(xi, np.float64), np.asarray(eta, np.float64)
    if real:
        correlations = tuple(np.real(correlation) for correlation in correlations)
    return _over_band(
        (
            sampled_otf(
                correlations[min(index, len(correlations) - 1)],
                lag_x=wavelength * xi / pitch_x_mm,
                lag_y=wavelength * eta / pitch_y_mm,
                interpolation=interpolation,
            )
            for index, wavelength in enumerate(wavelengths_um)
        ),
        weights,
    )


def _over_band(otfs: Iterable[Array], weights: tuple[float, ...]) -> Array:
    """Weighted sum, in order: the weights then add up to exactly 1 at zero frequency."""
    total: Array | float = 0.0
    for otf, weight in zip(otfs, weights, strict=True):
        total = total + weight * otf
    return np.asarray(total)


# Exact OTF of a geometric exit pupil without wavefront error.

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
        Real OTF in [0, 1], even in either lag, exactly 1 at zero lag; absolute error near 1e-15.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-31; Tantalo 1996, eqs. 4.15 and
    4.16; closed form in arcs and chords.
    """
    x, y = (np.abs(np.asarray(lag, dtype=np.float64)) for lag in (lag_x, lag_y))
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise DataError("the pupil's OTF is needed at a lag that is not finite")
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
    if strips_add_up(pupil=pupil):
        return by_tiles(partial(_sum_otf, pupil, whole), x, y)
    x, y = np.broadcast_arrays(x, y)
    square = x * x + y * y
    otf = np.where(square == 0.0, 1.0, 0.0)
    apart = (square > 0.0) & (square < 4.0)
    area = strip_overlap_area(pupil=pupil, lag_x=x[apart], lag_y=y[apart])
    otf[apart] = np.minimum(area / whole, 1.0)
    return otf


def _sum_otf(pupil: StripPupil, whole: float, x: Floats, y: Floats) -> Floats:
    square = x * x + y * y
    if square.min() >= 4.0:
        return np.zeros(square.shape)
    area = strip_sum_area(pupil=pupil, lag_x=x, lag_y=y)
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
