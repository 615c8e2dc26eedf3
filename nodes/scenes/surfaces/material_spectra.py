"""Reflectance spectra of the scenes' materials, 0.4 to 14 µm, and which surface is of which.

Coarse points after the shapes of measured spectra (ASTER and ECOSTRESS spectral libraries:
Baldridge, Hook, Grove, Rivera 2009, Remote Sensing of Environment 113, 711; Meerdink, Hook,
Roberts, Abbott 2019, ibid. 230, 111196), from general knowledge and not read off single samples:
they show where materials differ, and are no measurements. What is not reflected is emitted.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.physics.radiometry.coarse_spectrum import CoarseSpectrum


def _percent(*points: tuple[float, float]) -> CoarseSpectrum:
    return CoarseSpectrum(tuple((wavelength, value / 100.0) for wavelength, value in points))


MATERIALS: Mapping[str, CoarseSpectrum] = MappingProxyType(
    {
        # (µm, percent reflected)
        # Chlorophyll absorbs up to its edge at 0.7; water at 1.45, 1.94 and beyond 2.7.
        "grass": _percent(
            (0.40, 3), (0.50, 4), (0.55, 9), (0.60, 6), (0.67, 4), (0.70, 12), (0.75, 42),
            (0.90, 50), (1.10, 50), (1.20, 44), (1.28, 46), (1.45, 14), (1.65, 30), (1.80, 25),
            (1.94, 7), (2.20, 16), (2.50, 5), (2.75, 2), (3.00, 2), (3.80, 4), (4.50, 2),
            (6.00, 1.5), (8.00, 2), (10.0, 2), (14.0, 1),
        ),
        "leaves": _percent(
            (0.40, 4), (0.50, 5), (0.55, 11), (0.60, 7), (0.67, 5), (0.70, 14), (0.75, 46),
            (0.90, 52), (1.10, 52), (1.20, 47), (1.28, 49), (1.45, 18), (1.65, 34), (1.80, 29),
            (1.94, 9), (2.20, 19), (2.50, 6), (2.75, 3), (3.00, 3), (3.80, 5), (4.50, 3),
            (6.00, 3), (8.00, 3), (10.0, 3), (14.0, 2),
        ),
        "bark": _percent(
            (0.40, 8), (0.60, 16), (0.80, 30), (1.10, 42), (1.45, 36), (1.70, 44), (1.94, 30),
            (2.20, 32), (2.75, 8), (3.00, 6), (3.80, 14), (5.00, 7), (8.00, 4), (10.0, 5),
            (14.0, 5),
        ),
        "soil": _percent(
            (0.40, 7), (0.50, 11), (0.60, 18), (0.80, 26), (1.10, 33), (1.40, 36), (1.45, 34),
            (1.70, 41), (1.94, 34), (2.15, 41), (2.20, 38), (2.50, 33), (2.75, 10), (3.00, 9),
            (3.80, 22), (4.50, 15), (5.00, 11), (6.50, 3), (7.50, 2), (8.20, 8), (9.00, 9),
            (9.60, 7), (10.5, 4), (14.0, 4),
        ),
        "water": _percent(
            (0.40, 4), (0.55, 4), (0.65, 3), (0.75, 2), (1.00, 2), (2.00, 2), (2.75, 1),
            (3.05, 4), (3.30, 3.5), (3.80, 2.3), (5.00, 2), (6.05, 2.5), (8.00, 1.5), (10.8, 0.8),
            (12.0, 1.7), (14.0, 4),
        ),
        "asphalt": _percent(
            (0.40, 5), (0.60, 9), (0.80, 11), (1.20, 14), (1.60, 16), (2.20, 17), (2.30, 15),
            (2.50, 15), (2.75, 8), (3.00, 8), (3.40, 8), (3.80, 12), (4.50, 10), (5.00, 8),
            (6.50, 5), (8.00, 5), (9.00, 8), (9.60, 6), (10.5, 4), (14.0, 4),
        ),
        # Cement's carbonate at 4, 7 and 11.3; quartz sand at 8 to 9.5; its water at 3.
        "concrete": _percent(
            (0.40, 18), (0.50, 25), (0.60, 30), (0.80, 34), (1.10, 37), (1.40, 38), (1.45, 36),
            (1.70, 40), (1.94, 33), (2.20, 36), (2.50, 27), (2.75, 8), (3.00, 7), (3.40, 12),
            (3.80, 20), (4.00, 17), (4.50, 18), (5.00, 10), (6.00, 5), (6.50, 9), (7.20, 4),
            (8.20, 8), (9.00, 11), (9.60, 8), (10.5, 4), (11.3, 7), (11.8, 4), (14.0, 4),
        ),
        # Iron oxide up to 0.6 and at 0.87; silicates at 8 to 10.
        "brick": _percent(
            (0.40, 6), (0.50, 9), (0.55, 13), (0.60, 24), (0.75, 34), (0.87, 33), (1.10, 40),
            (1.70, 50), (2.20, 51), (2.50, 47), (2.75, 26), (3.00, 24), (3.80, 38), (4.50, 27),
            (5.00, 17), (6.00, 7), (7.50, 2), (8.40, 6), (9.30, 12), (10.0, 8), (11.0, 5),
            (12.5, 5), (14.0, 6),
        ),
        "roofing": _percent(
            (0.40, 8), (0.60, 12), (1.00, 15), (1.60, 18), (2.20, 18), (2.50, 15), (2.75, 8),
            (3.00, 7), (3.40, 7), (3.80, 13), (5.00, 9), (6.50, 5), (8.00, 6), (9.20, 12),
            (10.0, 8), (11.0, 6), (14.0, 6),
        ),
        # Pigment in a binder, which absorbs at 3.4 and beyond 5.5.
        "painted metal": _percent(
            (0.40, 12), (0.45, 24), (0.60, 30), (0.80, 36), (1.10, 44), (1.70, 47), (2.20, 42),
            (2.30, 34), (2.60, 30), (3.00, 12), (3.40, 5), (3.80, 22), (4.50, 18), (5.20, 12),
            (5.80, 4), (8.00, 6), (9.50, 9), (12.0, 8), (14.0, 9),
        ),
        "white paint": _percent(
            (0.38, 6), (0.42, 60), (0.50, 78), (0.80, 82), (1.10, 80), (1.70, 68), (2.20, 58),
            (2.30, 45), (2.60, 40), (3.00, 12), (3.40, 5), (3.80, 20), (5.00, 12), (5.80, 4),
            (8.00, 5), (9.50, 8), (12.0, 9), (14.0, 12),
        ),
        "weathered zinc": _percent(
            (0.40, 36), (0.60, 42), (1.00, 38), (1.60, 50), (2.50, 56), (2.90, 45), (4.00, 56),
            (6.00, 50), (6.60, 38), (8.00, 46), (10.0, 45), (14.0, 50),
        ),
        # What it lets through is lost in a room that is as good as black. Silica at 9 to 10.
        "window glass": _percent(
            (0.40, 9), (1.00, 8), (2.70, 7), (3.00, 5), (4.50, 4), (6.00, 3), (7.30, 1),
            (7.80, 2), (8.40, 12), (9.00, 25), (9.60, 31), (10.2, 22), (11.0, 13), (12.5, 9),
            (14.0, 8),
        ),
        "rubber": _percent((0.40, 4), (1.00, 5), (2.50, 6), (5.00, 5), (9.30, 6), (14.0, 4)),
        # Of sunlight on white paper: what the sky sends of it, rough, and steeper in the blue.
        "clear sky": _percent(
            (0.40, 17), (0.45, 12), (0.50, 9), (0.60, 5), (0.70, 3.2), (0.85, 1.7), (1.00, 1),
            (1.60, 0.2), (2.50, 0),
        ),
        "haze": _percent(
            (0.40, 27), (0.50, 24), (0.60, 20), (0.70, 17), (1.00, 9), (1.60, 3), (2.50, 0),
        ),
        # Droplets: bright where water is clear.
        "cloud": _percent(
            (0.40, 60), (0.90, 58), (1.10, 54), (1.30, 46), (1.45, 18), (1.65, 34), (1.94, 9),
            (2.20, 22), (2.60, 3), (3.00, 0.5), (3.80, 4), (4.50, 0),
        ),
    }
)  # fmt: skip

MATERIAL_OF: Mapping[str, str] = MappingProxyType(
    {
        "zenith": "clear sky",
        "horizon": "haze",
        "cloud": "cloud",
        "hills": "leaves",
        "brick": "brick",
        "brick_shade": "brick",
        "mortar": "concrete",
        "concrete": "concrete",
        "coping": "concrete",
        "slab": "concrete",
        "roof": "roofing",
        "metal": "weathered zinc",
        "vent": "painted metal",
        "exhaust": "painted metal",
        "plume": "cloud",
        "frame": "white paint",
        "glass_cool": "window glass",
        "glass_mid": "window glass",
        "glass_lit": "window glass",
        "glass_open": "rubber",
        "door": "painted metal",
        "grille": "painted metal",
        "lawn": "grass",
        "lawn_near": "grass",
        "soil": "soil",
        "water": "water",
        "asphalt": "asphalt",
        "paving": "concrete",
        "joint": "asphalt",
        "marking": "white paint",
        "kerb": "concrete",
        "shade": "grass",
        "bark": "bark",
        "leaf_cool": "leaves",
        "leaf_warm": "leaves",
        "car_cool": "painted metal",
        "car_warm": "painted metal",
        "car_glass": "window glass",
        "engine": "painted metal",
        "tyre": "rubber",
        "lamp": "window glass",
    }
)

SKY = ("zenith", "horizon", "cloud", "plume")
"""They mirror nothing: their light comes straight from them."""

SHADED = ("shade", "brick_shade", "glass_open", "grille")
"""They see the sky, and not the Sun."""
