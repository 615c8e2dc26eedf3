"""Curves of a kept state beside the present ones: which are drawn, how, and when not."""

import numpy as np
import pytest
from PySide6.QtCore import Qt

from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.plot_looks import entry_pens
from app.editor.viewers.plot.plotted_lines import curve_drawing, with_kept
from core.chain.results import CurveData, Series

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


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_a_is_dashed_in_the_colour_of_b(theme):
    kept = curve_drawing(data(optics=1 - X**2))
    entries = with_kept(curve_drawing(NOW), kept, "Snapshot 1").entries
    now, *_, before = entry_pens(entries, theme).values()
    assert before.color() == now.color()
    assert now.style() is Qt.PenStyle.SolidLine
    assert before.style() is Qt.PenStyle.CustomDashLine


def test_other_axes_are_not_drawn_over_one_another():
    other = CurveData("PSD", "frequency (cyc/m)", "MTF", NOW.series)
    drawing = with_kept(curve_drawing(NOW), curve_drawing(other), "Snapshot 1")
    assert len(drawing.entries) == 3
    assert drawing.note == "A Snapshot 1 is not drawn: it is over frequency (cyc/m)"
    other = CurveData("NEI", "frequency (cyc/mrad)", "NEI (W)", NOW.series)
    drawing = with_kept(curve_drawing(NOW), curve_drawing(other), "Snapshot 1")
    assert drawing.note == "A Snapshot 1 is not drawn: it is NEI (W)"


def test_the_viewer_draws_both_and_ticks_them_together(shown):
    viewer = shown(NOW)
    viewer.compare_kept(data(optics=1 - X**2), "Snapshot 1")
    assert viewer.list.count() == 4
    drawn = viewer.canvas._curves[0]["A 0"]
    assert (drawn.getData()[1] == 1 - X**2).all()
    assert drawn.isVisible()
    viewer.list.item(0).setCheckState(Qt.CheckState.Unchecked)
    assert not viewer.canvas._curves[0]["A 0"].isVisible()
    viewer.compare_kept(None)
    assert viewer.list.count() == 3
