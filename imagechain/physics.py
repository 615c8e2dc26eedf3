"""Individual formulas from the engine, for use in other programs: ``ic.physics.giqe_oblique(…)``.

Pure functions of numbers or arrays. The unit of a keyword argument is in its name, and each
docstring gives the source. A value out of range raises `imagechain.ParameterError`.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.physics.acquisition.giqe import ObliqueQuality, giqe_3, giqe_4, giqe_5, giqe_oblique
from core.physics.atmosphere.air_path import standard_sun_irradiance
from core.physics.detector.detector_mtf import (
    aperture_mtf,
    diffusion_mtf,
    silicon_absorption_per_um,
)
from core.physics.detector.focal_plane_array import rule_07_A_per_cm2, solid_angle
from core.physics.numerics import positive
from core.physics.optics.overlap_area import annular_otf
from core.physics.radiometry.planck import band_radiance, brightness_temperature, spectral_radiance
from core.physics.sampling.detector_sampling import field_of_view_deg

__all__ = [
    "ObliqueQuality",
    "aperture_mtf",
    "band_radiance",
    "brightness_temperature",
    "diffraction_otf",
    "diffusion_mtf",
    "field_of_view",
    "giqe_3",
    "giqe_4",
    "giqe_5",
    "giqe_oblique",
    "planck_radiance",
    "rule_07",
    "silicon_absorption_per_um",
    "solid_angle",
    "standard_sun_irradiance",
]


def field_of_view(*, pixels: int, pitch_um: float, focal_length_mm: float) -> float:
    """Field of view of a row or column of pixels behind a rectilinear lens.

    Parameters
    ----------
    pixels : int
        Number of pixels in the row or column, above 0.
    pitch_um, focal_length_mm : float
        Pixel pitch and focal length, above 0.

    Returns
    -------
    float
        Field of view, 2·atan(N·p/(2f)), degrees.

    Source: Holst 2008, Electro-Optical Imaging System Performance, chapter 2.
    """
    pitch = positive("pitch_um", pitch_um, unit="µm")
    focal = positive("focal_length_mm", focal_length_mm, unit="mm")
    return field_of_view_deg(pixels=pixels, pixel_mrad=pitch / focal)


def planck_radiance(*, wavelength_um: ArrayLike, temperature_K: ArrayLike) -> Any:
    """Spectral radiance of a black body.

    Parameters
    ----------
    wavelength_um, temperature_K : array_like
        Wavelength and temperature, above 0; the arrays broadcast.

    Returns
    -------
    ndarray
        Spectral radiance, W/m²/sr/µm.

    Source: Planck 1901, with the exact constants of the 2019 SI.
    """
    return spectral_radiance(wavelength_um, temperature_K)


def diffraction_otf(
    *,
    cycles_per_mm: ArrayLike,
    wavelength_um: float,
    f_number: float,
    obscuration_ratio: float = 0.0,
) -> Any:
    """OTF of a diffraction-limited lens with a circular or annular aperture, at one wavelength.

    Parameters
    ----------
    cycles_per_mm : array_like
        Radial spatial frequency in the image, 0 or above.
    wavelength_um, f_number : float
        Wavelength and F-number, above 0.
    obscuration_ratio : float
        Inner diameter divided by outer diameter, 0 to below 1.

    Returns
    -------
    ndarray
        OTF, 1 at zero frequency, and 0 at and above the cutoff 1000/(λF) cycles/mm.

    Source: O'Neill 1956, J. Opt. Soc. Am. 46, 285; erratum 46, 1096.
    """
    wavelength = positive("wavelength_um", wavelength_um, unit="µm")
    cutoff = 1000.0 / (wavelength * positive("f_number", f_number))
    ratio = np.asarray(cycles_per_mm, np.float64) / cutoff
    return annular_otf(frequency_ratio=ratio, obscuration_ratio=obscuration_ratio)


def rule_07(*, cutoff_um: float, detector_K: float) -> float:
    """Dark current density of a good HgCdTe photodiode, by Rule 07.

    Parameters
    ----------
    cutoff_um : float
        Cutoff wavelength of the detector material, µm, above 0.
    detector_K : float
        Temperature of the detector, above 0.

    Returns
    -------
    float
        Dark current density, A/cm².

    Source: Tennant, Lee, Zandian, Piquette and Carmody 2008, J. Electronic Materials 37, 1406.
    """
    return rule_07_A_per_cm2(cutoff_um=cutoff_um, detector_K=detector_K)
