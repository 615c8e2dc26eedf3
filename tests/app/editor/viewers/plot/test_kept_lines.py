"""Curves of a kept state beside the present ones: which are drawn, how, and when not."""

import numpy as np
from PySide6.QtCore import Qt

from app.editor.viewers.plot.plotted_lines import curve_drawing, with_kept
from core.chain.wires import CurveData, Series

X = np.linspace(0.0, 1.0, 11)


def data(**heights):
    series = tuple(Series(name, X, np.asarray(height)) for name, height in heights.items())
    return CurveData("MTF", "frequency (cyc/mrad)", "MTF", series)


NOW = data(optics=1 - X, detector=1 - X / 2, jitter=1 - X / 4)


def test_only_curves_that_differ_are_drawn_again():
    drawing = with_kept(
        curve_drawing(NOW), curve_drawing(data(detector=1 - X / 2, optics=1 - X**2)), "Snapshot 1"
    )
    assert [entry.title for entry in drawing.entries] == [
        "optics",
        "detector",
        "jitter",
        "A: optics",
    ]
    (panel,) = drawing.panels
    line = panel.lines[-1]
    assert line.name == drawing.entries[-1].name
    assert (line.y == 1 - X**2).all()  # found by its title, not by its place
    assert drawing.note == ""


def test_the_viewer_draws_both_and_ticks_them_together(shown):
    viewer = shown(NOW)
    viewer.compare_kept(data(optics=1 - X**2), "Snapshot 1")
    assert viewer.list.count() == 4
    drawn = viewer.canvas.plots[0].drawn["A 0"]
    assert (drawn.getData()[1] == 1 - X**2).all()
    assert drawn.isVisible()
    viewer.list.item(0).setCheckState(Qt.CheckState.Unchecked)
    assert not viewer.canvas.plots[0].drawn["A 0"].isVisible()
    viewer.compare_kept(None)
    assert viewer.list.count() == 3
