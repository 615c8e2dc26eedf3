"""A trade-off as a page that needs no other file."""

from __future__ import annotations

from app.report.blocks import Block, Drawn, Grid, Heading
from app.report.drawing.printed_numbers import number
from app.report.html_page import html_page
from app.tradeoff.tradeoff_drawing import trade_off_png
from app.tradeoff.tradeoff_results import Results, shown_value


def page(results: Results) -> str:
    """The picture, the figures with their meaning, every value, and what failed."""
    title = f"{results.network or 'Image chain'}: trade-off"
    caption = f"Figures of merit as {results.varied.text} moves"
    caption += f", a curve for each {results.second.text}." if results.second else "."
    if results.present is not None:
        present = shown_value(results.present, results.varied.unit)
        caption += f" The network as it stands has {present}"
        caption += " (dashed line)." if results.varied.is_numeric else "."
    if results.failures():
        caption += " A cross: no figure at that value, see the gaps below."
    blocks = [
        Heading(1, title),
        Drawn(trade_off_png(results), caption, caption),
        Heading(2, "Figures"),
        Grid(
            ("figure", "unit", "meaning"),
            [(figure.text, figure.unit, figure.meaning) for figure in results.figures],
        ),
        Heading(2, "Values"),
        _values(results),
        *_listed("Gaps", results.failures()),
        *_listed("Warnings", results.warnings()),
    ]
    return html_page(title, blocks)


def _values(results: Results) -> Block:
    axes = [results.varied, *([results.second] if results.second else [])]
    heads = [f"{axis.text} ({axis.unit})" if axis.unit else axis.text for axis in axes]
    heads += [
        f"{figure.text} ({figure.unit})" if figure.unit else figure.text
        for figure in results.figures
    ]
    rows = []
    for curve, point in results.rows():
        cells = [shown_value(point.value), *([shown_value(curve.second)] if results.second else [])]
        rows.append([*cells, *(number(point.figures.get(f.text), f.unit) for f in results.figures)])
    return Grid(heads, rows, numbers=range(len(heads)))


def _listed(title: str, lines: list[tuple[str, str]]) -> list[Block]:
    return [Heading(2, title), Grid(("where", "why"), lines)] if lines else []
