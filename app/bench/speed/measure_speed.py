"""Time that measuring a picture takes: edges, MTF and noise."""

from __future__ import annotations

import statistics
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from app.bench.measuring.bench_settings import SIZE, Settings
from app.bench.measuring.bench_tables import Table, verdict
from app.bench.measuring.timing import seconds
from app.measure.measuring import Source, measure_pictures
from app.measure.picture_measurement import MeasuredFile, PictureMeasurement

_HEADS = {
    "subject": "picture",
    "edges": "edges",
    "used": "used",
    "seconds": "s",
    "low": "least",
    "high": "most",
    "reach": "reach, s",
    "verdict": "",
}
SMALL, _LARGE = (480, 640), (4096, 4096)
_REACH_S = {SMALL: 1.0, _LARGE: 15.0}
_BLUR, _NOISE = 0.8, 0.5
_SQUARES = 4  # across, of any picture
_TURN = 0.12


def measuring(settings: Settings) -> list[Table]:
    """Edges, MTF and noise of charts with few targets and with many."""
    rows = []
    for size in (SMALL, *(() if settings.quick else (_LARGE,))):
        shape = size if settings.size >= SIZE else (settings.size, settings.size)
        picture = chart(shape, _SQUARES)
        found = _measured(picture)
        repeated = settings.slow_pairs if size == SMALL else 1
        took = [seconds(partial(_measured, picture)) for _ in range(repeated)]
        middle, reach = statistics.median(took), _REACH_S[size]
        rows.append(
            {
                "subject": f"{shape[1]} × {shape[0]}",
                "edges": len(found.edges),
                "used": sum(edge.used for edge in found.edges),
                "seconds": middle,
                "low": min(took),
                "high": max(took),
                "reach": reach,
                "verdict": verdict(middle, reach, None),
            }
        )
    text = (
        "Squares turned by 7°, blurred by 0.8 samples, with noise: search for edges, MTF across "
        "each, pooled, and the noise of the flat areas; the picture is in memory."
    )
    title = "Measuring a picture, double precision"
    return [Table("measure", title, _HEADS, tuple(rows), text, brief=tuple(_HEADS))]


def chart(shape: tuple[int, int], across: int) -> NDArray[np.float64]:
    """Turned squares in rows, their edges Gaussian of 0.8 samples, with white noise."""
    rows, columns = shape
    step = columns / across
    picture = 100.0 + _NOISE * np.random.default_rng(7).standard_normal(shape)
    half = 0.28 * step
    reach = int(0.48 * step)
    for row in np.arange(step / 2.0, rows - step / 2.0 + 1.0, step):
        for column in np.arange(step / 2.0, columns - step / 2.0 + 1.0, step):
            top, left = int(row) - reach, int(column) - reach
            own = np.s_[top : top + 2 * reach, left : left + 2 * reach]
            y, x = np.mgrid[own].astype(np.float64)
            u = (x - column) * np.cos(_TURN) + (y - row) * np.sin(_TURN)
            v = (y - row) * np.cos(_TURN) - (x - column) * np.sin(_TURN)
            picture[own] += 60.0 * _step(half - np.abs(u)) * _step(half - np.abs(v))
    return picture


def _step(away: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((1.0 + erf(away / (np.sqrt(2.0) * _BLUR))) / 2.0, np.float64)


def _measured(picture: NDArray[np.float64]) -> PictureMeasurement:
    rows, columns = picture.shape
    file = MeasuredFile("chart", 1, "")
    return measure_pictures(Source((file,), [picture], rows, columns))
