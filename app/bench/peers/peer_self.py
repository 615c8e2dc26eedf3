"""The task for other programs, done by this one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.loaded_network import SCENE, SceneStore, network_of
from app.bench.peers.peer_programs import Deliver, Noted, Task
from core.chain.engine import Engine
from core.evaluation.policy import Policy, Precision
from core.network.network import Network
from core.transfer.factors import Planar
from core.transfer.planar_blocks import Axes, Known
from nodes.library import standard_library

Array = NDArray[Any]
PUPIL_SAMPLES = 512
LINKS = (
    ("scene.image", "init.image"),
    ("init.context", "optics.context"),
    ("init.magnitude", "optics.magnitude"),
    ("init.phase", "optics.phase"),
    ("pupil.pupil", "optics.pupil"),
    ("init.context", "pixel.context"),
    ("optics.magnitude", "pixel.magnitude"),
    ("pixel.magnitude", "back.magnitude"),
    ("optics.phase", "back.phase"),
)


def _network(task: Task, edges: str) -> Network:
    across = float(np.degrees(task.size * task.interval_mrad * 1e-3))
    array_cm = 0.2 * task.aperture_mm
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "scene": (
            "test_scene",
            {"kind": "uniform", "width": task.size, "height": task.size,
             "fov_x_deg": across, "fov_y_deg": across},
        ),
        "init": (
            "init_trans",
            {"focal_length_mm": task.focal_length_mm, "detector_x_um": task.pixel_um,
             "detector_y_um": task.pixel_um, "edges": edges},
        ),
        "pupil": (
            "exit_pupil",
            {"size_x": PUPIL_SAMPLES, "size_y": PUPIL_SAMPLES, "radius": PUPIL_SAMPLES / 4},
        ),
        "optics": (
            "exit_pupil_mtf",
            {"cut_on_um": task.wavelength_um, "cut_off_um": task.wavelength_um,
             "size_x_cm": array_cm, "size_y_cm": array_cm},
        ),
        "pixel": ("detector_mtf", {}),
        "back": ("back_transform", {}),
    }  # fmt: skip
    return network_of(nodes, LINKS)


def chain(edges: str, precision: Precision, *, known: bool = False) -> Callable[[Task], Deliver]:
    """The frame through aperture and pixel; nothing computed before, or the OTF known."""

    def build(task: Task) -> Deliver:
        network = _network(task, edges)
        store = SceneStore()
        engine = Engine(standard_library(), store)
        work = engine.work(Policy(precision=precision))
        plan = engine.plan(network)
        key = f"{plan.output(SCENE).recipe.key}/{work.policy.key}"
        factor = plan.output("optics.mtf").factors[0]
        assert isinstance(factor, Planar)
        grid = plan.output("init.context").grid
        note = ""
        if known:
            axes: Axes = "mirrored" if edges == "reflect" else "periodic"
            known_plane = work.value(Known(factor, grid, axes, node=factor.node))
            note = known_plane.description
        keys = store.keys()

        def deliver(frame: Array) -> Array:
            store.forget_all_but(keys)
            store.hold(key, frame.astype(work.policy.dtype, copy=False))
            return np.asarray(engine.value(engine.plan(network), "back.image", work))

        return Noted(deliver, note)

    return build


OURS: tuple[tuple[str, Callable[[Task], Deliver]], ...] = (
    ("Imagechain, periodic", chain("periodic", "single")),
    ("Imagechain, periodic, known", chain("periodic", "single", known=True)),
    ("Imagechain, periodic, double", chain("periodic", "double")),
    ("Imagechain, mirrored", chain("reflect", "single")),
    ("Imagechain, mirrored, known", chain("reflect", "single", known=True)),
)
