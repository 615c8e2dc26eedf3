"""A trade-off as a page that needs no other file."""

from __future__ import annotations

from app.report.blocks import Block, Drawn, Grid, Heading
from app.report.drawing.printed_numbers import number
from app.report.html_page import html_page
from app.tradeoff.tradeoff_drawing import trade_off_png
from app.tradeoff.tradeoff_results import Results, shown_value


def page(found: Results) -> str:
    """The picture, the figures with their meaning, every value, and what failed."""
    title = f"{found.network or 'Image chain'}: trade-off"
    caption = f"Figures of merit as {found.varied.text} moves"
    caption += f", a curve for each {found.second.text}." if found.second else "."
    if found.present is not None:
        present = shown_value(found.present, found.varied.unit)
        caption += f" The network as it stands has {present}"
        caption += " (dashed line)." if found.varied.is_numeric else "."
    if found.failures():
        caption += " A cross: no figure at that value, see the gaps below."
    blocks = [
        Heading(1, title),
        Drawn(trade_off_png(found), caption, caption),
        Heading(2, "Figures"),
        Grid(
            ("figure", "unit", "meaning"),
            [(each.text, each.unit, each.meaning) for each in found.figures],
        ),
        Heading(2, "Values"),
        _values(found),
        *_failures(found),
    ]
    return html_page(title, blocks)


def _values(found: Results) -> Block:
    axes = [found.varied, *([found.second] if found.second else [])]
    heads = [f"{each.text} ({each.unit})" if each.unit else each.text for each in axes]
    heads += [f"{each.text} ({each.unit})" if each.unit else each.text for each in found.figures]
    rows = []
    for curve, point in found.rows():
        cells = [shown_value(point.value), *([shown_value(curve.second)] if found.second else [])]
        rows.append([*cells, *(number(point.figures.get(f.text), f.unit) for f in found.figures)])
    return Grid(heads, rows, numbers=range(len(heads)))


def _failures(found: Results) -> list[Block]:
    failed = found.failures()
    return [Heading(2, "Gaps"), Grid(("where", "why"), failed)] if failed else []
