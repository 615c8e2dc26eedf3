"""The MTF measured in the final picture, beside what was to be expected, as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.assessment.edge_measurement import Attempt, Judged, judged
from app.run.evaluation import Evaluation
from app.run.responses import Responses


def judged_facts(evaluation: Evaluation) -> dict[str, Any]:
    """Every measurement, each with its figures or the reason why it has none."""
    edges = judged(evaluation)
    if isinstance(edges, str):
        return {"reason": edges, "measurements": []}
    return {
        "reason": None,
        "source": edges.source,
        "picture": edges.picture,
        "silenced": edges.silenced,
        "interval_mrad": dict(zip(("horizontal", "vertical"), edges.intervals, strict=True)),
        "stages": _stages(evaluation.responses, edges),
        "measurements": [_measurement(attempt) for attempt in edges.attempts],
    }


def _stages(responses: Responses, edges: Judged) -> dict[str, Any]:
    """Modulus of the stages' product, by cycles per sample of the picture."""
    whole = responses.products[-1]
    lines = (
        ("horizontal", responses.xi * edges.intervals[0], whole.x.mtf),
        ("vertical", responses.eta * edges.intervals[1], whole.y.mtf),
    )
    return {
        direction: {"frequency_cyc_per_sample": frequency, "mtf": np.abs(mtf)}
        for direction, frequency, mtf in lines
    }


def _measurement(attempt: Attempt) -> dict[str, Any]:
    figures = {
        "direction": attempt.direction,
        "method": attempt.method,
        "reason": attempt.reason,
    }
    one = attempt.judgement
    if one is None:
        return figures
    away, place = one.largest

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * one.per_mrad

    return figures | {
        "angle_deg": one.angle_deg,
        "frequency_cyc_per_sample": one.frequency,
        "mtf": one.mtf,
        "mtf_error": one.error,
        "expected": one.expected,
        "mtf50_cyc_per_mrad": scaled(one.mtf50.value),
        "mtf50_error_cyc_per_mrad": scaled(one.mtf50.error),
        "expected_mtf50_cyc_per_mrad": scaled(one.expected_mtf50),
        "nyquist_cyc_per_mrad": 0.5 * one.per_mrad,
        "at_nyquist": one.nyquist.value,
        "at_nyquist_error": one.nyquist.error,
        "expected_at_nyquist": one.expected_nyquist,
        "largest_difference": away,
        "largest_difference_at_cyc_per_mrad": place * one.per_mrad,
    }
