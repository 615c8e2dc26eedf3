"""The summary of a study: its picture, alone or on a page that needs no other file."""

from __future__ import annotations

import statistics
from pathlib import Path

from app.report.blocks import Block, Drawn, Grid, Heading
from app.report.drawing.printed_numbers import number
from app.report.html_page import html_page
from app.run.readout_tables import warned_points
from app.study.carrying_out import StudyRows
from app.study.study_axes import Axis
from app.study.study_drawing import study_png
from app.tradeoff.tradeoff_results import shown_value
from core.atomic import write_bytes, write_text
from core.names import printable
from nodes.files.formats import PNG

_MOST_FAILED = 50


def write_summary(result: StudyRows, path: Path) -> None:
    """Write the summary in the format of the path's suffix.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    if PNG.matches(path):
        write_bytes(path, study_png(result))
    else:
        write_text(path, printable(summary_page(result)))


def summary_page(result: StudyRows) -> str:
    """The picture, what varied, each figure's spread with its ends' points, and what failed."""
    study = result.study
    caption = f"Figures of {len(result.rows)} points; a cross: no figure there."
    blocks: list[Block] = [
        Heading(1, f"{study.name or 'Image chain'}: study"),
        Drawn(study_png(result), caption, caption),
        Heading(2, "What varies"),
        Grid(("parameter", "values", "from", "to"), [_varied(axis) for axis in study.axes]),
        Heading(2, "Figures"),
        _figures(result),
    ]
    failed = result.failed
    if failed:
        rows = [(str(row.place + 1), row.error) for row in failed[:_MOST_FAILED]]
        if len(failed) > _MOST_FAILED:
            rows.append(("", f"and {len(failed) - _MOST_FAILED} more"))
        blocks += [Heading(2, f"{len(failed)} points failed"), Grid(("point", "why"), rows)]
    lines = warned_points([row.warnings for row in result.rows])
    if lines:
        blocks += [Heading(2, lines[0].rstrip(":")), Grid(("warning",), [(x,) for x in lines[1:]])]
    return html_page(f"{study.name or 'Image chain'}: study", blocks)


def _varied(axis: Axis) -> tuple[str, str, str, str]:
    head = f"{axis.label} ({axis.unit})" if axis.unit else axis.label
    ends = sorted(axis.values) if axis.is_numeric else axis.values
    first, last = (shown_value(axis.shown(value)) for value in (ends[0], ends[-1]))
    return head, str(len(axis.values)), first, last


def _figures(result: StudyRows) -> Block:
    rows = []
    for place, figure in enumerate(result.study.figures):
        known = [(row.figures[place], row.place + 1) for row in result.rows]
        values = sorted((value, point) for value, point in known if value is not None)
        head = f"{figure.text} ({figure.unit})" if figure.unit else figure.text
        if not values and figure.by_default:
            continue
        if not values:
            rows.append((head, "0", "", "", "", "", "", figure.meaning))
            continue
        (least, low), (most, high) = values[0], values[-1]
        middle = statistics.median(value for value, _ in values)
        cells = [number(value, figure.unit) for value in (least, middle, most)]
        rows.append((head, str(len(values)), cells[0], str(low), cells[1], cells[2], str(high),
                     figure.meaning))  # fmt: skip
    heads = ("figure", "values", "least", "at point", "median", "most", "at point", "meaning")
    return Grid(heads, rows, numbers=range(1, 7))
