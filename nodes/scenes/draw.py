"""Every test scene: drawn at once, or as the shares of its surfaces; in one band or in many.

A scene is Σ_k a_k(x, y)·s_k(λ), with the shares a_k of its surfaces and textures and their spectra
s_k, so that no band need be drawn by itself and no cube is ever in memory.
"""

from collections.abc import Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from core.machine import ForEach, in_turn
from core.physics.radiometry.planck import band_radiance
from nodes.scenes.airfield import airfield
from nodes.scenes.coverage import FloatArray
from nodes.scenes.dormitory import dormitory
from nodes.scenes.scene_canvas import (
    Canvas,
    Layers,
    Radiances,
    layers_of,
    mean_shares,
    with_textures,
)
from nodes.scenes.scene_targets import draw_target
from nodes.scenes.spectral_surfaces import Emissivity, surface_radiance, surface_spectra

Kind = Literal[
    "dormitory",
    "airfield",
    "slanted_edge",
    "four_bar",
    "siemens_star",
    "point",
    "sine",
    "two_panel",
    "uniform",
]
KINDS: tuple[Kind, ...] = get_args(Kind)

DRAWN = {"dormitory": dormitory, "airfield": airfield}
"""Scenes of many surfaces; all others are a black target on a black background."""

_LEVELS = ("background", "signal")

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


def scene_radiances(
    *,
    kind: str,
    cut_on_um: float,
    cut_off_um: float,
    temperature_K: float,
    delta_K: float,
    reflectances: tuple[float, float] | None = None,
) -> Radiances:
    """Band radiance of each of a scene's surfaces, or of background and signal [W m⁻² sr⁻¹].

    Targets are black, `delta_K` warmer than a background of `temperature_K`; the scenes of
    `DRAWN` have surfaces of many temperatures and emissivities, in steps of `delta_K`. A target's
    `reflectances`, of background and signal, are given instead of their radiances.
    """
    if reflectances is not None:
        return dict(zip(_LEVELS, reflectances, strict=True))
    ends = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    if kind in DRAWN:
        return surface_radiance(**ends, temperature_K=temperature_K, delta_K=delta_K)
    kelvins = np.array([temperature_K, temperature_K + delta_K])
    levels = band_radiance(**ends, temperature_K=kelvins)
    return dict(zip(_LEVELS, levels.tolist(), strict=True))


def draw_radiances(
    radiances: Radiances, canvas: Canvas, *, kind: str, angle_deg: float, frequency: float
) -> npt.NDArray[np.floating]:
    """A test scene of these radiances, averaged over each sample's area.

    The picture is linear in all radiances, and in the strengths of textures that may be among them.
    `angle_deg` is the direction, from +x towards +y, of the slanted edge's normal and of the
    sinusoid; `frequency` is in cycles across the frame's width (sine) or shorter side (coarsest
    bars), or the number of spokes.
    """
    if kind in DRAWN:
        return DRAWN[kind]().render(radiances, canvas)
    background, signal = radiances["background"], radiances["signal"]
    levels = {"background": background, "signal": signal}
    return draw_target(kind, canvas, **levels, angle_deg=angle_deg, frequency=frequency)


# In two steps: where each surface is seen, which is kept, then how bright they are.
#
# An edit of a temperature then takes a small part of the drawing's time. Scenes that are drawn as
# fast as that are drawn at once. So are large ones: their shares would take much memory, about 20
# bytes a sample in single precision, and twice the time of a picture that is looked at only once.


def in_two_steps(*, kind: str, width: int, height: int) -> bool:
    return kind in GEOMETRY and width * height <= MOST_SAMPLES


def draw_shares(kind: str, canvas: Canvas, **geometry: float) -> Shares:
    """Share of each sample's area that shows each surface; `geometry` is what `GEOMETRY` names."""
    if kind in DRAWN:
        return layers_of(DRAWN[kind](), canvas)
    return draw_target(kind, canvas, background=0.0, signal=1.0, **geometry)


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
    quantity: str = "radiance",
    reflectances: tuple[float, float] | None = None,
) -> dict[str, FloatArray]:
    """Spectra of all that a scene is made of, in so many bands of equal width.

    A texture's strength follows in every band from the radiances there, as it does without bands
    from those of the whole band. `emissivity` and `sun_elevation_deg`, as for `surface_spectra`,
    change nothing in the scenes of targets. `quantity` is `reflectance` for `DRAWN`; targets then
    have the same `reflectances` in all bands.
    """
    kelvins: dict[str, Any] = {"temperature_K": temperature_K, "delta_K": delta_K}
    edges = band_edges(cut_on_um=cut_on_um, cut_off_um=cut_off_um, bands=bands)
    rows: list[Radiances] = []
    if kind in DRAWN:
        spectra = surface_spectra(
            edges_um=edges,
            emissivity=emissivity,
            sun_elevation_deg=sun_elevation_deg,
            reflectance=quantity == "reflectance",
            **kelvins,
        )
        textures = DRAWN[kind]().textures
        for band in range(bands):
            known = {name: float(values[band]) for name, values in spectra.items()}
            rows.append(with_textures(known, textures))
    elif reflectances is not None:
        rows = [dict(zip(_LEVELS, reflectances, strict=True))] * bands
    else:
        for low, high in pairwise(edges.tolist()):
            levels = scene_radiances(kind=kind, cut_on_um=low, cut_off_um=high, **kelvins)
            rows.append({name: level / (high - low) for name, level in levels.items()})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def weighted(spectra: Spectra, weights: tuple[float, ...]) -> Radiances:
    factors = np.array(weights)
    return {name: float(values @ factors) for name, values in spectra.items()}


def shown_means(shares: Shares, spectra: Spectra) -> FloatArray:
    """Mean of every band of a scene whose shares are known, (bands,)."""
    if isinstance(shares, Layers):
        return _of_surfaces(shares.names, shares.means(), spectra)
    background = spectra["background"]
    share = float(np.mean(shares, dtype=np.float64))
    return np.asarray(background + share * (spectra["signal"] - background))


def drawn_means(spectra: Spectra, canvas: Canvas, *, kind: str, **geometry: float) -> FloatArray:
    """The same of a scene that is drawn anew, with the parameters of `draw_radiances`."""
    if kind in DRAWN:
        drawing = DRAWN[kind]()
        return _of_surfaces(drawing.names, mean_shares(drawing, canvas), spectra)
    return shown_means(draw_shares(kind, canvas, **geometry), spectra)


def _of_surfaces(names: tuple[str, ...], shares: FloatArray, spectra: Spectra) -> FloatArray:
    return np.asarray(shares @ np.array([spectra[name] for name in names]))
