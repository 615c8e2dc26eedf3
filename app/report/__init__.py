"""Reports of a run: one self-contained file, for people (HTML) or for programs (JSON)."""

from __future__ import annotations

import json
from pathlib import Path

from app.evaluation import Evaluation
from app.report.facts import report_facts
from app.tables import jsonable, printable
from core.atomic import write_text


def write_report(found: Evaluation, path: Path) -> None:
    """Write the report in the format of the path's suffix.

    Raises
    ------
    ImagechainError
        If a figure cannot be computed, or the file not be written.
    """
    facts = report_facts(found)
    if path.suffix.lower() == ".json":
        text = json.dumps(jsonable(facts), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    else:
        from app.report.page import page

        text = page(found, facts)
    write_text(path, printable(text))
