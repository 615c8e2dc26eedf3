"""The benchmark as one HTML page that needs no other file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from app.bench.measuring.bench_settings import PARTS
from app.bench.measuring.bench_tables import Table
from app.bench.measuring.machine import machine_words
from app.bench.pages.charts import chart_png
from app.report.markup import figure, table
from app.report.page_style import CSS

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
    body = [
        f"<h1>{escape(TITLE)}</h1>",
        "<p class=lead>Time is told in T0, the bare round trip irfft2(rfft2(image)) of the same "
        "image, type and threads, measured in turn with the subject: what any Fourier method has "
        "to pay. Medians of the ratios of pairs.</p>",
        _machine_line(facts),
    ]
    for name, tables in parts.items():
        body.append(f"<h2>{escape(PARTS[name])}</h2>")
        body += [_section(each) for each in tables]
    text = "\n".join(body)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(TITLE)}</title>\n<style>{CSS}</style>\n</head>\n"
        f"<body>\n<main>\n{text}\n</main>\n</body>\n</html>\n"
    )


def _machine_line(facts: Mapping[str, Any]) -> str:
    settings = facts["settings"]
    words = [
        *machine_words(facts["machine"]),
        f"{settings['threads']} threads",
        *(["quick"] if settings["quick"] else []),
        facts["date"],
        f"{facts['seconds']:.0f} s",
    ]
    return f"<p class=run>{escape(' · '.join(words))}</p>"


def _section(shown: Table) -> str:
    parts = [f"<h3>{escape(shown.title)}</h3>"]
    if shown.text:
        parts.append(f"<p>{escape(shown.text)}</p>")
    drawn = chart_png(shown, titled=False)
    if drawn is not None:
        assert shown.chart is not None
        parts.append(figure(drawn, shown.chart.title or shown.title, shown.title))
    cells = shown.cells()
    if cells:
        heads = list(shown.heads.values())
        verdicts = {text: _mark(text) for row in cells for text in row if _mark(text)}
        marks = {index: verdicts for index, name in enumerate(shown.heads) if "verdict" in name}
        parts.append(table(heads, cells, numbers=shown.numeric(), marks=marks))
    return "".join(parts)


def _mark(text: str) -> str:
    if text.startswith("missed"):
        return "bad"
    return "good" if text.startswith("met") else ""
