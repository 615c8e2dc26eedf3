"""One entry to every test scene."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from core.errors import ParameterError
from core.physics.planck import band_radiance
from nodes.scenes import targets
from nodes.scenes.dormitory import dormitory

MAX_SIDE = 65536

KINDS = (
    "dormitory",
    "slanted_edge",
    "four_bar",
    "siemens_star",
    "point",
    "sine",
    "two_panel",
    "uniform",
)


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
        dormitory has surfaces of many temperatures and emissivities, in steps of delta_K.
    angle_deg : float
        Direction from +x towards +y: the normal of the slanted edge, and along which the
        sinusoid varies [deg].
    frequency : float
        Cycles across the frame's width (sine) or shorter side (coarsest four-bar target), or
        the number of spokes (siemens_star).
    dtype : dtype
        float32 or float64; the sums are in double either way.

    Returns
    -------
    ndarray, shape (height, width)
        Radiance [W m⁻² sr⁻¹].

    Raises
    ------
    ParameterError
        If a parameter is out of range; it names the value and what is allowed.
    """
    kind_dtype = _check_frame(kind, width, height, dtype)
    _check_numbers(
        cut_on_um=cut_on_um,
        cut_off_um=cut_off_um,
        temperature_K=temperature_K,
        delta_K=delta_K,
        angle_deg=angle_deg,
        frequency=frequency,
    )
    if kind == "dormitory":
        drawing = dormitory(
            cut_on_um=cut_on_um,
            cut_off_um=cut_off_um,
            temperature_K=temperature_K,
            delta_K=delta_K,
        )
        return drawing.render(width=width, height=height, dtype=kind_dtype)
    levels = np.asarray(
        band_radiance(
            cut_on_um=cut_on_um,
            cut_off_um=cut_off_um,
            temperature_K=np.array([temperature_K, temperature_K + delta_K]),
        )
    )
    background, signal = levels.tolist()
    size = {"width": width, "height": height}
    two = {"background": background, "signal": signal}
    draw: dict[str, Callable[[], targets.Picture]] = {
        "uniform": lambda: targets.uniform(**size, background=background, dtype=kind_dtype),
        "point": lambda: targets.point(**size, **two, dtype=kind_dtype),
        "two_panel": lambda: targets.two_panel(**size, **two, dtype=kind_dtype),
        "slanted_edge": lambda: targets.slanted_edge(
            **size, **two, angle_deg=angle_deg, dtype=kind_dtype
        ),
        "sine": lambda: targets.sine(
            **size, **two, angle_deg=angle_deg, frequency=frequency, dtype=kind_dtype
        ),
        "siemens_star": lambda: targets.siemens_star(
            **size, **two, frequency=frequency, dtype=kind_dtype
        ),
        "four_bar": lambda: targets.four_bar(**size, **two, frequency=frequency, dtype=kind_dtype),
    }
    return draw[kind]()


def _check_frame(kind: str, width: int, height: int, dtype: npt.DTypeLike) -> np.dtype[np.generic]:
    if kind not in KINDS:
        raise ParameterError("kind", kind, "one of " + ", ".join(KINDS))
    for name, side in (("width", width), ("height", height)):
        if not isinstance(side, int | np.integer) or not 1 <= side <= MAX_SIDE:
            raise ParameterError(name, side, f"a whole number from 1 to {MAX_SIDE}", unit="samples")
    wanted: np.dtype[np.generic] = np.dtype(dtype)
    if wanted not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise ParameterError("dtype", str(wanted), "float32 or float64")
    return wanted


def _check_numbers(
    *,
    cut_on_um: float,
    cut_off_um: float,
    temperature_K: float,
    delta_K: float,
    angle_deg: float,
    frequency: float,
) -> None:
    for name, value, unit in (
        ("cut_on_um", cut_on_um, "µm"),
        ("cut_off_um", cut_off_um, "µm"),
        ("temperature_K", temperature_K, "K"),
        ("delta_K", delta_K, "K"),
        ("angle_deg", angle_deg, "deg"),
        ("frequency", frequency, "cycles per frame"),
    ):
        if not math.isfinite(value):
            raise ParameterError(name, value, "a finite number", unit=unit)
    if not cut_on_um > 0.0:
        raise ParameterError("cut_on_um", cut_on_um, "above 0", unit="µm")
    if not cut_on_um < cut_off_um:
        raise ParameterError(
            "cut_off_um", cut_off_um, f"above cut_on_um = {cut_on_um:g}", unit="µm"
        )
    if not temperature_K > 0.0:
        raise ParameterError("temperature_K", temperature_K, "above 0", unit="K")
    if not temperature_K + delta_K > 0.0:
        raise ParameterError(
            "delta_K", delta_K, f"above -temperature_K = {-temperature_K:g}", unit="K"
        )
    if frequency < 0.0:
        raise ParameterError("frequency", frequency, "0 or more", unit="cycles per frame")
