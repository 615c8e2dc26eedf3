"""View of the ground from a circular orbit: speed, slant range, elevation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from core.errors import ParameterError
from core.physics.checks import non_negative, positive

EARTH_GM_KM3_PER_S2 = 398600.4418
EARTH_RADIUS_KM = 6378.137
LookDirection = Literal["across", "along"]


@dataclass(frozen=True)
class OrbitView:
    """What a camera sees from a circular orbit; elevation as seen from the target.

    `velocity_m_per_s` is of the scene across the line of sight: divided by the range, the angular
    rate of the image.
    """

    altitude_km: float
    direction: LookDirection
    ground_speed_m_per_s: float
    range_m: float
    elevation_deg: float
    velocity_m_per_s: float

    def ground_gsd(self, x: float | None, y: float | None) -> tuple[float | None, float | None]:
        """GSD on the ground of one normal to the line of sight, across and along the track."""
        sine = math.sin(math.radians(self.elevation_deg))
        if self.direction == "across":
            return None if x is None else x / sine, y
        return x, None if y is None else y / sine


def orbit_view(
    *, altitude_km: float, look_angle_deg: float = 0.0, direction: LookDirection = "across"
) -> OrbitView:
    """Speed and geometry of a camera on a circular orbit that keeps its look angle.

    Parameters
    ----------
    altitude_km, look_angle_deg : float
        Above 0; off nadir, from 0 to below the horizon.
    direction : "across" or "along"
        Where the line of sight is tilted to: beside the track, or ahead on it.

    Returns
    -------
    OrbitView
        Over a spherical Earth that does not rotate: v_g = √(GM/r)·R/r, cos ε = sin η·r/R,
        λ = 90° − η − ε, D = r·cos η − R·sin ε. The scene moves across the line of sight with
        v_g·cos λ for a look beside the track, v_g·sin ε for one along it.

    Source: Wertz and Larson 1999, Space Mission Analysis and Design, sections 5.2 and 6.1; Vallado
    2013, Fundamentals of Astrodynamics (GM, R).
    """
    height, radius = positive("altitude_km", altitude_km, unit="km"), EARTH_RADIUS_KM
    r = radius + height
    angle = math.radians(non_negative("look_angle_deg", look_angle_deg, unit="deg"))
    cosine = math.sin(angle) * r / radius  # of the elevation
    if not (angle < 0.5 * math.pi and cosine < 1.0):
        horizon = math.degrees(math.asin(radius / r))
        allowed = f"0 to below {horizon:.4g}, where the line of sight misses the Earth"
        raise ParameterError("look_angle_deg", look_angle_deg, allowed, unit="deg")
    sine = math.sqrt((1.0 - cosine) * (1.0 + cosine))
    ground = 1000.0 * math.sqrt(EARTH_GM_KM3_PER_S2 / r) * radius / r
    central = 0.5 * math.pi - angle - math.acos(cosine)
    across = math.cos(central) if direction == "across" else sine
    return OrbitView(
        altitude_km=height,
        direction=direction,
        ground_speed_m_per_s=ground,
        # r·cos η − R·sin ε without cancellation: the product with its conjugate is h·(2R + h).
        range_m=1000.0 * height * (2.0 * radius + height) / (r * math.cos(angle) + radius * sine),
        elevation_deg=90.0 if angle == 0.0 else math.degrees(math.acos(cosine)),
        velocity_m_per_s=ground * across,
    )
