"""Studies of many points and of many pictures, beside the same loops in Python."""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Table, verdict
from app.study.carrying_out import StudyRows
from app.study.run_study import run_study
from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.network.network import Link, Network, Node
from nodes.library import standard_library

_HEADS = {
    "subject": "who computes",
    "count": "points",
    "seconds": "s",
    "processor": "processor s",
    "start": "start-up, s",
    "ms": "ms a point",
    "ratio": "× the loop",
    "reach": "reach",
    "verdict": "",
}
SIDE = 512
_LEAST_SIDE = 128
_REACH_POINTS, _REACH_SCENES = 1.3, 1.2
_FIGURES = ("electronics.snr", "electronics.netd_system_K")
_SIGMA, _SNR = ("blur", "sigma_x_mrad"), ("electronics", "amplifier_snr")


def studies(settings: Settings) -> list[Table]:
    """Both tables, by one process and by all cores."""
    side, cores = min(SIDE, settings.size), Policy().workers
    # Processes take longer to start than a quick study of small pictures to compute.
    several = [cores] if cores > 1 and side >= _LEAST_SIDE else []
    return [
        points_table(side, 8 if settings.quick else 100, (1, *several)),
        scenes_table(side, 20 if settings.quick else 1000, (1, *several)),
    ]


def sensor(side: int, scene: Node) -> Network:
    """One MTF and one noise behind a picture, whose figures are looked at."""
    nodes = [
        scene,
        Node("init", "init_trans", {"focal_length_mm": 100.0, "detector_x_um": 30.0,
                                    "detector_y_um": 30.0, "f_number": 2.0}),
        Node("blur", "gaussian_mtf", {"sigma_x_mrad": 0.1, "sigma_y_mrad": 0.1}),
        Node("back", "back_transform"),
        Node("electronics", "electronics_noise", {"cut_on_um": 3.0, "cut_off_um": 5.0,
             "d_star": 1e11, "bandwidth_Hz": 1e4, "background_K": 300.0}),
    ]  # fmt: skip
    wires = (
        ("scene.image", "init.image"), ("init.context", "blur.context"),
        ("init.magnitude", "blur.magnitude"), ("blur.magnitude", "back.magnitude"),
        ("init.phase", "back.phase"), ("back.image", "electronics.image"),
        ("init.context", "electronics.context"),
    )  # fmt: skip
    links = tuple(Link.between(*wire) for wire in wires)
    return Network(f"Sensor {side}", "", 1, {node.id: node for node in nodes}, links)


def points_table(side: int, across: int, jobs: Sequence[int]) -> Table:
    """A grid of one MTF and one noise parameter."""
    drawn = {"width": side, "height": side, "fov_x_deg": 10.0, "fov_y_deg": 10.0,
             "cut_on_um": 3.0, "cut_off_um": 5.0}  # fmt: skip
    network = sensor(side, Node("scene", "test_scene", drawn))
    sigmas = [float(value) for value in np.linspace(0.05, 0.5, across)]
    snrs = [float(value) for value in np.linspace(20.0, 200.0, across)]

    def loop() -> int:
        engine = Engine(standard_library())
        work = engine.work(Policy())
        plan = None
        for sigma in sigmas:
            blurred = network.with_parameter(*_SIGMA, sigma)
            for snr in snrs:
                plan = engine.plan(blurred.with_parameter(*_SNR, snr), previous=plan)
                _look(engine, plan, work)
        return across * across

    vary = {".".join(_SIGMA): sigmas, ".".join(_SNR): snrs}
    rows = _measured(loop, lambda n: run_study(network, vary=vary, figures=_FIGURES, jobs=n),
                     jobs, _REACH_POINTS)  # fmt: skip
    text = (
        "Every value of a Gaussian's width with every signal-to-noise ratio of the amplifier, two "
        f"figures of merit each. {_HOW}"
    )
    title = f"Study of {across * across} points, {side}², single precision"
    return Table("study_points", title, _HEADS, rows, text, brief=tuple(_HEADS))


def scenes_table(side: int, count: int, jobs: Sequence[int]) -> Table:
    """Many pictures through one chain."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        random = np.random.Generator(np.random.Philox(1))
        for number in range(count):
            np.save(f"s{number}.npy", random.uniform(5.0, 9.0, (side, side)).astype(np.float32))
        params = {"path": "s0.npy", "fov_x_deg": 10.0, "fov_y_deg": 10.0}
        network = sensor(side, Node("scene", "read_image", params))

        def loop() -> int:
            engine = Engine(standard_library())
            work = engine.work(Policy())
            plan = None
            for number in range(count):
                path = str(Path(f"s{number}.npy").absolute())
                plan = engine.plan(network.with_parameter("scene", "path", path), previous=plan)
                _look(engine, plan, work)
            return count

        over = {"scene.path": "s*.npy"}
        rows = _measured(loop, lambda n: run_study(network, over=over, figures=_FIGURES, jobs=n),
                         jobs, _REACH_SCENES)  # fmt: skip
    text = f"Each picture is a file of its own and is read once. {_HOW}"
    title = f"Study of {count} pictures, {side}², single precision"
    return Table("study_scenes", title, _HEADS, rows, text, brief=tuple(_HEADS))


_HOW = (
    "The loop plans and evaluates in Python, in one process, what the study does; the rows are the "
    "same by whoever computes them. The start of processes has a column of its own and is not in "
    "the seconds; processor seconds are those of all processes, their start among them."
)


def _look(engine: Engine, plan: Any, work: Any) -> None:
    names = [figure.rpartition(".")[2] for figure in _FIGURES]
    engine.readouts(plan, "electronics", work, names=names)


def _measured(
    loop: Callable[[], int],
    study: Callable[[int], StudyRows],
    jobs: Sequence[int],
    reach: float,
) -> tuple[dict[str, Any], ...]:
    before, used = time.perf_counter(), _processor_s()
    count = loop()
    own = time.perf_counter() - before
    rows: list[dict[str, Any]] = [
        {"subject": "loop in Python", "count": count, "seconds": own,
         "processor": _processor_s() - used, "ms": 1e3 * own / count, "ratio": 1.0}
    ]  # fmt: skip
    for processes in jobs:
        before, used = time.perf_counter(), _processor_s()
        result = study(processes)
        took = time.perf_counter() - before - result.start_s
        assert not result.failed, result.failed[0].error
        ratio = took / own
        rows.append(
            {"subject": f"study, {processes} process{'es' if processes > 1 else ''}",
             "count": count, "seconds": took, "processor": _processor_s() - used,
             "start": result.start_s or None, "ms": 1e3 * took / count, "ratio": ratio,
             "reach": reach, "verdict": verdict(ratio, reach, None)}
        )  # fmt: skip
    return tuple(rows)


def _processor_s() -> float:
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(sum(resource.getrusage(kind)[:2]) for kind in kinds)
