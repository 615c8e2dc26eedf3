"""Reports of a run: one self-contained file, for people (HTML) or for programs (JSON)."""

from __future__ import annotations

from pathlib import Path

from app.report.report_facts import report_facts
from app.run.evaluation import Evaluation
from app.run.readout_tables import json_text
from core.atomic import write_text
from core.chain.skipped import Skip
from core.names import printable
from nodes.files.common.file_format import JSON


def write_report(evaluation: Evaluation, skipped: tuple[Skip, ...], path: Path) -> None:
    """Write the report in the format of the path's suffix.

    `skipped` is what had not been computed before any report.
    """
    facts = report_facts(evaluation, skipped)
    if JSON.matches(path):
        text = json_text(facts, indent=1)
    else:
        from app.report.report_page import page

        text = printable(page(evaluation, facts))
    write_text(path, text)
