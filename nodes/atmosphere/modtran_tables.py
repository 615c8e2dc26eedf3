"""Paths to the ground from pyBSM's tables, which MODTRAN 5.2.1 computed.

Between them the mean extinction per km, −ln τ/R, and the source L/(1 − τ) are straight along the
ground and in the logarithm of the height. With every second table left out, band means of the
transmission are within 0.001 rms (at most 0.03) along the ground and 0.007 (0.06) in height, those
of the path radiance within 1.3 % and 2.3 % rms.

Source: LeMaster and Eismann 2017, pyBSM, Proc. SPIE 10204 (Apache License 2.0).
"""

import math
import warnings
from functools import lru_cache
from typing import Any

import numpy as np

from core.errors import DataError, ParameterError, how_to_install
from core.physics.sampling.ground_geometry import EARTH_RADIUS_KM as R

Points = tuple[tuple[float, float], ...]
_HEIGHTS = (0.002, 0.0325, 0.075, 0.15, 0.225, 0.5, *range(1, 13), 14, 16, 18, 20, 24.5)
_DISTANCES = (0, 0.1, 0.5, *range(1, 20), *range(20, 80, 2), *range(80, 305, 5))  # km, both


@lru_cache(maxsize=8)
def table_path(*, height_km: float, range_km: float, ihaze: int) -> tuple[Points, Points]:
    """Transmission and path radiance (W/m²/sr/µm) against wavelength in µm, rising.

    `height_km` is the camera's above the target, `range_km` the length of the line of sight;
    `ihaze` is 1 for 23 km of visibility and 2 for 5 km. A camera above the highest table, 24.5 km,
    sees the air below that height.
    """
    try:
        with warnings.catch_warnings():  # pyBSM sets filters
            from pybsm.utils import load_database_atmosphere_no_interp as load
    except ImportError as error:
        needed = f"the package pybsm: {how_to_install('atmosphere')}"
        raise DataError(f"model = modtran_tables needs {needed}") from error
    if not height_km >= _HEIGHTS[0]:
        raise ParameterError("altitude_m", 1e3 * height_km, "2 or more")
    if range_km < height_km * (1.0 - 1e-9):
        allowed = f"at least the altitude, {1e3 * height_km:g} m"
        raise ParameterError("range_m", 1e3 * range_km, allowed)
    # Sine of the elevation at the target, and what of the path lies in the tables.
    sine = min((height_km * (2 * R + height_km) - range_km**2) / (2 * R * range_km), 1.0)
    beyond = ParameterError(
        "range_m", 1e3 * range_km, "at most 300 km along the ground, and not beyond the horizon"
    )
    if sine < 0.0:
        raise beyond
    height = min(height_km, _HEIGHTS[-1])
    square = height * (2 * R + height)
    length = square / (math.sqrt((R * sine) ** 2 + square) + R * sine)
    ground = R * math.asin(min(length * math.sqrt(1.0 - sine * sine) / (R + height), 1.0))
    if ground > _DISTANCES[-1]:
        raise beyond
    depth, source = np.zeros((2, 1))
    for h, by_height in _around(_HEIGHTS, height, math.log):
        for g, along in _around(_DISTANCES, ground, float):
            try:
                table = load(altitude=1e3 * h, ground_range=1e3 * g, ihaze=ihaze)
            except IndexError:
                raise beyond from None
            passed = np.asarray(table[:, 1], np.float64)
            added = np.asarray(table[:, 2] + table[:, 4], np.float64) / 1e6
            slant = math.hypot(h, 2.0 * math.sqrt(R * (R + h)) * math.sin(g / R / 2.0))
            depth = depth - by_height * along * np.log(np.maximum(passed, 1e-30)) / slant
            source = source + by_height * along * added / np.maximum(1.0 - passed, 1e-6)
    transmission = np.minimum(np.exp(-depth * length), 1.0)
    radiance = source * (1.0 - transmission)
    points = np.stack([1e6 * table[:, 0], transmission, radiance], axis=1).tolist()
    return tuple((um, t) for um, t, _ in points), tuple((um, r) for um, _, r in points)


def _around(places: tuple[float, ...], place: float, scale: Any) -> list[tuple[float, float]]:
    """The places on both sides and their weights; one where it is one of them."""
    index = int(np.clip(np.searchsorted(places, place), 1, len(places) - 1))
    low, high = places[index - 1 : index + 1]
    share = (scale(place) - scale(low)) / (scale(high) - scale(low))
    return [one for one in ((low, 1.0 - share), (high, share)) if abs(one[1]) > 1e-9]
