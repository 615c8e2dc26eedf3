"""Scenes in two steps: where each surface is seen, which is kept, then how bright they are.

An edit of a temperature then takes a small part of the drawing's time. Scenes that are drawn as
fast as that are drawn at once. So are large ones: their shares would take much memory, about 20
bytes a sample in single precision, and twice the time of a picture that is looked at only once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from core.machine import ForEach, in_turn
from nodes.scenes import scene_targets as targets
from nodes.scenes.coverage import Radiances, check_frame, check_radiometry
from nodes.scenes.draw import DRAWN, drawing_of
from nodes.scenes.scene_layers import Layers, layers_of
from nodes.scenes.spectral_surfaces import surface_radiance, target_radiance

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
    **geometry: float,
) -> Shares:
    """Share of each sample's area that shows each surface.

    Parameters
    ----------
    kind : str
        One of `GEOMETRY`.
    width, height : int
        Samples across and down.
    dtype : dtype
        float32 or float64, of the shares; the sums are in double either way.
    for_each : callable
        Draws some rows at a time, perhaps in threads.
    **geometry
        What `GEOMETRY` names, as for `draw_scene`.
    """
    frame_dtype = check_frame(kind, width, height, dtype)
    if kind in DRAWN:
        return layers_of(drawing_of(kind), width=width, height=height, dtype=frame_dtype)
    draw: Callable[..., targets.Picture] = targets.slanted_edge
    if kind == "siemens_star":
        draw = targets.siemens_star
    size: dict[str, Any] = {
        "width": width,
        "height": height,
        "dtype": frame_dtype,
        "for_each": for_each,
    }
    return draw(**size, background=0.0, signal=1.0, **geometry)


def with_radiance(
    shares: Shares,
    *,
    cut_on_um: float,
    cut_off_um: float,
    temperature_K: float,
    delta_K: float,
    for_each: ForEach = in_turn,
) -> npt.NDArray[np.floating]:
    """Band radiance of a scene from the shares of its surfaces.

    Parameters
    ----------
    shares : Layers or ndarray
        From `draw_shares`.
    cut_on_um, cut_off_um, temperature_K, delta_K : float
        As for `draw_scene`.
    for_each : callable
        Sums some tiles at a time, perhaps in threads.

    Returns
    -------
    ndarray, shape (height, width)
        Radiance [W m⁻² sr⁻¹], of the shares' type: what `draw_scene` draws, but for rounding.
    """
    sources = {
        "cut_on_um": cut_on_um,
        "cut_off_um": cut_off_um,
        "temperature_K": temperature_K,
        "delta_K": delta_K,
    }
    check_radiometry(**sources)
    if isinstance(shares, Layers):
        return show_radiances(shares, surface_radiance(**sources), for_each)
    background, signal = target_radiance(**sources)
    return show_radiances(shares, {"background": background, "signal": signal}, for_each)


def show_radiances(
    shares: Shares, radiances: Radiances, for_each: ForEach = in_turn
) -> npt.NDArray[np.floating]:
    """The picture of these radiances, as `nodes.scenes.draw.draw_radiances` takes them."""
    if isinstance(shares, Layers):
        return shares.picture(radiances, for_each)
    background, signal = radiances["background"], radiances["signal"]
    picture: npt.NDArray[np.floating] = shares * (signal - background)
    picture += background
    return picture
