"""The choice of evaluating a pupil's OTF at every frequency, or by thin matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.kodak import Kodak
from app.bench.pupil_otf import ROWS_AT_ONCE, SHAPES, Otf, expected_at, places_of, pupil_network
from app.bench.settings import Settings
from app.bench.tables import Chart, Table
from app.bench.timing import paired, round_trip

Array = NDArray[Any]


def low_rank(settings: Settings) -> list[Table]:
    """Thin matrices against evaluating the closed form at every frequency."""
    kodak = Kodak(settings.small)
    rows = []
    pairs = 2 if settings.quick else 5
    for shape in SHAPES:
        otf = Otf(kodak, pupil_network(kodak.network, shape, 512))
        factor = otf.factor
        size = len(kodak.scene)
        every, planes = np.arange(size), otf.planes(factor)
        thin = np.concatenate([
            np.asarray(planes.block(slice(start, start + ROWS_AT_ONCE)))
            for start in range(0, size, ROWS_AT_ONCE)
        ])  # fmt: skip
        direct = otf.at(every[:, np.newaxis], every[np.newaxis, :])
        places = places_of(size)
        expected = expected_at(shape, otf.lags_mm(*places))
        for choice, plane, subject in (
            ("direct", direct, otf.direct),
            ("low rank", thin, otf.low_rank),
            ("low rank, known", thin, otf.known),
        ):
            t0 = round_trip(kodak.scene, kodak.policy.workers)
            rows.append(
                {
                    "shape": shape,
                    "choice": choice,
                    "mark": choice if shape == "clear" else None,
                    **paired(subject, t0, pairs=pairs, warm_up=1).facts(),
                    "error": float(np.abs(plane[places] - expected).max()),
                    "from_direct": float(np.abs(plane - direct).max()),
                }
            )
    heads = {
        "shape": "pupil",
        "choice": "OTF plane",
        "t0": "T0",
        "ms": "ms",
        "error": "error at points",
        "from_direct": "difference, whole plane",
    }
    text = (
        "Default low rank in single precision, whose rounding covers its error: found once, it is "
        "kept, and a later picture takes the matrix product alone (known). Direct in double "
        "precision and where no low rank is found."
    )
    title = f"Pupil OTF by thin matrices, {settings.small}² frequencies"
    chart = Chart("t0", "error", "time (T0)", "error at points", "mark", "shape", lines=True)
    return [Table("low_rank", title, heads, tuple(rows), text, chart)]


MEASURES = (low_rank,)
