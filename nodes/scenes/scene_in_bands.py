"""Scenes in bands of wavelength: each sum of bands is the scene of the surfaces' sums.

A scene is Σ_k a_k(x, y)·s_k(λ), with the shares a_k of its surfaces and textures and their spectra
s_k, so that no band need be drawn by itself and no cube is ever in memory.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from nodes.scenes.coverage import FloatArray, Radiances, check_radiometry
from nodes.scenes.draw import DRAWN, draw_radiances, drawing_of
from nodes.scenes.scene_canvas import with_textures
from nodes.scenes.scene_layers import Layers, mean_shares
from nodes.scenes.spectral_surfaces import Emissivity, surface_spectra, target_spectra
from nodes.scenes.two_steps import Shares

Spectra = Mapping[str, FloatArray]
"""Of every surface and texture, or of background and signal: (bands,), W m⁻² sr⁻¹ µm⁻¹."""


def band_edges(*, cut_on_um: float, cut_off_um: float, bands: int) -> FloatArray:
    """Where so many bands of equal width end, (bands + 1,) [µm]."""
    return np.linspace(cut_on_um, cut_off_um, bands + 1)


def scene_spectra(
    *,
    kind: str,
    cut_on_um: float,
    cut_off_um: float,
    bands: int,
    temperature_K: float,
    delta_K: float,
    emissivity: Emissivity,
    sun_elevation_deg: float,
) -> dict[str, FloatArray]:
    """Spectra of all that a scene is made of.

    A texture's strength follows in every band from the radiances there, as it does without bands
    from those of the whole band.

    Parameters
    ----------
    kind, cut_on_um, cut_off_um, temperature_K, delta_K
        As for `nodes.scenes.draw.draw_scene`.
    bands : int
        How many, of equal width.
    emissivity, sun_elevation_deg
        As for `surface_spectra`; of the scenes of black targets they change nothing.
    """
    kelvins = {"temperature_K": temperature_K, "delta_K": delta_K}
    check_radiometry(cut_on_um=cut_on_um, cut_off_um=cut_off_um, **kelvins)
    edges = band_edges(cut_on_um=cut_on_um, cut_off_um=cut_off_um, bands=bands)
    if kind not in DRAWN:
        background, signal = target_spectra(edges_um=edges, **kelvins)
        return {"background": background, "signal": signal}
    spectra = surface_spectra(
        edges_um=edges, emissivity=emissivity, sun_elevation_deg=sun_elevation_deg, **kelvins
    )
    textures = drawing_of(kind).textures
    rows = [
        with_textures({name: float(values[band]) for name, values in spectra.items()}, textures)
        for band in range(bands)
    ]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def weighted(spectra: Spectra, weights: tuple[float, ...]) -> Radiances:
    """Weighted sum of the bands of each."""
    factors = np.array(weights)
    return {name: float(values @ factors) for name, values in spectra.items()}


def shown_means(shares: Shares, spectra: Spectra) -> FloatArray:
    """Mean of every band of a scene whose shares are known, (bands,)."""
    if isinstance(shares, Layers):
        return _mean_spectrum(shares.names, shares.means(), spectra)
    return _mean_of_targets(float(np.mean(shares, dtype=np.float64)), spectra)


def drawn_means(
    spectra: Spectra, *, kind: str, width: int, height: int, **how: Any
) -> npt.NDArray[np.float64]:
    """The same of a scene that is drawn anew, with the parameters of `draw_radiances`."""
    if kind in DRAWN:
        drawing = drawing_of(kind)
        return _mean_spectrum(
            drawing.names, mean_shares(drawing, width=width, height=height), spectra
        )
    levels = {"background": 0.0, "signal": 1.0}
    share = draw_radiances(levels, kind=kind, width=width, height=height, **how)
    return _mean_of_targets(float(np.mean(share, dtype=np.float64)), spectra)


def _mean_spectrum(names: tuple[str, ...], shares: FloatArray, spectra: Spectra) -> FloatArray:
    return np.asarray(shares @ np.array([spectra[name] for name in names]))


def _mean_of_targets(share: float, spectra: Spectra) -> FloatArray:
    background = spectra["background"]
    return np.asarray(background + share * (spectra["signal"] - background))
