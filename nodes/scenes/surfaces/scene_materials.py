"""Surfaces of the drawn scenes: how warm each is, and how much of the sky it mirrors."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from core.errors import ParameterError
from core.physics.radiometry.planck import band_radiance

FloatArray = NDArray[np.float64]

SKY_OFFSET = -2.6
"""The zenith, and what surfaces mirror of it, in units of delta_K from temperature_K."""

SURFACES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        # name: (offset from temperature_K in units of delta_K, emissivity)
        "zenith": (SKY_OFFSET, 1.0),
        "horizon": (-1.45, 1.0),
        "cloud": (-1.9, 1.0),
        "hills": (-0.95, 0.97),
        "brick": (0.25, 0.94),
        "brick_shade": (0.02, 0.94),
        "mortar": (-0.12, 0.91),
        "concrete": (0.60, 0.92),
        "coping": (-0.45, 0.90),
        "slab": (0.85, 0.92),
        "roof": (-0.9, 0.90),
        "metal": (-0.1, 0.55),
        "vent": (0.9, 0.85),
        "exhaust": (1.5, 0.95),
        "plume": (-0.2, 1.0),
        "frame": (-0.20, 0.75),
        "glass_cool": (-0.45, 0.84),
        "glass_mid": (0.15, 0.84),
        "glass_lit": (1.05, 0.86),
        "glass_open": (1.5, 0.95),
        "door": (1.35, 0.90),
        "grille": (1.2, 0.90),
        "lawn": (-0.5, 0.98),
        "lawn_near": (-0.2, 0.98),
        "asphalt": (0.6, 0.95),
        "paving": (0.42, 0.93),
        "joint": (0.05, 0.95),
        "marking": (0.45, 0.90),
        "kerb": (0.20, 0.92),
        "shade": (-0.95, 0.98),
        "bark": (-0.45, 0.95),
        "leaf_cool": (-1.25, 0.97),
        "leaf_warm": (-0.42, 0.97),
        "car_cool": (-0.35, 0.90),
        "car_warm": (0.55, 0.92),
        "car_glass": (-0.95, 0.85),
        "engine": (1.7, 0.92),
        "tyre": (0.95, 0.95),
        "lamp": (1.4, 0.95),
    }
)

ALIKE: Mapping[str, str] = MappingProxyType({"soil": "asphalt", "water": "leaf_cool"})
"""Surfaces as warm and, where they are grey, as bright as others."""


def surface_temperatures(*, temperature_K: float, delta_K: float) -> FloatArray:
    """Temperature of each of `SURFACES` [K]; parameters and error as `surface_radiance`."""
    offsets = np.array([offset for offset, _ in SURFACES.values()])
    temperatures = temperature_K + offsets * delta_K
    if not float(temperatures.min()) > 0.0:
        low, high = -temperature_K / offsets.max(), -temperature_K / offsets.min()
        raise ParameterError(
            "delta_K",
            delta_K,
            f"this scene allows more than {low:g} and less than {high:g}",
            unit="K",
        )
    return np.asarray(temperatures)


def surface_radiance(
    *, cut_on_um: float, cut_off_um: float, temperature_K: float, delta_K: float
) -> dict[str, float]:
    """Band radiance of every surface, emitted and mirrored.

    L = emissivity·L_band(T) + (1 - emissivity)·L_band(T_sky), with opaque grey surfaces that
    see the sky by reflection.

    Parameters
    ----------
    cut_on_um, cut_off_um : float
        Band [µm].
    temperature_K, delta_K : float
        Air temperature [K] and the step in which surfaces differ from it [K].

    Returns
    -------
    dict of str to float
        Radiance [W m⁻² sr⁻¹] by surface name.

    Raises
    ------
    ParameterError
        If delta_K puts a surface at or below 0 K.
    """
    temperatures = surface_temperatures(temperature_K=temperature_K, delta_K=delta_K)
    emissivity = np.array([share for _, share in SURFACES.values()])
    own = np.asarray(
        band_radiance(cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=temperatures)
    )
    sky = own[list(SURFACES).index("zenith")]
    total = emissivity * own + (1.0 - emissivity) * sky
    radiances = dict(zip(SURFACES, total.tolist(), strict=True))
    return {**radiances, **{name: radiances[other] for name, other in ALIKE.items()}}


def target_radiance(
    *, cut_on_um: float, cut_off_um: float, temperature_K: float, delta_K: float
) -> tuple[float, float]:
    """Band radiance of a black background and of a black target that is delta_K warmer.

    Parameters and unit as for `surface_radiance`.
    """
    levels = band_radiance(
        cut_on_um=cut_on_um,
        cut_off_um=cut_off_um,
        temperature_K=np.array([temperature_K, temperature_K + delta_K]),
    )
    background, signal = levels.tolist()
    return background, signal
