"""The handbook's tables of speed: Markdown between two marks of its page."""

from collections.abc import Mapping, Sequence
from typing import Any

from app.bench.tables import Table
from app.bench.timing import machine_words

START, END = "<!-- bench table -->", "<!-- end of bench table -->"


def section(facts: Mapping[str, Any], tables: Sequence[Table]) -> str:
    """The tables, and how they were made."""
    made = (
        f"Made by `tests/benchmarks/run.py --page` on {facts['date'][:10]}: "
        f"{', '.join(machine_words(facts['machine']))}. T0 is the time of "
        "`scipy.fft.irfft2(scipy.fft.rfft2(image))` for the same image and data type in the "
        "same run."
    )
    return "\n\n".join([START, made, *map(markdown, tables), END])


def markdown(table: Table) -> str:
    """A table and its sentence; of several sizes the one that is drawn."""
    where = table.chart.where if table.chart is not None else None
    chosen = where is not None and where[0] == "size"
    rows = [row for row in table.rows if not chosen or row["size"] == where[1]]
    short = Table(table.name, table.title, table.heads, rows, table.text)
    numeric = short.numeric()
    rule = ["---:" if index in numeric else "---" for index in range(len(table.heads))]
    lines = [
        "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |"
        for line in [list(table.heads.values()), rule, *short.cells()]
    ]
    return "\n\n".join([f"**{table.title}**", "\n".join(lines), *filter(None, [table.text])])


def inserted(page: str, text: str) -> str:
    """The page with `text` in the place of what is between the marks."""
    head, start, rest = page.partition(START)
    _, end, tail = rest.partition(END)
    if not (start and end):
        raise SystemExit(f"the page has no lines {START} and {END}")
    return head + text + tail
