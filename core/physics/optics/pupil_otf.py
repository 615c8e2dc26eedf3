"""OTF of a pupil in angular frequency, for one wavelength or a band."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.numerics.scalar_checks import positive
from core.physics.optics.annular_otf import annular_otf
from core.physics.optics.defocus_otf import defocus_otf
from core.physics.optics.geometric_otf import geometric_otf
from core.physics.optics.pupil_shapes import PupilShape
from core.physics.optics.sampled_otf import sampled_otf
from core.physics.optics.tiles import by_tiles

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

    Raises
    ------
    ParameterError
        For a size out of range.

    Notes
    -----
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
    """OTF of a disc or annulus without wavefront error, exact.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad.
    diameter_mm, obscuration_ratio : float
        Outer diameter, and the inner diameter over it.
    wavelengths_um, weights : tuple of float
        Wavelengths of the band and their weights, which sum to 1.

    Returns
    -------
    ndarray of float64

    Raises
    ------
    ParameterError
        For a size out of range.

    Notes
    -----
    Source: as `geometric_pupil_otf`; Tantalo 1996, appendix E.
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
    """OTF of a clear circular pupil with defocus, exact (Hopkins 1955).

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad.
    diameter_mm : float
        Diameter of the pupil.
    w20_waves, reference_um : float
        Defocus at the rim in waves of the reference wavelength.
    wavelengths_um, weights : tuple of float
        Wavelengths of the band and their weights, which sum to 1.

    Returns
    -------
    ndarray of float64
        Real and signed.

    Raises
    ------
    ParameterError
        For a size, wavelength or defocus out of range.
    """
    rho = np.asarray(rho, np.float64)
    diameter = positive("diameter_mm", diameter_mm, unit="mm")
    reference = positive("reference_um", reference_um, unit="µm")
    return _over_band(
        (
            defocus_otf(
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
    """OTF of a sampled pupil from its autocorrelation.

    Parameters
    ----------
    xi, eta : array_like
        Angular frequencies, cycles/mrad; they broadcast.
    correlations : tuple of ndarray
        Normalised autocorrelations: one for all wavelengths where there is no wavefront error
        (the OTF then depends on λ·xi only), else one for each wavelength.
    pitch_x_mm, pitch_y_mm : float
        Size of one pupil sample.
    wavelengths_um, weights : tuple of float
        Wavelengths of the band and their weights, which sum to 1.
    interpolation : str
        "linear" or "bilinear".
    real : bool
        Whether the pupil is real, and with it the OTF.

    Returns
    -------
    ndarray, float64 or complex128
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
