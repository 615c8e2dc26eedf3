"""Every test scene: drawn at once, or as the shares of its surfaces; in one band or in many.

A scene is Σ_k a_k(x, y)·s_k(λ), with the shares a_k of its surfaces and textures and their spectra
s_k, so that no band need be drawn by itself and no cube is ever in memory.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from core.machine import ForEach, in_turn
from core.scratch import Empty
from nodes.scenes.airfield import airfield
from nodes.scenes.coverage import FloatArray, Radiances
from nodes.scenes.dormitory import dormitory
from nodes.scenes.scene_canvas import with_textures
from nodes.scenes.scene_layers import Layers, layers_of, mean_shares
from nodes.scenes.scene_targets import draw_target
from nodes.scenes.spectral_surfaces import (
    Emissivity,
    surface_radiance,
    surface_spectra,
    target_radiance,
    target_spectra,
)

DRAWN = {"dormitory": dormitory, "airfield": airfield}
"""Scenes of many surfaces; all others are a black target on a black background."""

MOST_SAMPLES = 1280 * 1024
"""Larger scenes are drawn at once."""

GEOMETRY: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "dormitory": (),
        "airfield": (),
        "slanted_edge": ("angle_deg",),
        "siemens_star": ("frequency",),
    }
)
"""Scenes drawn in two steps, and the parameters beside the size that place their surfaces."""

Shares = Layers | npt.NDArray[np.floating]
"""Of every surface, or of the signal against the background."""

Spectra = Mapping[str, FloatArray]
"""Of every surface and texture, or of background and signal: (bands,), W m⁻² sr⁻¹ µm⁻¹."""


def scene_radiances(*, kind: str, **sources: float) -> Radiances:
    """Radiance of each of a scene's surfaces, or of background and signal; see `draw_scene`."""
    if kind in DRAWN:
        return surface_radiance(**sources)
    return dict(zip(("background", "signal"), target_radiance(**sources), strict=True))


def draw_scene(
    *,
    kind: str,
    cut_on_um: float,
    cut_off_um: float,
    temperature_K: float,
    delta_K: float,
    **drawing: Any,
) -> npt.NDArray[np.floating]:
    """Band radiance of a test scene, averaged over each sample's area [W m⁻² sr⁻¹].

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    cut_on_um, cut_off_um : float
        Band [µm].
    temperature_K, delta_K : float
        Background [K] and how much warmer the target is [K]. All targets are black; the
        dormitory and the airfield have surfaces of many temperatures and emissivities, in steps
        of delta_K.
    **drawing
        As for `draw_radiances`.
    """
    radiances = scene_radiances(
        kind=kind,
        cut_on_um=cut_on_um,
        cut_off_um=cut_off_um,
        temperature_K=temperature_K,
        delta_K=delta_K,
    )
    return draw_radiances(radiances, kind=kind, **drawing)


def draw_radiances(
    radiances: Radiances,
    *,
    kind: str,
    width: int,
    height: int,
    angle_deg: float,
    frequency: float,
    dtype: npt.DTypeLike,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> npt.NDArray[np.floating]:
    """A test scene of these radiances.

    Parameters
    ----------
    radiances : mapping of str to float
        Of every surface, of those in `DRAWN`, and perhaps the strengths of their textures; else of
        `background` and `signal`. The picture is linear in all of them.
    width, height : int
        Samples across and down.
    angle_deg : float
        Direction from +x towards +y: the normal of the slanted edge, and along which the
        sinusoid varies [deg].
    frequency : float
        Cycles across the frame's width (sine) or shorter side (coarsest four-bar target), or
        the number of spokes (siemens_star).
    dtype : dtype
        float32 or float64; the sums are in double either way.
    for_each, empty : callable
        Draws some rows at a time, perhaps in threads; makes the array, perhaps on disk.
    """
    how: dict[str, Any] = {
        "width": width,
        "height": height,
        "dtype": dtype,
        "for_each": for_each,
        "empty": empty,
    }
    if kind in DRAWN:
        return DRAWN[kind]().render(radiances, **how)
    two: dict[str, Any] = {name: radiances[name] for name in ("background", "signal")}
    return draw_target(kind, **two, angle_deg=angle_deg, frequency=frequency, **how)


# In two steps: where each surface is seen, which is kept, then how bright they are.
#
# An edit of a temperature then takes a small part of the drawing's time. Scenes that are drawn as
# fast as that are drawn at once. So are large ones: their shares would take much memory, about 20
# bytes a sample in single precision, and twice the time of a picture that is looked at only once.


def in_two_steps(*, kind: str, width: int, height: int) -> bool:
    """Whether a scene is drawn so."""
    return kind in GEOMETRY and width * height <= MOST_SAMPLES


def draw_shares(
    *,
    kind: str,
    width: int,
    height: int,
    dtype: npt.DTypeLike,
    for_each: ForEach = in_turn,
    **geometry: Any,
) -> Shares:
    """Share of each sample's area that shows each surface; `geometry` is what `GEOMETRY` names."""
    if kind in DRAWN:
        return layers_of(DRAWN[kind](), width=width, height=height, dtype=dtype)
    size: dict[str, Any] = {"width": width, "height": height, "dtype": dtype, "for_each": for_each}
    return draw_target(kind, **size, background=0.0, signal=1.0, **geometry)


def show_radiances(
    shares: Shares, radiances: Radiances, for_each: ForEach = in_turn
) -> npt.NDArray[np.floating]:
    """The picture of these radiances, as `draw_radiances`, but for rounding."""
    if isinstance(shares, Layers):
        return shares.picture(radiances, for_each)
    background, signal = radiances["background"], radiances["signal"]
    picture: npt.NDArray[np.floating] = shares * (signal - background)
    picture += background
    return picture


# In bands of wavelength: each sum of bands is the scene of the surfaces' sums.


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
    """Spectra of all that a scene is made of, in so many bands of equal width.

    A texture's strength follows in every band from the radiances there, as it does without bands
    from those of the whole band. `emissivity` and `sun_elevation_deg`, as for `surface_spectra`,
    change nothing in the scenes of black targets.
    """
    kelvins = {"temperature_K": temperature_K, "delta_K": delta_K}
    edges = band_edges(cut_on_um=cut_on_um, cut_off_um=cut_off_um, bands=bands)
    if kind not in DRAWN:
        background, signal = target_spectra(edges_um=edges, **kelvins)
        return {"background": background, "signal": signal}
    spectra = surface_spectra(
        edges_um=edges, emissivity=emissivity, sun_elevation_deg=sun_elevation_deg, **kelvins
    )
    textures = DRAWN[kind]().textures
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
        drawing = DRAWN[kind]()
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
