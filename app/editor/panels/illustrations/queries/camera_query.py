"""The query of a Camera Geometry node's view of the ground."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

from app.editor.evaluation.queries import Passing, Query
from core.chain.engine import Plan
from core.physics.sampling.ground_geometry import Camera


@dataclass(frozen=True)
class CameraQuery(Query):
    """The camera, with what its panel leaves empty worked out; None of a disabled node."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        """The camera."""
        return _camera(plan, self.node)

    def answer(self, passing: Passing) -> Camera | None:
        """The camera."""
        return _camera(passing.plan, self.node)


def _camera(plan: Plan, node: str) -> Camera | None:
    planned = plan.node(node)
    if planned.error is not None:
        raise planned.error
    if planned.node.disabled:
        return None
    module: Any = planned.module
    camera: Camera = module.camera(planned.inputs["image"])
    return camera
