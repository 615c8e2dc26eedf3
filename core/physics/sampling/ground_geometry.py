"""Where the samples of a line scanner, a pushbroom or a framing camera lie on flat ground.

Axes are those of the picture: x to the right, across the flight; y down, along it; z towards the
ground. A place in the frame is counted in samples: column u from 0 to `columns`, line v from 0 to
`rows`, so that sample i reaches from i to i + 1. The ground is counted in metres from the middle
of the scene.

Each ray leaves the camera as (a(u), b(v), 1) and meets the ground through one 3 × 3 matrix, with a
and b as the kind of camera has them. Roll turns the view about y (positive: to the right), then
pitch about x (positive: ahead, down the picture), then yaw about z (positive: clockwise, and the
flight with it).

Sources: Tantalo 1996, section 2 and figure 2.3, after Salacain 1995 (not seen), for what each
sensor samples in equal steps; Wolf and Dewitt, Elements of Photogrammetry, for the collinearity
equations, and Schott 1997, Remote Sensing, for panoramic distortion, both by memory: what is used
of them follows from the geometry alone.
"""

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Vector
from core.errors import DataError, ParameterError
from core.physics.numerics import non_negative, positive
from core.physics.sampling.platform_motion import view_angles_rad
from core.records import dataclass

Kind = Literal["line", "pushbroom", "framing"]


@dataclass(frozen=True)
class Camera:
    """A camera over flat ground.

    The kind says what is sampled in equal steps: "line", angles across and lines flown;
    "pushbroom", the focal plane across and lines flown; "framing", the focal plane both ways. A
    sample's size across and along is an angle (across, of a line scanner), or thousandths of the
    focal length. The line spacing is the distance flown from one line to the next; nothing to a
    framing camera. The attitude is the same for all lines; the offset is where it is when the
    middle of the frame is taken.
    """

    kind: Kind
    altitude_m: float
    columns: int
    rows: int
    step_x_mrad: float
    step_y_mrad: float
    line_spacing_m: float = 0.0
    roll_deg: float = 0.0
    pitch_deg: float = 0.0
    yaw_deg: float = 0.0
    offset_x_m: float = 0.0
    offset_y_m: float = 0.0


def view_angles(*, camera: Camera, u: ArrayLike) -> Vector:
    """Angle of columns from nadir across, in rad; from the optical axis for a framing camera.

    Columns are 0 to `columns`; the camera's roll is added, but for a framing camera.
    """
    away = np.asarray(u, np.float64) - 0.5 * camera.columns
    angle = away * (camera.step_x_mrad / 1000.0)
    if camera.kind != "line":
        angle = np.arctan(angle)
    return angle if camera.kind == "framing" else angle + math.radians(camera.roll_deg)


def across(*, camera: Camera, u: ArrayLike) -> Vector:
    """The rays' first component, a(u): the tangent of the view angle."""
    if camera.kind == "framing":
        away = np.asarray(u, np.float64) - 0.5 * camera.columns
        return np.asarray(away * (camera.step_x_mrad / 1000.0))
    return np.tan(view_angles(camera=camera, u=u))


def along(*, camera: Camera, v: ArrayLike) -> Vector:
    """The rays' second component, b(v): lines flown, or the tangent from the optical axis."""
    away = np.asarray(v, np.float64) - 0.5 * camera.rows
    return away * (camera.step_y_mrad / 1000.0) if camera.kind == "framing" else away


def ground_matrix(*, camera: Camera) -> Vector:
    """From (a, b, 1) to ground coordinates in m, up to the third component.

    X = M₀·r/M₂·r, Y = M₁·r/M₂·r with r = (a, b, 1). Framing: the collinearity equations, X = x₀ +
    h·d_x/d_z with d = R_z(yaw)·R_x(pitch)·R_y(roll)·r (Wolf and Dewitt). The rays of a line scanner
    or pushbroom lie in one plane, so that with a pitch of p they meet the ground at (h·a/cos p,
    h·tan p), and the next line is a spacing further.
    """
    roll, pitch, yaw = (
        math.radians(angle) for angle in (camera.roll_deg, camera.pitch_deg, camera.yaw_deg)
    )
    height = camera.altitude_m
    turn = _turn_z(yaw)
    if camera.kind == "framing":
        d_x, d_y, d_z = turn @ _turn_x(pitch) @ _turn_y(roll)
        return np.stack(
            [height * d_x + camera.offset_x_m * d_z, height * d_y + camera.offset_y_m * d_z, d_z]
        )
    flown = np.diag([height / math.cos(pitch), camera.line_spacing_m, 1.0])
    flown[1, 2] = height * math.tan(pitch)
    moved = turn @ flown
    moved[:2, 2] += camera.offset_x_m, camera.offset_y_m
    return np.asarray(moved)


def line_widths(*, camera: Camera, u: ArrayLike) -> Vector:
    """Extent of samples along the flight, in lines.

    1 for a framing camera. Else step_y·h·g/spacing with the cosine of the pitch squared below:
    g is the secant of the view angle for a line scanner, whose range grows by that, and 1 for
    an upright pushbroom, whose samples have the same size in the focal plane.
    """
    columns = np.asarray(u, np.float64)
    if camera.kind == "framing":
        return np.ones(columns.shape)
    angle = view_angles(camera=camera, u=columns)
    growth = 1.0 / np.cos(angle)
    if camera.kind == "pushbroom":
        growth = growth * np.cos(angle - math.radians(camera.roll_deg))
    nadir = camera.step_y_mrad / 1000.0 * camera.altitude_m / camera.line_spacing_m
    return np.asarray(growth * (nadir / math.cos(math.radians(camera.pitch_deg)) ** 2))


def ground_points(*, camera: Camera, u: ArrayLike, v: ArrayLike) -> tuple[Vector, Vector]:
    """Where places in the frame lie on the ground, m from the middle of the scene.

    `check_horizon` tests that the camera sees the ground everywhere.
    """
    a, b = np.broadcast_arrays(across(camera=camera, u=u), along(camera=camera, v=v))
    x, y, z = np.tensordot(ground_matrix(camera=camera), np.stack([a, b, np.ones(a.shape)]), 1)
    return x / z, y / z


def ground_sample(*, camera: Camera, u: float, v: float) -> tuple[float, float]:
    """Size in m on the ground, across and along, of the sample about a place in the frame.

    It is that of its two middle lines: for an upright line scanner h·Δ·sec²θ across and h·Δ·sec θ
    along, but for terms of Δ³.
    """
    reach = 0.5 * float(line_widths(camera=camera, u=u))
    x, y = ground_points(camera=camera, u=[u - 0.5, u + 0.5, u, u], v=[v, v, v - reach, v + reach])
    size = np.hypot(np.diff(x)[::2], np.diff(y)[::2])
    return float(size[0]), float(size[1])


def ground_bounds(*, camera: Camera) -> tuple[float, float, float, float]:
    """Left, right, top and bottom of the ground that a frame shows, with the samples' whole extent.

    In m from the middle of the scene. The frame's borders are straight on the ground, so that its
    corners lie farthest out.
    """
    x, y = [], []
    for u, column in ((0.0, 0.5), (float(camera.columns), camera.columns - 0.5)):
        beyond = 0.5 * (float(line_widths(camera=camera, u=column)) - 1.0)
        points = ground_points(camera=camera, u=u, v=[-beyond, camera.rows + beyond])
        x += points[0].tolist()
        y += points[1].tolist()
    return min(x), max(x), min(y), max(y)


def check_horizon(*, camera: Camera) -> None:
    """Refuse a camera that sees past the horizon, by its scan or a tilted frame's corner."""
    if camera.kind == "framing":
        corners = [
            [a, b, 1.0]
            for a in across(camera=camera, u=[0, camera.columns])
            for b in along(camera=camera, v=[0, camera.rows])
        ]
        if not np.all(np.asarray(corners) @ ground_matrix(camera=camera)[2] > 1e-6):
            raise DataError(
                "the frame reaches past the horizon: use a smaller roll_deg or pitch_deg, or a "
                "smaller field of view"
            )
        return
    if camera.kind == "line":
        view_angles_rad(columns=camera.columns + 1, interval_mrad=camera.step_x_mrad)
    half_deg = 0.5 * field_deg(camera=camera)
    if not abs(camera.roll_deg) + half_deg < 90.0:
        raise ParameterError(
            "roll_deg",
            camera.roll_deg,
            f"within ±{90 - half_deg:.4g} for a field of view of {2 * half_deg:.4g}°, so that "
            "every line of sight meets the ground",
            unit="deg",
        )


def field_deg(*, camera: Camera) -> float:
    """Field of view across."""
    half = 0.0005 * camera.columns * camera.step_x_mrad
    return 2.0 * math.degrees(half if camera.kind == "line" else math.atan(half))


def step_of_field_mrad(*, kind: Kind, fov_deg: float, columns: int) -> float:
    """Size of a sample across: fov/columns for a line scanner, else 2·tan(fov/2)/columns."""
    half = math.radians(0.5 * fov_deg)
    return 2000.0 * (half if kind == "line" else math.tan(half)) / columns


def _turn_x(angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def _turn_y(angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def _turn_z(angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


# View of the ground from a circular orbit: speed, slant range, elevation.

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
        allowed = f"0 to below {horizon:.4g}; at larger angles the line of sight misses the Earth"
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
