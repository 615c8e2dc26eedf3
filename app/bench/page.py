"""The benchmark as one HTML page that needs no other file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from app.bench.charts import chart_png
from app.bench.settings import PARTS
from app.bench.tables import Table
from app.report.markup import figure, table
from app.report.style import CSS

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
    machine, settings = facts["machine"], facts["settings"]
    words = [
        machine["processor"],
        f"{machine['usable_cores']} of {machine['cores']} cores",
        f"{machine['memory_bytes'] / 2**30:.0f} GiB",
        f"load {machine['load']:.1f} at the start",
        f"{settings['threads']} threads",
        *(["quick"] if settings["quick"] else []),
        *(f"{name} {each}" for name, each in machine["versions"].items()),
        facts["date"],
        f"{facts['seconds']:.0f} s",
    ]
    return f"<p class=run>{escape(' · '.join(words))}</p>"


def _section(shown: Table) -> str:
    parts = [f"<h3>{escape(shown.title)}</h3>"]
    cells = shown.cells()
    if cells:
        heads = list(shown.heads.values())
        verdicts = {text: _mark(text) for row in cells for text in row if _mark(text)}
        marks = {index: verdicts for index, name in enumerate(shown.heads) if "verdict" in name}
        parts.append(table(heads, cells, numbers=shown.numeric(), marks=marks))
    if shown.text:
        parts.append(f"<p>{escape(shown.text)}</p>")
    drawn = chart_png(shown)
    if drawn is not None:
        parts.append(figure(drawn, shown.title + ".", shown.title))
    return "".join(parts)


def _mark(text: str) -> str:
    if text.startswith("missed"):
        return "bad"
    return "good" if text.startswith("met") else ""
