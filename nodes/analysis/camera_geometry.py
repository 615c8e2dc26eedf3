"""Camera Geometry: a wider scene as a line scanner, a pushbroom or a framing camera samples it."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from core.chain.wires import Curve, Header, Image, Table
from core.errors import DataError
from core.evaluation.recipes import Recipe
from core.modules.declaration import NodeContext, readout
from core.modules.panel_sections import Section
from core.modules.parameters import Formula, Param
from core.physics.measurement.levels.photon_transfer import Between
from core.physics.sampling.ground_geometry import (
    Camera,
    check_horizon,
    field_deg,
    ground_bounds,
    ground_sample,
)
from nodes.analysis.camera_sampling import (
    CameraSettings,
    Ground,
    covered,
    geometry_table,
    ground_curve,
    laid_footprints,
    sampled,
    swath_m,
)
from nodes.shared.module_ports import table_figure


class CameraOutputs(NamedTuple):
    """The picture, what of its samples lies on the scene, and where they lie."""

    image: Image
    coverage: Image
    curve: Curve
    table: Table


class CameraGeometry(
    CameraSettings, key="camera_geometry", title="Camera Geometry", group="Analysis"
):
    """Sample a wider scene on flat ground as a line scanner, pushbroom or framing camera does.

    The scene has equal steps on the ground, its middle below the camera. A line scanner takes
    equal angles, so that its samples grow as sec² across and sec along (panoramic distortion); a
    pushbroom and a framing camera take equal steps in the focal plane. Lines are flown down the
    picture, equally far apart on the ground. Each sample is the mean of the scene over its whole
    footprint, so that nothing aliases and a uniform scene stays uniform. Blur comes after: choose
    samples finer than the detector, and combine pixels behind the detector's MTF.
    Footprints are exact where they lie along the scene's rows or columns, as without yaw; of a
    framing camera with roll or pitch alone to 10⁻⁴ of the scene's range. Else they lie askew and
    are cut into `strips`, with the error estimated.

    Source: Tantalo 1996, sections 2 and 5.3, for the Salacain camera.
    """

    formulas = (
        Formula(
            r"x=h\,\tan\theta,\quad\frac{dx}{d\theta}=\frac{h}{\cos^2\theta},\quad\frac{dy}{d"
            r"\phi}=\frac{h}{\cos\theta}",
            where="h: altitude; θ: view angle across; the samples of a line scanner grow so "
            "across and along",
        ),
        Formula(
            r"L'_{jk}=\frac{1}{|A_{jk}|}\iint_{A_{jk}}L\,dx\,dy",
            where="A: footprint of a sample on the ground",
        ),
    )

    interpolation: Annotated[
        Between,
        Param("between the scene's samples: level areas, straight, or parabolas"),
    ] = "area"
    strips: Annotated[
        int, Param("strips a footprint is cut into where it lies askew", low=1, high=64)
    ] = 4
    outside: Annotated[Literal["refuse", "fill"], Param("where the camera sees past the scene")] = (
        "refuse"
    )
    fill_value: Annotated[float, Param("what is there, in the scene's unit")] = 0.0

    illustration = "ground_sampling"
    panel = (
        Section("Camera", ("kind", "altitude_m", "columns", "rows"), page="Camera"),
        Section(
            "Samples", ("fov_x_deg", "pitch_x_um", "pitch_y_um", "focal_length_mm"), page="Camera"
        ),
        Section(
            "Flight",
            ("velocity_m_per_s", "line_rate_Hz"),
            page="Camera",
            shown_when=("kind", ("line", "pushbroom")),
        ),
        Section("Attitude", ("roll_deg", "pitch_deg", "yaw_deg"), page="Attitude"),
        Section(
            "Scene",
            ("ground_interval_m", "ground_interval_y_m", "offset_x_m", "offset_y_m"),
            page="Scene",
        ),
        Section("Sampling", ("interpolation", "strips", "outside"), page="Scene"),
        Section("", ("fill_value",), page="Scene", shown_when=("outside", ("fill",))),
    )

    def run(self, image: Image, here: NodeContext) -> CameraOutputs:
        """Plan the sampling."""
        camera, ground = self.camera(image), self.ground(image)
        check_horizon(camera=camera)
        self._check_inside(camera, ground)
        laid: dict[str, Any] = {"camera": camera, "ground": ground}
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

    def _check_inside(self, camera: Camera, ground: Ground) -> None:
        """Refuse a scene that is too small."""
        if self.outside == "fill":
            return
        bounds, (half_x, half_y) = ground_bounds(camera=camera), ground.reach_m
        beyond = {
            "left": -half_x - bounds.left,
            "right": bounds.right - half_x,
            "top": -half_y - bounds.top,
            "bottom": bounds.low - half_y,
        }
        past = {side: by for side, by in beyond.items() if by > 1e-9 * (half_x + half_y)}
        if not past:
            return
        sides = ", ".join(f"{by:.4g} m past its {side}" for side, by in past.items())
        raise DataError(
            f"the scene of {2 * half_x:.5g} × {2 * half_y:.5g} m is too small: the camera sees "
            f"{sides}; take a lower altitude_m, a smaller field, fewer rows, a larger "
            "ground_interval_m, or outside = fill"
        )

    @readout("m")
    def swath_m(self, image: Image) -> float:
        """Ground that the middle line shows, from end to end."""
        return swath_m(self.camera(image))

    @readout("m")
    def gsd_x_m(self, image: Image) -> float:
        """Ground sample across, in the middle of the frame."""
        return _sample(self.camera(image), 0.5)[0]

    @readout("m")
    def gsd_y_m(self, image: Image) -> float:
        """Ground sample along, in the middle of the frame."""
        return _sample(self.camera(image), 0.5)[1]

    @readout("m")
    def gsd_edge_x_m(self, image: Image) -> float:
        """Ground sample across, at the farther end of the middle line."""
        return max(_sample(self.camera(image), end)[0] for end in (0.0, 1.0))

    @readout("m")
    def gsd_edge_y_m(self, image: Image) -> float:
        """Ground sample along, at the farther end of the middle line."""
        return max(_sample(self.camera(image), end)[1] for end in (0.0, 1.0))

    @readout()
    def panoramic_factor(self, image: Image) -> float:
        """Ground sample across at the farther end over that in the middle."""
        camera = self.camera(image)
        return max(_sample(camera, end)[0] for end in (0.0, 1.0)) / _sample(camera, 0.5)[0]

    @readout("mrad")
    def interval_x_mrad(self, outputs: CameraOutputs) -> float | None:
        """Sampling interval across, at nadir."""
        return outputs.image.interval_x_mrad

    @readout("mrad")
    def interval_y_mrad(self, outputs: CameraOutputs) -> float | None:
        """Sampling interval along, at nadir."""
        return outputs.image.interval_y_mrad

    @readout("m")
    def line_spacing_m(self, image: Image) -> float | None:
        """Distance flown from one line to the next; none for a framing camera."""
        return self.camera(image).line_spacing_m or None

    @readout()
    def lines(self, outputs: CameraOutputs) -> int:
        """Lines of the frame."""
        return outputs.image.rows

    footprint_error = table_figure(
        "footprint_error",
        "",
        "Largest change by four times as many strips, a share of the scene's range.",
    )


def _sample(camera: Camera, share: float) -> tuple[float, float]:
    """Ground sample at a share of the middle line; at its ends, of the outermost sample."""
    u = min(max(share * camera.columns, 0.5), camera.columns - 0.5)
    return ground_sample(camera=camera, u=u, v=0.5 * camera.rows)
