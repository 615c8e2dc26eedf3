"""How bright the surfaces are in bands of wavelength: what they emit, and mirror of sky and Sun."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.physics.radiometry.coarse_spectrum import CoarseSpectrum, mean_by_planck
from core.physics.radiometry.planck import band_radiance
from core.physics.radiometry.sunlight import SUNLIGHT_K, white_surface_radiance
from nodes.scenes.surfaces.material_spectra import MATERIAL_OF, MATERIALS, SHADED, SKY
from nodes.scenes.surfaces.scene_materials import ALIKE, SURFACES, surface_temperatures

FloatArray = NDArray[np.float64]
Emissivity = Literal["spectra", "grey"]


def surface_spectra(
    *,
    edges_um: FloatArray,
    temperature_K: float,
    delta_K: float,
    emissivity: Emissivity,
    sun_elevation_deg: float,
) -> dict[str, FloatArray]:
    """Spectral radiance of every surface, the mean over each band.

    L = ε·L(T) + (1 − ε)·(L_sky + L_sun), where L_sky is the zenith's and L_sun that of a level,
    white, matt surface in the Sun. Every surface is lit as level ground is; those in the shade see
    the sky alone. ε is the mean over the band by the light in question.

    Parameters
    ----------
    edges_um : ndarray, (bands + 1,)
        Where the bands end [µm], ascending.
    temperature_K, delta_K : float
        As for `surface_radiance`.
    emissivity : "spectra" or "grey"
        Those of `MATERIALS`, or one number a surface, as without bands.
    sun_elevation_deg : float
        0 for no Sun.

    Returns
    -------
    dict of str to ndarray
        (bands,) by surface name [W m⁻² sr⁻¹ µm⁻¹].

    Raises
    ------
    ParameterError
        If delta_K puts a surface at or below 0 K, or a number is out of range.
    """
    warm = surface_temperatures(temperature_K=temperature_K, delta_K=delta_K)
    names = [*SURFACES, *ALIKE]
    kelvins = np.array([*warm, *(warm[names.index(other)] for other in ALIKE.values())])
    sky_K = float(kelvins[names.index("zenith")])
    groups = _groups(emissivity)
    zenith = next(one for one, places in groups if names.index("zenith") in places)
    mirrors = np.array([name not in SKY for name in names])
    lit = np.array([name not in SHADED for name in names])
    spectra = np.empty((len(names), len(edges_um) - 1))
    for band, (low, high) in enumerate(pairwise(edges_um.tolist())):
        ends = {"cut_on_um": low, "cut_off_um": high}
        own = band_radiance(temperature_K=np.array([*kelvins, sky_K]), **ends)
        sun = white_surface_radiance(sun_elevation_deg=sun_elevation_deg, **ends)
        # Shares that are reflected: of a surface's own light, of light as the sky's and the Sun's,
        # and of that as much as the sky itself reflects.
        once, twice = np.empty((3, len(names))), np.empty((2, len(names)))
        for spectrum, places in groups:
            lights = np.array([*kelvins[places], sky_K, SUNLIGHT_K])
            means = mean_by_planck(spectrum, temperature_K=lights, **ends)
            once[0, places], once[1:, places] = means[:-2], means[-2:, None]
            means = mean_by_planck(spectrum, zenith, temperature_K=lights[-2:], **ends)
            twice[:, places] = means[:, None]
        light = (1.0 - once[0]) * own[:-1] + once[2] * sun * lit
        light += ((once[1] - twice[0]) * own[-1] + twice[1] * sun) * mirrors
        spectra[:, band] = light / (high - low)
    return dict(zip(names, spectra, strict=True))


def target_spectra(
    *, edges_um: FloatArray, temperature_K: float, delta_K: float
) -> tuple[FloatArray, FloatArray]:
    """Spectral radiance of a black background and of a black target, the mean over each band."""
    kelvins = np.array([temperature_K, temperature_K + delta_K])
    bands = [
        band_radiance(cut_on_um=low, cut_off_um=high, temperature_K=kelvins) / (high - low)
        for low, high in pairwise(edges_um.tolist())
    ]
    background, signal = np.array(bands).T
    return background, signal


def _groups(emissivity: Emissivity) -> list[tuple[CoarseSpectrum, list[int]]]:
    """Reflectances, each with the places of the surfaces that have it."""
    groups: dict[CoarseSpectrum, list[int]] = {}
    for place, name in enumerate((*SURFACES, *ALIKE)):
        spectrum = MATERIALS[MATERIAL_OF[name]]
        if emissivity == "grey":
            _, grey = SURFACES[ALIKE.get(name, name)]
            spectrum = CoarseSpectrum(((1.0, 1.0 - grey),))
        groups.setdefault(spectrum, []).append(place)
    return list(groups.items())
