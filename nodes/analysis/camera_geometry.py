"""Camera Geometry: a wider scene as a line scanner, a pushbroom or a framing camera samples it."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np

from core.arrays import Array
from core.chain.engine import PlannedNode
from core.chain.wires import Curve, CurveData, Header, Image, Series, Table, TableData
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, ends_lineage, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param, readout
from core.modules.preview import Axis, Plot, Preview, brief, pair
from core.modules.preview import Curve as DrawnCurve
from core.physics.sampling.footprint_means import (
    Between,
    Footprints,
    footprint_coverage,
    footprint_means,
    footprints,
    strips_error,
)
from core.physics.sampling.ground_geometry import (
    Camera,
    Kind,
    across,
    along,
    check_horizon,
    field_deg,
    ground_bounds,
    ground_matrix,
    ground_points,
    ground_sample,
    line_widths,
    step_of_field_mrad,
    view_angles,
)
from nodes.shared.module_ports import TableFigures

Pair = tuple[float, float]
FINER = 4  # times as many strips, to estimate the error
CURVE_POINTS = 129
_OF_CAMERA = ("kind", "altitude_m", "roll_deg", "pitch_deg", "yaw_deg", "offset_x_m", "offset_y_m")


def laid_footprints(
    _: Work, *, camera: Camera, size: tuple[int, int], intervals_m: Pair, strips: int
) -> Footprints:
    """Of a scene of rows and columns at intervals across and along."""
    (rows, columns), (x, y) = size, intervals_m
    to_samples = np.array([[1.0 / x, 0.0, 0.5 * columns], [0.0, 1.0 / y, 0.5 * rows], [0, 0, 1.0]])
    u, v = np.arange(camera.columns + 1.0), np.arange(camera.rows + 1.0)
    return footprints(
        matrix=to_samples @ ground_matrix(camera=camera),
        across=across(camera=camera, u=u),
        along=along(camera=camera, v=v),
        middles=along(camera=camera, v=v[:-1] + 0.5),
        widths=line_widths(camera=camera, u=u[:-1] + 0.5),
        scene=size,
        strips=strips,
    )


@in_blocks()
@ends_lineage
def covered(work: Work, laid: Footprints) -> Array:
    return footprint_coverage(laid=laid, **_by(work))


@in_blocks()
@ends_lineage
def sampled(
    work: Work, scene: Array, laid: Footprints, coverage: Array | None = None, **how: Any
) -> Array:
    return footprint_means(scene=scene, laid=laid, coverage=coverage, **_by(work), **how)


def _by(work: Work) -> dict[str, Any]:
    return {"dtype": work.policy.dtype, "for_each": work.for_each, "empty": work.empty}


def swath_m(camera: Camera) -> float:
    x, y = ground_points(camera=camera, u=[0.0, camera.columns], v=0.5 * camera.rows)
    return float(np.hypot(x[1] - x[0], y[1] - y[0]))


def ground_curve(_: Work, *, camera: Camera) -> CurveData:
    count = min(camera.columns, CURVE_POINTS)
    u = np.linspace(0.5, camera.columns - 0.5, count)
    sizes = [ground_sample(camera=camera, u=float(column), v=0.5 * camera.rows) for column in u]
    across, along = np.array(sizes).T
    angles = np.degrees(view_angles(camera=camera, u=u))
    series = [
        Series("across the track", angles, across),
        Series("along the track", angles, along),
    ]
    if camera.kind != "framing":
        series.append(Series("line spacing", angles, np.full(count, camera.line_spacing_m)))
    axis = "angle from the optical axis" if camera.kind == "framing" else "view angle"
    return CurveData("Ground sample", f"{axis} (deg)", "size (m)", tuple(series))


@in_blocks()
def geometry_table(
    work: Work, scene: Array, laid: Footprints, *, strips: int, between_samples: Between, **how: Any
) -> TableData:
    camera, (x, y) = how["camera"], how["intervals_m"]
    left, right, top, bottom = ground_bounds(camera=camera)
    across, along = ground_sample(camera=camera, u=0.5 * camera.columns, v=0.5 * camera.rows)
    error = 0.0
    if not laid.level:
        finer = laid_footprints(work, strips=FINER * strips, **how)
        error = strips_error(scene=scene, laid=laid, finer=finer, between_samples=between_samples)
    where = "edge of the ground coverage, measured from the scene's centre"
    samples = "scene samples per camera sample at the centre"
    return CameraGeometry.figures.table(
        ("swath_m", swath_m(camera), "m", "swath width at the middle line"),
        ("left_m", left, "m", where),
        ("right_m", right, "m", where),
        ("top_m", top, "m", where),
        ("bottom_m", bottom, "m", where),
        ("scene_samples_x", across / x, "", f"{samples}, across the track"),
        ("scene_samples_y", along / y, "", f"{samples}, along the track"),
        ("strips", laid.strips, "", "strips per footprint"),
        ("footprint_error", error),
    )


class CameraOutputs(NamedTuple):
    image: Image
    coverage: Image
    curve: Curve
    table: Table


class CameraGeometry(Module, key="camera_geometry", title="Camera Geometry", group="Analysis"):
    """Sample a scene on flat ground as a line scanner, pushbroom or framing camera does.

    The scene is sampled in equal steps on the ground, and its centre is at nadir. A line scanner
    samples at equal angles, so its ground samples grow with the view angle θ, as sec²θ across the
    track and as sec θ along it (panoramic distortion). A pushbroom scanner and a framing camera
    sample at equal steps in the focal plane. The flight direction is down the picture, and scan
    lines are equally spaced on the ground. Each sample is the mean of the scene over its whole
    footprint, which limits aliasing and keeps a uniform scene uniform. Blur is applied afterwards:
    choose samples smaller than the pixels, apply Detector MTF, and then use Sample Pixels.

    Footprints aligned with the scene's rows and columns (no yaw) are exact. With roll or pitch
    alone, a framing camera's footprints are exact to 10⁻⁴ of the scene's peak-to-peak signal. Other
    footprints are oblique: each is cut into `strips` strips, and the error is estimated. Source:
    Tantalo 1996, sections 2 and 5.3, for the Salacain camera.
    """

    formulas = (
        Formula(
            r"x=h\,\tan\theta,\quad\frac{dx}{d\theta}=\frac{h}{\cos^2\theta},\quad\frac{dy}{d"
            r"\phi}=\frac{h}{\cos\theta}",
            where="h: altitude; θ: view angle across the track; a line scanner's samples grow by "
            "these factors across and along the track",
        ),
        Formula(
            r"L'_{jk}=\frac{1}{|A_{jk}|}\iint_{A_{jk}}L\,dx\,dy",
            where="A: footprint of a sample on the ground",
        ),
    )

    kind: Kind = param(
        "line", "line scanner, pushbroom, or framing camera (exposes all lines at once)"
    )
    altitude_m: float = param(
        1000.0, "height above the ground", low=0, above=True, slider=(100, 10000)
    )
    ground_interval_m: float | None = param(
        None,
        "sampling interval of the scene on the ground; empty: angular interval × altitude",
        low=0,
        slider=(0.1, 10),
    )
    ground_interval_y_m: float | None = param(
        None,
        "sampling interval of the scene down the picture; empty: equal to ground_interval_m",
        low=0,
    )
    columns: int | None = param(
        None, "samples per line; empty: the number in the scene", (1, 65536), slider=(16, 2048)
    )
    rows: int | None = param(
        None, "number of lines; empty: the number in the scene", (1, 65536), slider=(16, 2048)
    )
    fov_x_deg: float | None = param(
        20.0,
        "field of view across the track; empty: from pixel pitch and focal length",
        (0, 180),
        below=True,
    )
    pitch_x_um: float | None = param(None, "pixel pitch across the track", low=0, slider=(1, 1000))
    pitch_y_um: float | None = param(
        None, "pixel pitch along the track; empty: equal to pitch_x_um", low=0, slider=(1, 1000)
    )
    focal_length_mm: float | None = param(None, "focal length", low=0, slider=(10, 1000))
    velocity_m_per_s: float | None = param(
        None,
        "ground speed, given together with line_rate_Hz; both empty: lines touch at nadir",
        low=0,
    )
    line_rate_Hz: float | None = param(
        None,
        "lines per second, given together with velocity_m_per_s; both empty: lines touch at nadir",
        low=0,
    )
    roll_deg: float = param(0.0, "look angle to the right", (-89, 89), slider=(-45, 45))
    pitch_deg: float = param(0.0, "look angle ahead", (-89, 89), slider=(-45, 45))
    yaw_deg: float = param(0.0, "heading, clockwise from straight down the picture", (-180, 180))
    offset_x_m: float = param(
        0.0,
        "distance of the camera from the scene's centre, to the right in the picture",
        slider=(-500, 500),
    )
    offset_y_m: float = param(
        0.0, "distance of the camera from the scene's centre, down the picture", slider=(-500, 500)
    )
    interpolation: Between = param(
        "area",
        "interpolation between scene samples: constant over each sample (area), linear "
        "(bilinear), or smooth (cubic: each sample keeps its mean)",
    )
    strips: int = param(4, "number of strips per oblique footprint", (1, 64))
    outside: Literal["refuse", "fill"] = param(
        "refuse",
        "if a footprint lies beyond the scene: report an error (refuse), or use fill_value (fill)",
    )
    fill_value: float = param(0.0, "value beyond the scene, in the scene's unit")

    preview_lines = 10.5
    panel = (
        Section("Camera", "kind altitude_m columns rows", page="Camera"),
        Section("Samples", "fov_x_deg pitch_x_um pitch_y_um focal_length_mm", page="Camera"),
        Section(
            "Flight",
            "velocity_m_per_s line_rate_Hz",
            page="Camera",
            shown_when=("kind", ("line", "pushbroom")),
        ),
        Section("Attitude", "roll_deg pitch_deg yaw_deg", page="Attitude"),
        Section(
            "Scene", "ground_interval_m ground_interval_y_m offset_x_m offset_y_m", page="Scene"
        ),
        Section("Sampling", "interpolation strips outside", page="Scene"),
        Section("", "fill_value", page="Scene", shown_when=("outside", ("fill",))),
    )

    def run(self, image: Image, here: NodeContext) -> CameraOutputs:
        camera, intervals = self.camera(image), self.intervals_m(image)
        check_horizon(camera=camera)
        if self.outside == "refuse":
            _check_inside(camera, image.columns * intervals[0], image.rows * intervals[1])
        laid: dict[str, Any] = {"camera": camera, "size": image.shape, "intervals_m": intervals}
        footprints = here.step(laid_footprints, strips=self.strips, **laid)
        coverage = here.step(covered, footprints)
        inputs: tuple[Recipe, ...] = (image.recipe, footprints)
        filled: dict[str, Any] = {}
        if self.outside == "fill":
            inputs, filled = (*inputs, coverage), {"fill": self.fill_value}
        kind = {"between_samples": self.interpolation}
        picture = here.step(sampled, *inputs, **kind, **filled)
        table = here.step(
            geometry_table, image.recipe, footprints, strips=self.strips, **kind, **laid
        )
        along = camera.step_y_mrad
        if camera.kind != "framing":
            along = 1000.0 * (camera.line_spacing_m / camera.altitude_m)
        seen = image.with_recipe(
            picture,
            rows=camera.rows,
            columns=camera.columns,
            interval_x_mrad=camera.step_x_mrad,
            interval_y_mrad=along,
            header=Header(fov_x_deg=field_deg(camera=camera), focal_length_mm=self.focal_length_mm),
            edges=None,
        )
        return CameraOutputs(
            seen,
            seen.with_recipe(coverage, unit="", band_um=None),
            Curve(here.step(ground_curve, camera=camera)),
            Table(table),
        )

    def preview(self, planned: PlannedNode, _work: Work, _here: NodeContext) -> Preview:
        camera = self.camera(planned.sound().inputs["image"])
        curve = ground_curve(_work, camera=camera)
        across, along, *_ = curve.series
        angles, sizes = across.x, np.array([across.y, along.y])
        half = max(float(angles[-1] - angles[0]) / 2, 1e-6)
        middle = float(angles[-1] + angles[0]) / 2
        drawn = Plot(
            Axis(middle - half, middle + half, curve.x_label),
            Axis(0.0, 1.12 * float(sizes.max()), "m"),
            curves=(
                DrawnCurve(angles, sizes[0], name="across the track"),
                DrawnCurve(angles, sizes[1], 1, "dashed", name="along the track"),
            ),
        )
        return Preview(
            f"field of view {brief(field_deg(camera=camera))}°, ground sample "
            f"{pair(*_sample(camera, 0.5))} m at the centre, "
            f"{pair(*max(sizes[:, 0], sizes[:, -1], key=tuple))} m at the line's end",
            (drawn,),
        )

    def camera(self, image: Image) -> Camera:
        columns, rows = self.columns or image.columns, self.rows or image.rows
        step_x = self._step_x(columns)
        step_y = step_x
        if self.pitch_y_um is not None:
            focal_length = self.focal_length_mm
            if focal_length is None and self.pitch_x_um is not None:
                focal_length = self.pitch_x_um / step_x
            if focal_length is None:
                allowed = (
                    "pitch_y_um is given without pitch_x_um. Give pitch_x_um or a focal length"
                )
                raise ParameterError("focal_length_mm", None, allowed)
            step_y = self.pitch_y_um / focal_length
        values = self.values()
        return Camera(
            columns=columns,
            rows=rows,
            step_x_mrad=step_x,
            step_y_mrad=step_y,
            line_spacing_m=self._line_spacing_m(step_y),
            **{name: values[name] for name in _OF_CAMERA},
        )

    def _step_x(self, columns: int) -> float:
        pitch, focal_length = self.pitch_x_um, self.focal_length_mm
        of_pitch = None if pitch is None or focal_length is None else pitch / focal_length
        if self.fov_x_deg is None:
            if of_pitch is None:
                raise ParameterError(
                    "fov_x_deg", None, "give pitch_x_um and focal_length_mm, or a field of view"
                )
            return of_pitch
        step = step_of_field_mrad(kind=self.kind, fov_deg=self.fov_x_deg, columns=columns)
        if of_pitch is not None and abs(step / of_pitch - 1.0) > 1e-3:
            allowed = (
                f"pixel pitch and focal length give a sampling interval of {of_pitch:.4g} mrad, "
                f"but this field of view gives {step:.4g} mrad. Leave pitch_x_um, focal_length_mm "
                "or fov_x_deg empty"
            )
            raise ParameterError("fov_x_deg", self.fov_x_deg, allowed)
        return step

    def _line_spacing_m(self, step_y_mrad: float) -> float:
        if self.kind == "framing":
            return 0.0
        velocity, rate = self.velocity_m_per_s, self.line_rate_Hz
        if velocity is None and rate is None:
            return step_y_mrad / 1000.0 * self.altitude_m
        if rate is None:
            raise ParameterError(
                "line_rate_Hz", None, "give a line rate too, or leave velocity_m_per_s empty"
            )
        if velocity is None:
            raise ParameterError(
                "velocity_m_per_s", None, "give a ground speed too, or leave line_rate_Hz empty"
            )
        return velocity / rate

    def intervals_m(self, image: Image) -> Pair:
        x, y = self.ground_interval_m, self.ground_interval_y_m or self.ground_interval_m
        if x is None and image.interval_x_mrad is not None:
            x = image.interval_x_mrad / 1000.0 * self.altitude_m
        if y is None and image.interval_y_mrad is not None:
            y = image.interval_y_mrad / 1000.0 * self.altitude_m
        if x is None or y is None:
            allowed = (
                "the scene has no angular sampling interval. Give a sampling interval on the ground"
            )
            raise ParameterError("ground_interval_m", None, allowed)
        for name, interval, samples in (
            ("ground_interval_m", x, image.columns),
            ("ground_interval_y_m", y, image.rows),
        ):
            if not math.isfinite(interval * samples):
                raise ParameterError(
                    name, interval, "the scene's extent on the ground must be a finite number"
                )
        return x, y

    @readout("m")
    def swath_m(self, image: Image) -> float:
        """Swath width: length of the middle line on the ground."""
        return swath_m(self.camera(image))

    @readout("m")
    def gsd_x_m(self, axis: str, image: Image) -> float:
        """Ground sample distance across the track, at the centre of the frame."""
        return _sample(self.camera(image), 0.5)["xy".index(axis)]

    @readout("m")
    def gsd_edge_x_m(self, axis: str, image: Image) -> float:
        """Ground sample distance across the track, at the farther end of the middle line."""
        camera = self.camera(image)
        return max(_sample(camera, end)["xy".index(axis)] for end in (0.0, 1.0))

    @readout()
    def panoramic_factor(self, image: Image) -> float:
        """Ground sample distance across the track: farther end of the line divided by centre."""
        camera = self.camera(image)
        return max(_sample(camera, end)[0] for end in (0.0, 1.0)) / _sample(camera, 0.5)[0]

    @readout("mrad")
    def interval_x_mrad(self, axis: str, outputs: CameraOutputs) -> float | None:
        """Sampling interval across the track, at nadir."""
        image = outputs.image
        return image.interval_x_mrad if axis == "x" else image.interval_y_mrad

    @readout("m")
    def line_spacing_m(self, image: Image) -> float | None:
        """Distance flown between lines; left out for a framing camera."""
        return self.camera(image).line_spacing_m or None

    @readout()
    def lines(self, outputs: CameraOutputs) -> int:
        """Number of lines in the frame."""
        return outputs.image.rows

    figures = TableFigures(
        ("footprint_error", "", "Largest change when footprints are cut into four times as many "
         "strips, as a fraction of the scene's peak-to-peak signal."),
    )  # fmt: skip


def _sample(camera: Camera, share: float) -> tuple[float, float]:
    """Ground sample at a share of the middle line; at its ends, of the outermost sample."""
    u = min(max(share * camera.columns, 0.5), camera.columns - 0.5)
    return ground_sample(camera=camera, u=u, v=0.5 * camera.rows)


def _check_inside(camera: Camera, width_m: float, height_m: float) -> None:
    left, right, top, bottom = ground_bounds(camera=camera)
    half_x, half_y = 0.5 * width_m, 0.5 * height_m
    beyond = {
        "left": -half_x - left,
        "right": right - half_x,
        "top": -half_y - top,
        "bottom": bottom - half_y,
    }
    past = {side: by for side, by in beyond.items() if by > 1e-9 * (half_x + half_y)}
    if not past:
        return
    sides = ", ".join(f"{by:.4g} m past the {side} edge" for side, by in past.items())
    raise DataError(
        f"the scene of {2 * half_x:.5g} × {2 * half_y:.5g} m is too small: the field of view "
        f"extends {sides}; lower altitude_m, narrow the field of view, use fewer rows, enlarge "
        "ground_interval_m, or set outside = fill"
    )
