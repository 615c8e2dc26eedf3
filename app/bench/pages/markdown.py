"""The benchmark's tables as Markdown, between two marks of a page of the handbook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Table
from app.bench.measuring.machine import machine_words
from core.errors import FileError, UsageError

START, END = "<!-- bench table -->", "<!-- end of bench table -->"
PAGE = "app/handbook/pages/speed_and_accuracy.md"
"""Where this program's own tables stand, in its repository."""


def fragment(
    facts: Mapping[str, Any], parts: Mapping[str, Sequence[Table]], settings: Settings
) -> str:
    """What was measured, for people: the tables that have a short form, and how they were made.

    Parameters
    ----------
    facts : mapping
        What the JSON file holds.
    parts : mapping of name to tables
        What was measured.
    settings : Settings
        How much was.
    """
    command = " ".join([f"imagechain bench --markdown {PAGE}", *settings.words()])
    machine = ", ".join(machine_words(facts["machine"]))
    made = (
        f"Made by `{command}` on {facts['date'][:10]}: {machine}. T0 is the bare round trip "
        "`scipy.fft.irfft2(scipy.fft.rfft2(image))` of the same image and type in the same run."
    )
    short = [table.shortened() for tables in parts.values() for table in tables]
    return "\n\n".join([START, made, *(_section(table) for table in short if table), END])


def inserted(file: Path, text: str) -> str:
    """The file's words with `text` in the place of what is between the marks; all of a new file.

    Raises
    ------
    UsageError
        If the file is there without the marks: it may be something else.
    FileError
        If it cannot be read.
    """
    try:
        before = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        return text + "\n"
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not text in UTF-8"
        raise FileError(f"cannot read {file}: {reason}") from error
    head, start, rest = before.partition(START)
    _, end, tail = rest.partition(END)
    if not (start and end):
        raise UsageError(
            f"--markdown {file}: the file is there and has no lines {START} and {END} to write "
            "between; add them, or name a new file"
        )
    return head + text + tail


def _section(table: Table) -> str:
    numeric = table.numeric()
    lines = [
        _row(list(table.heads.values())),
        _row(["---:" if index in numeric else "---" for index in range(len(table.heads))]),
        *map(_row, table.cells()),
    ]
    return "\n\n".join([f"**{table.title}**", "\n".join(lines), *filter(None, [table.text])])


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
