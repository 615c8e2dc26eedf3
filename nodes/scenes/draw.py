"""One entry to every test scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from core.scratch.allocation import Empty
from core.threads import ForEach, in_turn
from nodes.scenes import scene_targets as targets
from nodes.scenes.airfield import airfield
from nodes.scenes.checks import check_frame, check_geometry, check_radiometry
from nodes.scenes.dormitory import dormitory
from nodes.scenes.mixes import Radiances
from nodes.scenes.scene_canvas import Drawing
from nodes.scenes.surfaces.scene_materials import surface_radiance, target_radiance

DRAWN = ("dormitory", "airfield")
"""Scenes of many surfaces; all others are a black target on a black background."""


def draw_scene(
    *,
    kind: str,
    width: int,
    height: int,
    cut_on_um: float,
    cut_off_um: float,
    temperature_K: float,
    delta_K: float,
    angle_deg: float,
    frequency: float,
    dtype: npt.DTypeLike,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> npt.NDArray[np.floating]:
    """Band radiance of a test scene, averaged over each sample's area.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    width, height : int
        Samples across and down, 1 to 65536.
    cut_on_um, cut_off_um : float
        Band [µm].
    temperature_K, delta_K : float
        Background [K] and how much warmer the target is [K]. All targets are black; the
        dormitory and the airfield have surfaces of many temperatures and emissivities, in steps
        of delta_K.
    angle_deg : float
        Direction from +x towards +y: the normal of the slanted edge, and along which the
        sinusoid varies [deg].
    frequency : float
        Cycles across the frame's width (sine) or shorter side (coarsest four-bar target), or
        the number of spokes (siemens_star).
    dtype : dtype
        float32 or float64; the sums are in double either way.
    for_each : callable
        Draws some rows at a time, perhaps in threads.
    empty : callable
        Makes the array to be filled in, perhaps on disk.

    Returns
    -------
    ndarray, shape (height, width)
        Radiance [W m⁻² sr⁻¹].

    Raises
    ------
    ParameterError
        If a parameter is out of range; it names the value and what is allowed.
    """
    sources = {
        "cut_on_um": cut_on_um,
        "cut_off_um": cut_off_um,
        "temperature_K": temperature_K,
        "delta_K": delta_K,
    }
    check_radiometry(**sources)
    if kind in DRAWN:
        radiances = surface_radiance(**sources)
    else:
        radiances = dict(zip(("background", "signal"), target_radiance(**sources), strict=True))
    return draw_radiances(
        radiances,
        kind=kind,
        width=width,
        height=height,
        angle_deg=angle_deg,
        frequency=frequency,
        dtype=dtype,
        for_each=for_each,
        empty=empty,
    )


def drawing_of(kind: str) -> Drawing:
    """The strokes of one of `DRAWN`."""
    return dormitory() if kind == "dormitory" else airfield()


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
    """A test scene of these radiances; the other parameters are those of `draw_scene`.

    Parameters
    ----------
    radiances : mapping of str to float
        Of every surface, of those in `DRAWN`, and perhaps the strengths of their textures; else of
        `background` and `signal`. The picture is linear in all of them.
    """
    kind_dtype = check_frame(kind, width, height, dtype)
    check_geometry(angle_deg=angle_deg, frequency=frequency)
    if kind in DRAWN:
        return drawing_of(kind).render(
            radiances,
            width=width,
            height=height,
            dtype=kind_dtype,
            for_each=for_each,
            empty=empty,
        )
    background, signal = radiances["background"], radiances["signal"]
    size: dict[str, Any] = {"width": width, "height": height, "dtype": kind_dtype, "empty": empty}
    two: dict[str, Any] = {"background": background, "signal": signal}
    draw: dict[str, Callable[[], targets.Picture]] = {
        "uniform": lambda: targets.uniform(**size, background=background),
        "point": lambda: targets.point(**size, **two),
        "two_panel": lambda: targets.two_panel(**size, **two),
        "slanted_edge": lambda: targets.slanted_edge(
            **size, **two, angle_deg=angle_deg, for_each=for_each
        ),
        "sine": lambda: targets.sine(
            **size, **two, angle_deg=angle_deg, frequency=frequency, for_each=for_each
        ),
        "siemens_star": lambda: targets.siemens_star(
            **size, **two, frequency=frequency, for_each=for_each
        ),
        "four_bar": lambda: targets.four_bar(**size, **two, frequency=frequency),
    }
    return draw[kind]()
