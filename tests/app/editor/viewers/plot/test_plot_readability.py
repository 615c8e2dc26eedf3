"""What a plot needs to be read: logarithmic abscissae, curves in one place, limits, long names."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor

from app.editor.evaluation.queries import Answer
from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.plotted_lines import PortDataQuery
from core.chain.wires import CurveData, Series

PORT = "a.curve"
FREQUENCY = np.linspace(0.0, 2.0, 201)
LINEAR = CurveData("", "x", "y", (Series("a", FREQUENCY, FREQUENCY),))


SIZES = np.array([0.0, 0.1, 1.0, 10.0, 100.0])
MDTD = CurveData(
    "MDTD",
    "target size (mrad)",
    "MDTD (K)",
    (Series("square", SIZES, np.array([np.inf, 10.0, 1.0, 0.1, 0.01])),),
    log_y=True,
    log_x=True,
)


def test_a_logarithmic_abscissa(shown):
    """A power law is a straight line, from the least size above 0 to the greatest."""
    viewer = shown(MDTD)
    x, y = viewer.canvas.plots[0].drawn["0"].getData()
    np.testing.assert_allclose(x[1:], [-1, 0, 1, 2], atol=1e-12)
    np.testing.assert_allclose(y[1:], [1, 0, -1, -2], atol=1e-12)
    low, high = viewer.canvas.plots[0].getViewBox().viewRange()[0]
    assert -1.1 < low < -1.0 < 2.0 < high < 2.1
    axis = viewer.canvas.plots[0].getAxis("bottom")
    assert axis.tickStrings([-1.0, 0.0, 1.0, 2.0], 1.0, 1) == ["0.1", "1", "10", "100"]
    viewer.take(Answer(2, viewer.owner, PortDataQuery(PORT), LINEAR))
    assert viewer.canvas.plots[0].drawn["0"].getData()[0][-1] == 2.0
    assert viewer.canvas.plots[0].getAxis("bottom").tickStrings([2.0], 1.0, 1) == ["2"]


COINCIDING = CurveData(
    "MRTD",
    "x",
    "y",
    (
        Series("horizontal", FREQUENCY, FREQUENCY**2),
        Series("vertical", FREQUENCY, FREQUENCY**2),
        Series("2-D", FREQUENCY[::3], FREQUENCY[::3] ** 2),
        Series("another", FREQUENCY, FREQUENCY),
    ),
)


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_curves_that_lie_on_one_another_are_all_seen(shown, theme):
    viewer = shown(COINCIDING, theme)
    viewer.list.item(3).setCheckState(Qt.CheckState.Unchecked)
    image = viewer.canvas.grab().toImage()
    columns, rows = range(image.width()), range(image.height())
    dots = [QColor(image.pixel(x, y)) for x in columns for y in rows]
    hues = np.array([dot.hue() for dot in dots if dot.saturation() > 90])
    counts = [np.sum(abs(hues - QColor(colour).hue()) <= 4) for colour in theme.curves[:3]]
    assert min(counts) > max(counts) / 3  # of three pieces, one each
    assert viewer.canvas.pens["3"].style() == Qt.PenStyle.SolidLine
    assert viewer.canvas.pens["0"].style() == Qt.PenStyle.SolidLine


# --- curves of a kept state beside the present ones ----------------------------------------------

X = np.linspace(0.0, 1.0, 11)


def data(**heights):
    series = tuple(Series(name, X, np.asarray(height)) for name, height in heights.items())
    return CurveData("MTF", "frequency (cyc/mrad)", "MTF", series)


NOW = data(optics=1 - X, detector=1 - X / 2, jitter=1 - X / 4)


def test_the_viewer_draws_both_and_ticks_them_together(shown):
    viewer = shown(NOW)
    viewer.compare_kept(data(detector=1 - X / 2, optics=1 - X**2), "Snapshot 1")
    # Only curves that differ are drawn again, found by their titles and not by their places.
    titles = [entry.title for entry in viewer.canvas.drawing.entries]
    assert titles == ["optics", "detector", "jitter", "A: optics"]
    assert viewer.list.count() == 4
    drawn = viewer.canvas.plots[0].drawn["A 0"]
    assert (drawn.getData()[1] == 1 - X**2).all()
    assert drawn.isVisible()
    viewer.list.item(0).setCheckState(Qt.CheckState.Unchecked)
    assert not viewer.canvas.plots[0].drawn["A 0"].isVisible()
    viewer.compare_kept(None)
    assert viewer.list.count() == 3
