"""The MTF measured in the final picture, beside what was to be expected, as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.assessment.edge_measurement import Attempt, Judged, judged
from app.run.evaluation import Evaluation
from app.run.responses import Responses


def judged_facts(found: Evaluation) -> dict[str, Any]:
    """Every measurement, each with its figures or the reason why it has none."""
    told = judged(found)
    if isinstance(told, str):
        return {"reason": told, "measurements": []}
    return {
        "reason": None,
        "source": told.source,
        "picture": told.picture,
        "silenced": told.silenced,
        "interval_mrad": dict(zip(("horizontal", "vertical"), told.intervals, strict=True)),
        "stages": _stages(found.responses, told),
        "measurements": [_measurement(each) for each in told.attempts],
    }


def _stages(responses: Responses, told: Judged) -> dict[str, Any]:
    """Modulus of the stages' product, by cycles per sample of the picture."""
    whole = responses.products[-1]
    lines = (
        ("horizontal", responses.xi * told.intervals[0], whole.x.mtf),
        ("vertical", responses.eta * told.intervals[1], whole.y.mtf),
    )
    return {
        direction: {"frequency_cyc_per_sample": frequency, "mtf": np.abs(mtf)}
        for direction, frequency, mtf in lines
    }


def _measurement(attempt: Attempt) -> dict[str, Any]:
    said = {
        "direction": attempt.direction,
        "method": attempt.method,
        "reason": attempt.reason,
    }
    one = attempt.found
    if one is None:
        return said
    away, place = one.largest

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * one.per_mrad

    return said | {
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
