"""Steps of Camera Geometry: footprints on the scene, the picture, and figures of both."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.results import CurveData, Series, TableData, TableRow
from core.evaluation.recipes import ends_lineage, in_blocks
from core.evaluation.work import Work
from core.physics.measurement.levels.sample_sums import Between
from core.physics.sampling.footprint_means import footprint_coverage, footprint_means, strips_error
from core.physics.sampling.footprints import Footprints, footprints
from core.physics.sampling.ground_geometry import (
    Camera,
    across,
    along,
    ground_bounds,
    ground_matrix,
    ground_points,
    ground_sample,
    line_widths,
    view_angles,
)
from nodes.analysis.camera.camera_settings import Ground

Array = NDArray[Any]
FINER = 4  # times as many strips, to estimate the error
CURVE_POINTS = 129


@ends_lineage
def laid_footprints(_: Work, *, camera: Camera, ground: Ground, strips: int) -> Footprints:
    """The camera's footprints on the scene."""
    return _laid(camera, ground, strips)


def _laid(camera: Camera, ground: Ground, strips: int) -> Footprints:
    to_samples = np.array(
        [
            [1.0 / ground.interval_x_m, 0.0, 0.5 * ground.columns],
            [0.0, 1.0 / ground.interval_y_m, 0.5 * ground.rows],
            [0.0, 0.0, 1.0],
        ]
    )
    u, v = np.arange(camera.columns + 1.0), np.arange(camera.rows + 1.0)
    return footprints(
        matrix=to_samples @ ground_matrix(camera=camera),
        across=across(camera=camera, u=u),
        along=along(camera=camera, v=v),
        middles=along(camera=camera, v=v[:-1] + 0.5),
        widths=line_widths(camera=camera, u=u[:-1] + 0.5),
        scene=(ground.rows, ground.columns),
        strips=strips,
    )


@in_blocks()
@ends_lineage
def covered(work: Work, laid: Footprints) -> Array:
    """Share of each footprint that lies on the scene."""
    return footprint_coverage(
        laid=laid, dtype=work.policy.dtype, for_each=work.for_each, empty=work.empty
    )


@in_blocks()
@ends_lineage
def sampled(
    work: Work,
    scene: Array,
    laid: Footprints,
    coverage: Array | None = None,
    *,
    between_samples: Between,
    fill: float = 0.0,
) -> Array:
    """Mean of the scene over each footprint, and of the fill outside."""
    return footprint_means(
        scene=scene,
        laid=laid,
        between_samples=between_samples,
        dtype=work.policy.dtype,
        coverage=coverage,
        fill=fill,
        for_each=work.for_each,
        empty=work.empty,
    )


def swath_m(camera: Camera) -> float:
    """Length of the middle line on the ground."""
    x, y = ground_points(camera=camera, u=[0.0, camera.columns], v=0.5 * camera.rows)
    return float(np.hypot(x[1] - x[0], y[1] - y[0]))


@ends_lineage
def ground_curve(_: Work, *, camera: Camera) -> CurveData:
    """Ground samples along the middle line, against the view angle."""
    count = min(camera.columns, CURVE_POINTS)
    u = np.linspace(0.5, camera.columns - 0.5, count)
    samples = [ground_sample(camera=camera, u=float(column), v=0.5 * camera.rows) for column in u]
    angles = np.degrees(view_angles(camera=camera, u=u))
    series = [
        Series("across", angles, np.array([sample.across_m for sample in samples])),
        Series("along", angles, np.array([sample.along_m for sample in samples])),
    ]
    if camera.kind != "framing":
        series.append(Series("line spacing", angles, np.full(count, camera.line_spacing_m)))
    axis = "from the optical axis" if camera.kind == "framing" else "view angle"
    return CurveData("Ground sample", f"{axis} (deg)", "size (m)", tuple(series))


@in_blocks()
@ends_lineage
def geometry_table(
    _: Work,
    scene: Array,
    laid: Footprints,
    *,
    camera: Camera,
    ground: Ground,
    strips: int,
    between_samples: Between,
) -> TableData:
    """What the camera sees of the ground, and how precise the means over footprints are."""
    bounds = ground_bounds(camera=camera)
    middle = ground_sample(camera=camera, u=0.5 * camera.columns, v=0.5 * camera.rows)
    error = 0.0
    if not laid.level:
        finer = _laid(camera, ground, FINER * strips)
        error = strips_error(scene=scene, laid=laid, finer=finer, between_samples=between_samples)
    return TableData(
        (
            TableRow("swath_m", swath_m(camera), "m", "ground along the middle line"),
            TableRow("left_m", bounds.left, "m", "ground seen, from the scene's middle"),
            TableRow("right_m", bounds.right, "m", "ground seen, from the scene's middle"),
            TableRow("top_m", bounds.top, "m", "ground seen, from the scene's middle"),
            TableRow("bottom_m", bounds.low, "m", "ground seen, from the scene's middle"),
            TableRow(
                "scene_samples_x",
                middle.across_m / ground.interval_x_m,
                "",
                "the scene's samples to one of the middle's, across",
            ),
            TableRow(
                "scene_samples_y",
                middle.along_m / ground.interval_y_m,
                "",
                "the scene's samples to one of the middle's, along",
            ),
            TableRow("strips", laid.strips, "", "that a footprint is cut into"),
            TableRow(
                "footprint_error",
                error,
                "",
                "largest change by four times as many strips, a share of the scene's range",
            ),
        )
    )
