"""Camera Geometry: how the ground sample grows with the view angle."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.chart import Axis, Chart, brief, pair
from app.editor.panels.illustrations.illustration import Illustration, NodeQuery
from core.chain.engine import PlannedNode
from core.physics.sampling.ground_geometry import Camera, field_deg, ground_sample, view_angles

_POINTS = 65
_ENDS = ((Qt.PenStyle.SolidLine, "across"), (Qt.PenStyle.DashLine, "along"))


def camera_of(planned: PlannedNode, _passing: Passing) -> Camera:
    """The camera, with what its panel leaves empty worked out."""
    module: Any = planned.module
    camera: Camera = module.camera(planned.inputs["image"])
    return camera


CameraQuery = partial(NodeQuery, made=camera_of, ports=("image",))


class CameraIllustration(Illustration):
    """Ground samples across and along, from one end of the middle line to the other."""

    lines = 10.5

    def queries(self) -> Sequence[Query]:
        return (CameraQuery(self.node),)

    def keep(self, camera: Camera) -> str:
        self._camera = camera
        self._u = np.linspace(0.5, camera.columns - 0.5, _POINTS)
        samples = [ground_sample(camera=camera, u=u, v=0.5 * camera.rows) for u in self._u.tolist()]
        self._sizes = np.array(samples).T
        middle, end = samples[_POINTS // 2], max(samples[0], samples[-1])
        return (
            f"field {brief(field_deg(camera=camera))}°, ground sample {pair(*middle)} m in the "
            f"middle, {pair(*end)} m at the end"
        )

    def draw(self, painter: QPainter, area: QRectF) -> None:
        angles = np.degrees(view_angles(camera=self._camera, u=self._u))
        end = max(float(angles[-1] - angles[0]) / 2, 1e-6)
        middle = float(angles[-1] + angles[0]) / 2
        framing = self._camera.kind == "framing"
        title = "from the optical axis (deg)" if framing else "from nadir (deg)"
        across = Axis(middle - end, middle + end, title)
        along = Axis(0.0, 1.12 * float(self._sizes.max()), "m")
        chart = Chart(painter, area, across, along, self.theme)
        colours = self.theme.curves[:2]
        chart.legend(
            [(name, colour, style) for colour, (style, name) in zip(colours, _ENDS, strict=True)]
        )
        for size, colour, (style, _) in zip(self._sizes, colours, _ENDS, strict=True):
            chart.curve(angles, size, colour, style)
