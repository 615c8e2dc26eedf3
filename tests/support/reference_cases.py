"""Reference values that stand beside the repository; where they do not, there are no cases."""

import json
from pathlib import Path

import pytest

REFERENCE = Path(__file__).parents[2] / ".." / "shared" / "reference" / "values.json"
CAMERA = REFERENCE.with_name("camera_values.json")


def reference_cases(*quantities: str, file: Path = REFERENCE) -> list:
    """Cases of the quantities, as parameters of a test, named by their ids."""
    if not file.exists():
        return []
    cases = json.loads(file.read_text(encoding="utf-8"))["cases"]
    return [pytest.param(case, id=case["id"]) for case in cases if case["quantity"] in quantities]
