"""A network's scene moved and scaled before anything of the chain has blurred or sampled it.

A picture that was sampled cannot be moved by a part of a sample: what has folded below the Nyquist
frequency would turn with it the wrong way. So where the chain samples more coarsely than its
source, the source is moved, between its fine samples by splines of the fifth order (Unser 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.fit.known_scene.scene_match import Registration
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.evaluation.recipes import Step, ends_lineage
from core.evaluation.work import Work
from core.lineage.step_lineage import source_step

Matrix = NDArray[np.float64]

_ORDER = 5
_OUTSIDE = "reflect"  # as the frame goes on in the chain


@ends_lineage
def spline_factors(work: Work, scene: NDArray[np.floating]) -> Matrix:  # noqa: ARG001
    """Factors of the splines through a scene's samples."""
    from scipy import ndimage

    values = np.asarray(scene, np.float64)
    return np.asarray(ndimage.spline_filter(values, _ORDER, mode=_OUTSIDE), np.float64)


@source_step(area_means=True)
def moved_scene(
    work: Work, factors: Matrix, *, shift_x: float, shift_y: float, scale: float
) -> NDArray[np.floating]:
    """The scene moved right and down by so many of its samples, and scaled about its middle."""
    from scipy import ndimage

    middle = (np.array(factors.shape) - 1.0) / 2.0
    start = middle - (middle + np.array([shift_y, shift_x])) / scale
    moved = ndimage.affine_transform(
        factors, np.full(2, 1.0 / scale), start, order=_ORDER, mode=_OUTSIDE, prefilter=False
    )
    return np.asarray(moved, work.policy.dtype)


@dataclass(frozen=True)
class FineSource:
    """The source of a network whose final picture has fewer samples.

    Parameters
    ----------
    engine : Engine
        Plans the network.
    port : str
        ``NODE.PORT`` of the source.
    ratio : (float, float)
        Its samples for one of the final picture, across and down.
    """

    engine: Engine
    port: str
    ratio: tuple[float, float]

    def moved(self, plan: Plan, how: Registration) -> Plan:
        """The network planned with its scene where a real picture has it."""
        node, _, output = self.port.rpartition(".")
        scene: Image = plan.output(self.port)
        recipe = Step.of(
            moved_scene,
            Step.of(spline_factors, scene.recipe, node=node),
            node=node,
            shift_x=how.shift_x * self.ratio[0],
            shift_y=how.shift_y * self.ratio[1],
            scale=how.scale,
        )
        source = plan.node(node)
        held = replace(source, outputs={**source.outputs, output: scene.with_recipe(recipe)})
        return self.engine.plan(plan.network, folder=plan.folder, previous=plan, held={node: held})


def fine_source(
    engine: Engine, plan: Plan, *, sources: Sequence[str], final: Image
) -> FineSource | str | None:
    """The source that is to be moved; None where the final picture can be moved just as well.

    Where there is a finer source that cannot be moved, why not, in words.
    """
    images = [plan.output(port) for port in sources]
    if all(image.shape == final.shape for image in images):
        return None
    if len(images) != 1:
        return f"the final picture stems from {len(images)} pictures"
    if images[0].bands is not None:
        return f"{sources[0]} has bands of wavelength"
    rows, columns = images[0].shape
    ratio = columns / final.columns, rows / final.rows
    return FineSource(engine, sources[0], ratio)
