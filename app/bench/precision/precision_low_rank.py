"""The choice of evaluating a pupil's OTF at every frequency, or its plane as filters take it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.kodak import Kodak
from app.bench.measuring.timing import paired, round_trip
from app.bench.truth.network_pupils import (
    ROWS_AT_ONCE,
    SHAPES,
    Otf,
    expected_at,
    places_of,
    pupil_network,
)

Array = NDArray[Any]


def low_rank(settings: Settings) -> list[Table]:
    """Planes from tables, thin matrices and the support, against the closed form everywhere."""
    kodak = Kodak(settings.small)
    rows = []
    pairs = 2 if settings.quick else 5
    for shape in SHAPES:
        otf = Otf(kodak, pupil_network(kodak.network, shape, 512))
        factor = otf.factor
        size = len(kodak.scene)
        every, planes = np.arange(size), otf.planes(factor)
        plane = np.concatenate([
            np.asarray(planes.block(slice(start, start + ROWS_AT_ONCE)))
            for start in range(0, size, ROWS_AT_ONCE)
        ])  # fmt: skip
        direct = otf.at(every[:, np.newaxis], every[np.newaxis, :])
        places = places_of(size)
        expected = expected_at(shape, otf.lags_mm(*places))
        for choice, values, subject in (
            ("direct", direct, otf.direct),
            ("plane", plane, otf.plane),
            ("plane, known", plane, otf.known),
        ):
            t0 = round_trip(kodak.scene, kodak.policy.workers)
            rows.append(
                {
                    "shape": shape,
                    "choice": choice,
                    "mark": choice if shape == "clear" else None,
                    **paired(subject, t0, pairs=pairs, warm_up=1).facts(),
                    "error": float(np.abs(values[places] - expected).max()),
                    "from_direct": float(np.abs(values - direct).max()),
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
        "Single precision, whose rounding covers these errors. The default plane of a disc or an "
        "annulus comes from a table of the radius, and for large pictures from two thin matrices; "
        "those of other pupils are in closed form, and so is every plane in double precision. "
        "Nothing is evaluated beyond the cutoff. A plane is kept (known)."
    )
    title = f"Planes of pupil OTFs, {settings.small}² frequencies"
    chart = Chart("t0", "error", "time (T0)", "error at points", "mark", "shape", lines=True)
    return [Table("low_rank", title, heads, tuple(rows), text, chart)]


MEASURES = (low_rank,)
