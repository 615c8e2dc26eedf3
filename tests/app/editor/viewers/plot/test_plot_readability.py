"""What a plot needs to be read: logarithmic abscissae, curves in one place, limits, long names."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor

from app.editor.evaluation.queries import Answer
from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.plot_looks import PlotAxis
from app.editor.viewers.plot.plotted_lines import PortDataQuery
from core.chain.results import CurveData, Series

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
    x, y = viewer.canvas._curves[0]["0"].getData()
    np.testing.assert_allclose(x[1:], [-1, 0, 1, 2], atol=1e-12)
    np.testing.assert_allclose(y[1:], [1, 0, -1, -2], atol=1e-12)
    low, high = viewer.canvas._plots[0].getViewBox().viewRange()[0]
    assert -1.1 < low < -1.0 < 2.0 < high < 2.1
    axis = viewer.canvas._plots[0].getAxis("bottom")
    assert axis.tickStrings([-1.0, 0.0, 1.0, 2.0], 1.0, 1) == ["0.1", "1", "10", "100"]
    viewer.take(Answer(2, viewer.owner, PortDataQuery(PORT), LINEAR))
    assert viewer.canvas._curves[0]["0"].getData()[0][-1] == 2.0
    assert viewer.canvas._plots[0].getAxis("bottom").tickStrings([2.0], 1.0, 1) == ["2"]


def test_what_is_read_at_a_logarithmic_abscissa_is_none(shown):
    viewer = shown(MDTD)
    read = []
    viewer.canvas.read.connect(read.append)
    box = viewer.canvas._plots[0].getViewBox()
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.0, -1.0)))
    place, _, value = read[-1].partition(" mrad")
    assert float(place) == pytest.approx(10.0, rel=0.05)
    assert float(value.split("MDTD: ")[1].split()[0]) == pytest.approx(0.1, rel=0.05)


def test_ticks_far_from_1_are_powers():
    axis = PlotAxis("left")
    axis.setLogMode(False, True)
    axis.setRange(-9.0, 9.0)
    assert axis.tickStrings([-6.0, -4.0, 4.0, 6.0], 1.0, 1) == ["10⁻⁶", "0.0001", "10000", "10⁶"]


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


def test_limits_around_a_curve_have_its_colour_and_take_none(shown):
    data = CurveData("MTF", "x", "MTF", tuple(
        Series(label, FREQUENCY, FREQUENCY + shift)
        for label, shift in (
            ("measured", 0.0), ("+ standard error", 0.3),
            ("\N{MINUS SIGN} standard error", -0.3), ("expected", 0.1),
        )
    ))  # fmt: skip
    viewer = shown(data)
    pens = [viewer.canvas.pens[str(number)] for number in range(4)]
    names = [pen.color().name() for pen in pens]
    assert names == [DARK.curves[0]] * 3 + [DARK.curves[1]]
    styles = [pen.style() for pen in pens]
    assert styles[1] == styles[2] == Qt.PenStyle.DotLine
    assert styles[0] == styles[3] == Qt.PenStyle.SolidLine


def test_names_of_bars_are_not_shortened_where_there_is_room(shown, tmp_path):
    names = ("Combined pixels", "Exit Pupil MTF", "Charge Transfer MTF")
    series = (Series("a", np.arange(3.0), np.array([1.0, 2.0, 1.7917e-5])),)
    viewer = shown(CurveData("", "", "", series, names))
    viewer.export(tmp_path / "bars.svg")
    text = (tmp_path / "bars.svg").read_text()
    for name in (*names, "1.792e\N{MINUS SIGN}5"):
        assert name in text
