"""What the scenes allow; errors name the parameter, its value and what is allowed."""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from core.errors import ParameterError

MAX_SIDE = 65536

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


def check_frame(kind: str, width: int, height: int, dtype: npt.DTypeLike) -> np.dtype[np.floating]:
    """The type of the samples, of a picture that can be drawn."""
    if kind not in KINDS:
        raise ParameterError("kind", kind, "one of " + ", ".join(KINDS))
    for name, side in (("width", width), ("height", height)):
        if not isinstance(side, int | np.integer) or not 1 <= side <= MAX_SIDE:
            raise ParameterError(name, side, f"a whole number from 1 to {MAX_SIDE}", unit="samples")
    if np.dtype(dtype) == np.dtype(np.float32):
        return np.dtype(np.float32)
    if np.dtype(dtype) == np.dtype(np.float64):
        return np.dtype(np.float64)
    raise ParameterError("dtype", str(np.dtype(dtype)), "float32 or float64")


def check_geometry(*, angle_deg: float, frequency: float) -> None:
    """Refuse directions and frequencies that are no numbers."""
    _check_finite("angle_deg", angle_deg, "deg")
    _check_finite("frequency", frequency, "cycles per frame")
    if frequency < 0.0:
        raise ParameterError("frequency", frequency, "0 or more", unit="cycles per frame")


def check_radiometry(
    *, cut_on_um: float, cut_off_um: float, temperature_K: float, delta_K: float
) -> None:
    """Refuse an empty band and temperatures at or below zero."""
    _check_finite("cut_on_um", cut_on_um, "µm")
    _check_finite("cut_off_um", cut_off_um, "µm")
    _check_finite("temperature_K", temperature_K, "K")
    _check_finite("delta_K", delta_K, "K")
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


def _check_finite(name: str, value: float, unit: str) -> None:
    if not math.isfinite(value):
        raise ParameterError(name, value, "a finite number", unit=unit)
