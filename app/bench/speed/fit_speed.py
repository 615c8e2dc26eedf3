"""Time that fitting a network to a picture takes."""

from __future__ import annotations

import json
import math
import statistics
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import SIZE, Settings
from app.bench.measuring.bench_tables import Table, verdict
from app.bench.measuring.timing import seconds
from app.bench.speed.measure_speed import SMALL, chart
from app.fit.fit_result import FitResult
from app.fit.free_parameter import FreeParameter, free_parameters
from app.fit.picture_fit import FittedPictures, fit_pictures
from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.network.parsing import parse_network
from nodes.library import standard_library

_HEADS = {
    "subject": "free parameters",
    "edges": "edges",
    "seconds": "s",
    "low": "least",
    "high": "most",
    "reach": "reach, s",
    "verdict": "",
}
_SMALLEST = (128, 128)  # that has an edge to be fitted to
_REACH_S = 5.0
_INTERVAL_MRAD = 0.1
_FREE = (
    "blur.sigma_x_mrad=0.02:0.2",
    "blur.sigma_y_mrad=0.02:0.2",
    "detector.fill_x=0.5:1",
    "detector.fill_y=0.5:1",
)


def fitting(settings: Settings) -> list[Table]:
    """Two parameters and four, of a chain of a Gaussian blur and a pixel."""
    shape, across = (SMALL, 3) if settings.size >= SIZE else (_SMALLEST, 1)
    picture = chart(shape, across)
    rows = []
    for count in (len(_FREE),) if settings.quick else (2, len(_FREE)):
        results: list[FitResult] = []
        took = [
            seconds(lambda names=_FREE[:count], kept=results: kept.append(_fitted(picture, names)))  # type: ignore[misc]
            for _ in range(settings.slow_pairs)
        ]
        middle = statistics.median(took)
        rows.append(
            {
                "subject": ", ".join(name.partition("=")[0] for name in _FREE[:count]),
                "edges": len(results[0].fit.patches),
                "seconds": middle,
                "low": min(took),
                "high": max(took),
                "reach": _REACH_S,
                "verdict": verdict(middle, _REACH_S, None),
            }
        )
    text = (
        f"A chart of {shape[1]} × {shape[0]} samples: its edges searched for, and the fit to them."
    )
    return [Table("fit", "Fitting a network to a picture", _HEADS, tuple(rows), text,
                  brief=tuple(_HEADS))]  # fmt: skip


def _fitted(picture: NDArray[np.float64], names: tuple[str, ...]) -> FitResult:
    library = standard_library()
    network = parse_network(json.dumps(_network()), library=library)
    free: tuple[FreeParameter, ...] = free_parameters(names, network, library)
    engine = Engine(library)
    return fit_pictures(
        engine,
        engine.plan(network),
        engine.work(Policy()),
        free=free,
        pictures=FittedPictures(("chart",), (picture,)),
    )


def _network() -> dict[str, Any]:
    fov_deg = 2.0 * math.degrees(math.atan(64 * _INTERVAL_MRAD / 2000.0))
    scene = {"width": 64, "height": 64, "fov_x_deg": fov_deg, "fov_y_deg": fov_deg}
    init = {
        "detector_x_um": 10.0, "detector_y_um": 10.0, "f_number": 4.0,
        "focal_length_mm": 10.0 / _INTERVAL_MRAD, "platform": "array",
    }  # fmt: skip
    blur = {"sigma_x_mrad": 0.5 * _INTERVAL_MRAD, "sigma_y_mrad": 0.5 * _INTERVAL_MRAD}
    nodes = {
        "scene": {"module": "test_scene", "params": scene},
        "init": {"module": "init_trans", "params": init},
        "blur": {"module": "gaussian_mtf", "params": blur},
        "detector": {"module": "detector_mtf", "params": {"fill_x": 0.9, "fill_y": 0.9}},
        "back": {"module": "back_transform", "params": {}},
    }
    links = [
        ["scene.image", "init.image"],
        ["init.context", "blur.context"],
        ["init.magnitude", "blur.magnitude"],
        ["init.context", "detector.context"],
        ["blur.magnitude", "detector.magnitude"],
        ["detector.magnitude", "back.magnitude"],
        ["init.phase", "back.phase"],
    ]
    return {
        "format": "imagechain-network", "version": 1, "name": "Fitted", "seed": 1,
        "nodes": nodes, "links": links,
    }  # fmt: skip
