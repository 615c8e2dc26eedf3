"""The benchmark as one HTML page that needs no other file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from app.bench.measuring.bench_settings import PARTS
from app.bench.measuring.bench_tables import Table
from app.bench.measuring.machine import machine_words
from app.bench.pages.charts import chart_png
from app.report.blocks import Block, Drawn, Grid, Heading, Text
from app.report.html_page import html_page

TITLE = "Imagechain: run time against error"


def page(facts: Mapping[str, Any], parts: Mapping[str, Sequence[Table]]) -> str:
    """The page.

    Parameters
    ----------
    facts : mapping
        What the JSON file holds.
    parts : mapping of name to tables
        What was measured.
    """
    blocks: list[Block] = [
        Heading(1, TITLE),
        Text(
            "Time is given in T0, the bare round trip irfft2(rfft2(image)) of the same image, type "
            "and threads, measured in turn with the subject: what any Fourier method has to pay. "
            "Medians of the ratios of pairs.",
            "lead",
        ),
        _machine_line(facts),
    ]
    for name, tables in parts.items():
        blocks.append(Heading(2, PARTS[name]))
        for table in tables:
            blocks += _section(table)
    return html_page(TITLE, blocks)


def _machine_line(facts: Mapping[str, Any]) -> Block:
    settings = facts["settings"]
    words = [
        *machine_words(facts["machine"]),
        f"{settings['threads']} threads",
        *(["quick"] if settings["quick"] else []),
        facts["date"],
        f"{facts['seconds']:.0f} s",
    ]
    return Text(" · ".join(words), "run")


def _section(shown: Table) -> list[Block]:
    blocks: list[Block] = [Heading(3, shown.title)]
    if shown.text:
        blocks.append(Text(shown.text))
    drawn = chart_png(shown, titled=False)
    if drawn is not None:
        assert shown.chart is not None
        blocks.append(Drawn(drawn, shown.chart.title or shown.title, shown.title))
    cells = shown.cells()
    if cells:
        heads = list(shown.heads.values())
        verdicts = {text: _mark(text) for row in cells for text in row if _mark(text)}
        marks = {index: verdicts for index, name in enumerate(shown.heads) if "verdict" in name}
        blocks.append(Grid(heads, cells, numbers=shown.numeric(), marks=marks))
    return blocks


def _mark(text: str) -> str:
    if text.startswith("missed"):
        return "bad"
    return "good" if text.startswith("met") else ""
