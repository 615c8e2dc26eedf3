"""The curves of a kept state, A, drawn beside those of the present one, B."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from app.editor.viewers.plot.plotted_lines import Drawing, Entry, Line, Panel

MARK = "A "
"""What the names of kept curves begin with."""


def with_kept(drawing: Drawing, kept: Drawing, name: str) -> Drawing:
    """The drawing with the kept curves that differ from the present ones of the same title.

    They stand behind the present ones in the legend, and are drawn dashed in their colours. Where
    the two have other axes, only a note says so.

    Parameters
    ----------
    drawing, kept : Drawing
        Of the present state and of the kept one, made alike.
    name : str
        What the kept state is called.
    """
    if not kept.panels or not drawing.panels:
        return drawing
    if drawing.bars or kept.bars:
        return _noted(drawing, f"A {name}: bars are not drawn beside others")
    axes = [(d.x_label, d.log_x) for d in (kept, drawing)]
    if axes[0] != axes[1]:
        return _noted(drawing, f"A {name} is not drawn: it is over {kept.x_label}")
    old, new = _titles(kept), _titles(drawing)
    panels, differing = [], set()
    for panel in drawing.panels:
        of = next((other for other in kept.panels if other.y_label == panel.y_label), None)
        lines = () if of is None else _differing(panel, of, new, old)
        differing |= {line.name for line in lines}
        panels.append(replace(panel, lines=(*panel.lines, *lines)))
    drawn = {panel.y_label for panel in kept.panels} & {panel.y_label for panel in drawing.panels}
    if not drawn:
        units = ", ".join(panel.y_label for panel in kept.panels)
        return _noted(drawing, f"A {name} is not drawn: it is {units}")
    entries = tuple(
        Entry(MARK + entry.name, f"A: {entry.title}", entry.total, entry.shown, of=entry.name)
        for entry in drawing.entries
        if MARK + entry.name in differing
    )
    return replace(drawing, entries=(*drawing.entries, *entries), panels=tuple(panels))


def _titles(drawing: Drawing) -> Mapping[str, str]:
    return {entry.title: entry.name for entry in drawing.entries}


def _differing(
    panel: Panel, kept: Panel, titles: Mapping[str, str], kept_titles: Mapping[str, str]
) -> tuple[Line, ...]:
    """Lines of the kept panel that are not as in the present one, under their names there."""
    now = {line.name: line for line in panel.lines}
    before = {line.name: line for line in kept.lines}
    lines = []
    for title, name in titles.items():
        old = before.get(kept_titles.get(title, ""))
        new = now.get(name)
        if old is not None and (new is None or not _same(old, new)):
            lines.append(Line(MARK + name, old.x, old.y))
    return tuple(lines)


def _same(one: Line, other: Line) -> bool:
    return np.array_equal(one.x, other.x) and np.array_equal(one.y, other.y, equal_nan=True)


def _noted(drawing: Drawing, note: str) -> Drawing:
    return replace(drawing, note=f"{drawing.note}; {note}" if drawing.note else note)
