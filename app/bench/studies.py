"""Studies of many points and of many pictures, beside the same loops in Python."""

import resource
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np

from app.bench.tables import Table, verdict
from app.bench.timing import Settings, sensor_network
from app.study.study_request import run_study
from app.study.study_rows import StudyRows
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.network import Network
from nodes.library import standard_library

HEADS = {
    "subject": "program", "count": "points", "seconds": "s", "processor": "processor s",
    "start": "start-up, s", "ms": "ms per point", "ratio": "× the loop", "reach": "limit",
    "verdict": "",
}  # fmt: skip
HOW = (
    "The Python loop computes the same points as the study, one after another in one process; "
    "both give the same rows. The start-up time of the processes has its own column and is not "
    "included in the seconds; processor seconds include all processes and their start-up."
)
SIDE, LEAST_SIDE = 512, 128
FIGURES = ("electronics.snr", "electronics.netd_system_K")
FIELD = {"fov_x_deg": 10.0, "fov_y_deg": 10.0}


def studies(settings: Settings) -> list[Table]:
    side, cores = min(SIDE, settings.size), Policy().workers
    # Processes take longer to start than a quick study of small pictures to compute.
    several = [cores] if cores > 1 and side >= LEAST_SIDE else []
    return [
        points_table(side, 8 if settings.quick else 100, (1, *several)),
        scenes_table(side, 20 if settings.quick else 1000, (1, *several)),
    ]


def points_table(side: int, across: int, jobs: Sequence[int]) -> Table:
    scene = {"width": side, "height": side, **FIELD, "cut_on_um": 3.0, "cut_off_um": 5.0}
    network = _sensor("test_scene", scene)
    sigmas = np.linspace(0.05, 0.5, across).tolist()
    snrs = np.linspace(20.0, 200.0, across).tolist()

    def variants() -> Iterator[Network]:
        for sigma in sigmas:
            blurred = network.with_parameter("blur", "sigma_x_mrad", sigma)
            for snr in snrs:
                yield blurred.with_parameter("electronics", "amplifier_snr", snr)

    vary = {"blur.sigma_x_mrad": sigmas, "electronics.amplifier_snr": snrs}
    asked: dict[str, Any] = {"vary": vary, "figures": FIGURES}
    rows = _measured(variants, lambda n: run_study(network, jobs=n, **asked), jobs, 1.3)
    text = (
        "Every combination of a Gaussian's width and the amplifier's signal-to-noise ratio, with "
        f"two figures of merit at each point. {HOW}"
    )
    title = f"Study of {across * across} points, {side}², single precision"
    return Table("study_points", title, HEADS, rows, text)


def scenes_table(side: int, count: int, jobs: Sequence[int]) -> Table:
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        random = np.random.Generator(np.random.Philox(1))
        for number in range(count):
            np.save(f"s{number}.npy", random.uniform(5.0, 9.0, (side, side)).astype(np.float32))
        network = _sensor("read_image", {"path": "s0.npy", **FIELD})

        def variants() -> Iterator[Network]:
            for number in range(count):
                path = str(Path(f"s{number}.npy").absolute())
                yield network.with_parameter("scene", "path", path)

        asked: dict[str, Any] = {"over": ["scene.path=s*.npy"], "figures": FIGURES}
        rows = _measured(variants, lambda n: run_study(network, jobs=n, **asked), jobs, 1.2)
    text = f"Each picture is a separate file and is read once. {HOW}"
    title = f"Study of {count} pictures, {side}², single precision"
    return Table("study_scenes", title, HEADS, rows, text)


def _sensor(source: str, scene: dict[str, Any]) -> Network:
    init = {"focal_length_mm": 100.0, "detector_x_um": 30.0, "detector_y_um": 30.0, "f_number": 2.0}
    noise = {
        "cut_on_um": 3.0, "cut_off_um": 5.0, "d_star": 1e11, "bandwidth_Hz": 1e4,
        "background_K": 300.0,
    }  # fmt: skip
    blur = {"sigma_x_mrad": 0.1, "sigma_y_mrad": 0.1}
    behind = {"electronics": ("electronics_noise", noise)}
    return sensor_network((source, scene), init, {"blur": ("gaussian_mtf", blur)}, behind)


def _measured(
    variants: Callable[[], Iterator[Network]],
    study: Callable[[int], StudyRows],
    jobs: Sequence[int],
    reach: float,
) -> tuple[dict[str, Any], ...]:
    before, used = time.perf_counter(), _processor_s()
    engine = Engine(standard_library())
    work = engine.work(Policy())
    names = [figure.rpartition(".")[2] for figure in FIGURES]
    count, plan = 0, None
    for network in variants():
        plan = engine.plan(network, previous=plan)
        engine.readouts(plan, "electronics", work, names=names)
        count += 1
    own = time.perf_counter() - before
    row: dict[str, Any] = {"subject": "Python loop", "count": count, "seconds": own}
    rows = [row | {"processor": _processor_s() - used, "ms": 1e3 * own / count, "ratio": 1.0}]
    for processes in jobs:
        before, used = time.perf_counter(), _processor_s()
        result = study(processes)
        took = time.perf_counter() - before - result.start_s
        assert not result.failed, result.failed[0].error
        who = f"study, {processes} process{'es' if processes > 1 else ''}"
        row = {"subject": who, "count": count, "seconds": took, "ms": 1e3 * took / count}
        row |= {"processor": _processor_s() - used, "start": result.start_s or None}
        row |= {"ratio": took / own, "reach": reach, "verdict": verdict(took / own, reach)}
        rows.append(row)
    return tuple(rows)


def _processor_s() -> float:
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(sum(resource.getrusage(kind)[:2]) for kind in kinds)


MEASURES = (studies,)
