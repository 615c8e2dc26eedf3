"""A fit's result as a JSON file."""

from __future__ import annotations

import json
import math
from typing import Any

from app.fit.fit_result import FitResult, NoiseComparison


def fit_json(result: FitResult) -> str:
    """The text of the file; what is not known is null."""
    content: dict[str, Any] = {
        "format": "imagechain-fit",
        "version": 1,
        "parameters": {
            p.port: {"value": p.value, "sigma": p.sigma, "unit": p.unit} for p in result.parameters
        },
        "correlation": [[_number(value) for value in row] for row in result.correlation],
        "chi2_per_degree": _number(result.chi2_per_degree),
        "combinations": [
            {
                "expression": one.text,
                "value": _number(one.value),
                "sigma": _number(one.sigma),
                "unit": one.unit,
            }
            for one in result.combinations
        ],
        "warnings": list(result.warnings),
        "notes": list(result.notes),
    }
    if isinstance(result.noise, NoiseComparison):
        content["noise"] = {
            "fitted": result.noise.fitted,
            "levels": [
                {
                    "level": one.level,
                    "variance": one.variance,
                    "variance_error": one.variance_error,
                    "predicted": predicted,
                }
                for one, predicted in zip(
                    result.noise.measured, result.noise.predicted, strict=True
                )
            ],
        }
    elif result.noise:
        content["noise"] = {"reason": result.noise}
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
