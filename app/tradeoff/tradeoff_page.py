"""A trade-off as a page that needs no other file."""

from __future__ import annotations

from html import escape

from app.report.drawing.printed_numbers import number
from app.report.markup import figure, table
from app.report.page_style import CSS
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
    parts = [
        f"<h1>{escape(title)}</h1>",
        figure(trade_off_png(found), caption, caption),
        "<h2>Figures</h2>",
        table(
            ("figure", "unit", "meaning"),
            [(each.text, each.unit, each.meaning) for each in found.figures],
        ),
        "<h2>Values</h2>",
        _values(found),
        _failures(found),
    ]
    body = "\n".join(part for part in parts if part)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)} · Imagechain</title>\n<style>{CSS}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def _values(found: Results) -> str:
    axes = [found.varied, *([found.second] if found.second else [])]
    heads = [f"{each.text} ({each.unit})" if each.unit else each.text for each in axes]
    heads += [f"{each.text} ({each.unit})" if each.unit else each.text for each in found.figures]
    rows = []
    for curve, point in found.rows():
        cells = [shown_value(point.value), *([shown_value(curve.second)] if found.second else [])]
        rows.append([*cells, *(number(point.figures.get(f.text), f.unit) for f in found.figures)])
    return table(heads, rows, numbers=range(len(heads)))


def _failures(found: Results) -> str:
    failed = found.failures()
    return "<h2>Gaps</h2>" + table(("where", "why"), failed) if failed else ""
