"""Time that measuring a picture takes, and fitting a network to one."""

import math
from functools import partial

import numpy as np
from scipy.special import erf

from app.bench.tables import Table, judged
from app.bench.timing import SIZE, Settings, repeated, sensor_network
from app.fit.chain_transfer import free_parameters
from app.fit.fit_result import FitResult
from app.fit.picture_fit import fit_pictures
from app.measure.measuring import measure_pictures
from app.measure.picture_measurement import PictureFile, PictureMeasurement
from core.arrays import Floats
from core.chain.engine import Engine
from core.evaluation.work import Policy
from nodes.library import standard_library

TIMES = {"seconds": "s", "low": "minimum", "high": "maximum", "reach": "limit, s", "verdict": ""}
SMALL, LARGE, SMALLEST = (480, 640), (4096, 4096), (128, 128)
REACH_S = {SMALL: 1.0, LARGE: 15.0}
BLUR, NOISE, TURN = 0.8, 0.5, 0.12
INTERVAL_MRAD = 0.1
FREE = (
    "blur.sigma_x_mrad=0.02:0.2",
    "blur.sigma_y_mrad=0.02:0.2",
    "detector.fill_x=0.5:1",
    "detector.fill_y=0.5:1",
)


def measuring(settings: Settings) -> list[Table]:
    rows = []
    for size in (SMALL, *(() if settings.quick else (LARGE,))):
        shape = size if settings.size >= SIZE else (settings.size, settings.size)
        picture = chart(shape, 4)
        found = _measured(picture)
        took = repeated(partial(_measured, picture), settings.slow_pairs if size == SMALL else 1)
        used = sum(edge.used for edge in found.edges)
        row = {"subject": f"{shape[1]} × {shape[0]}", "edges": len(found.edges), "used": used}
        rows.append({**row, **took, **judged(took["seconds"], REACH_S[size])})
    heads = {"subject": "picture", "edges": "edges", "used": "used", **TIMES}
    text = (
        "A picture in memory: tilted squares (7°) with Gaussian blur (σ 0.8 samples) and noise. "
        "Timed: finding the edges, measuring and pooling their MTFs, and measuring the noise of "
        "flat areas."
    )
    title = "Measuring a picture, double precision"
    return [Table("measure", title, heads, rows, text)]


def fitting(settings: Settings) -> list[Table]:
    shape, across = (SMALL, 3) if settings.size >= SIZE else (SMALLEST, 1)
    picture = chart(shape, across)
    rows = []
    for count in (len(FREE),) if settings.quick else (2, len(FREE)):
        results: list[FitResult] = []
        names = FREE[:count]
        fit = partial(_fitted, picture, names)
        took = repeated(lambda fit=fit, results=results: results.append(fit()),  # type: ignore[misc]
                        settings.slow_pairs)  # fmt: skip
        subject = ", ".join(name.partition("=")[0] for name in names)
        row = {"subject": subject, "edges": len(results[0].fit.patches)}
        rows.append({**row, **took, **judged(took["seconds"], 5.0)})
    heads = {"subject": "free parameters", "edges": "edges", **TIMES}
    text = (
        f"A chart of {shape[1]} × {shape[0]} samples. Timed: finding the edges and fitting the "
        "network to them."
    )
    return [Table("fit", "Fitting a network to a picture", heads, rows, text)]


def chart(shape: tuple[int, int], across: int) -> Floats:
    """Turned squares in rows, their edges Gaussian of 0.8 samples, with white noise."""
    rows, columns = shape
    step = columns / across
    picture = 100.0 + NOISE * np.random.default_rng(7).standard_normal(shape)
    half, reach = 0.28 * step, int(0.48 * step)
    for row in np.arange(step / 2.0, rows - step / 2.0 + 1.0, step):
        for column in np.arange(step / 2.0, columns - step / 2.0 + 1.0, step):
            top, left = int(row) - reach, int(column) - reach
            own = np.s_[top : top + 2 * reach, left : left + 2 * reach]
            y, x = np.mgrid[own].astype(np.float64)
            u = (x - column) * np.cos(TURN) + (y - row) * np.sin(TURN)
            v = (y - row) * np.cos(TURN) - (x - column) * np.sin(TURN)
            picture[own] += 60.0 * _step(half - np.abs(u)) * _step(half - np.abs(v))
    return picture


def _step(away: Floats) -> Floats:
    return np.asarray((1.0 + erf(away / (np.sqrt(2.0) * BLUR))) / 2.0, np.float64)


def _measured(picture: Floats) -> PictureMeasurement:
    return measure_pictures([PictureFile.of("chart", [picture])])


def _fitted(picture: Floats, names: tuple[str, ...]) -> FitResult:
    library = standard_library()
    field_deg = 2.0 * math.degrees(math.atan(64 * INTERVAL_MRAD / 2000.0))
    scene = {"width": 64, "height": 64, "fov_x_deg": field_deg, "fov_y_deg": field_deg}
    init = {
        "detector_x_um": 10.0, "detector_y_um": 10.0, "f_number": 4.0,
        "focal_length_mm": 10.0 / INTERVAL_MRAD, "platform": "array",
    }  # fmt: skip
    blur = {"sigma_x_mrad": 0.5 * INTERVAL_MRAD, "sigma_y_mrad": 0.5 * INTERVAL_MRAD}
    detector = {"fill_x": 0.9, "fill_y": 0.9}
    stages = {"blur": ("gaussian_mtf", blur), "detector": ("detector_mtf", detector)}
    network = sensor_network(("test_scene", scene), init, stages)
    engine = Engine(library)
    free = free_parameters(names, network, library)
    pictures = [PictureFile.of("chart", [picture])]
    plan, work = engine.plan(network), engine.work(Policy())
    return fit_pictures(engine, plan, work, free=free, pictures=pictures)


MEASURES = (measuring, fitting)
