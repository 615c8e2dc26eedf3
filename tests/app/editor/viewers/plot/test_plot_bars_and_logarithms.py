"""Bars with names, and logarithmic ordinates with gaps, as the plot viewer draws them."""

import csv
import io
import math

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor

from app.editor.evaluation.queries import Answer
from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.plot_export import csv_text
from app.editor.viewers.plot.plotted_lines import PortDataQuery, curve_drawing, y_range
from core.chain.results import CurveData, Series

PORT = "a.curve"
NAMES = ("Optics", "Detector", "Jitter")


def bars(*heights, log=False):
    series = tuple(
        Series(f"set {number}", np.arange(3.0), np.array(each))
        for number, each in enumerate(heights)
    )
    return CurveData("Shares", "stage", "share (%)", series, NAMES, log)


FREQUENCY = np.linspace(0.0, 2.0, 201)
MRTD = CurveData(
    "MRTD",
    "frequency (cyc/mrad)",
    "MRTD (K)",
    (Series("MRTD", FREQUENCY, np.where(FREQUENCY <= 1.5, 0.01 * 10**FREQUENCY, np.inf)),),
    log_y=True,
)


def painted(viewer, colour):
    """Rows and columns of the dots of a colour in the chart."""
    image = viewer.bars.widget().grab().toImage()
    wanted = QColor(colour).rgb()
    return [
        (y, x) for y in range(image.height()) for x in range(image.width())
        if image.pixel(x, y) == wanted
    ]  # fmt: skip


def lengths(viewer, colour, count):
    """Dots that each bar of a colour is long, from the top down."""
    dots = painted(viewer, colour)
    height = viewer.bars.widget().height() - 2 * viewer.fontMetrics().height()
    found = []
    for place in range(count):
        top, bottom = place * height / count, (place + 1) * height / count
        columns = [x for y, x in dots if top <= y < bottom]
        found.append((max(columns) - min(columns) + 1) if columns else 0)
    return found


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_bars_are_as_long_as_their_values(shown, theme):
    viewer = shown(bars([10.0, 40.0, 20.0]), theme)
    assert viewer.bars.isVisible()
    assert not viewer.canvas.isVisible()
    first, second, third = lengths(viewer, theme.curves[0], 3)
    assert second > 100
    assert first == pytest.approx(second / 4, abs=2)
    assert third == pytest.approx(second / 2, abs=2)


def test_bars_below_zero_go_the_other_way(shown):
    viewer = shown(bars([-10.0, 10.0, 0.0]))
    dots = painted(viewer, DARK.curves[0])
    middle = viewer.bars.widget().height() / 3
    above = [x for y, x in dots if y < middle]
    below = [x for y, x in dots if y > middle]
    assert max(above) <= min(below)
    assert len(above) == pytest.approx(len(below), rel=0.05)


def test_on_a_logarithmic_scale_ratios_are_lengths(shown):
    viewer = shown(bars([0.1, 1.0, 10.0], log=True))
    assert viewer.bar.log.isChecked()
    first, second, third = lengths(viewer, DARK.curves[0], 3)
    assert third > second > first > 0
    assert third - second == pytest.approx(second - first, abs=2)


def test_names_and_values_are_told(shown):
    viewer = shown(bars([10.0, 40.0, np.inf], [-1.0, 0.0, 1 / 3]))
    assert viewer.bars.accessibleDescription() == (
        "Optics: 10, \N{MINUS SIGN}1; Detector: 40, 0; Jitter: ∞, 0.3333"
    )
    assert lengths(viewer, DARK.curves[0], 3)[2] == 0  # no bar is infinite


def test_a_set_of_bars_is_switched_off(shown):
    viewer = shown(bars([10.0, 40.0, 20.0], [5.0, 5.0, 5.0]))
    assert painted(viewer, DARK.curves[1])
    viewer.list.item(1).setCheckState(Qt.CheckState.Unchecked)
    assert not painted(viewer, DARK.curves[1])
    assert painted(viewer, DARK.curves[0])


def test_where_each_bar_belongs_to_one_set_no_gap_is_left_for_the_others(shown):
    """Each source of noise is temporal or fixed: its other bar would be a 0 beside it."""
    viewer = shown(bars([10.0, 20.0, 40.0]))
    thick = [len({y for y, _ in painted(viewer, DARK.curves[0])})]
    viewer = shown(bars([10.0, 0.0, 40.0], [0.0, 20.0, 0.0]))
    one, other = (len({y for y, _ in painted(viewer, DARK.curves[n])}) for n in (0, 1))
    assert one + other == thick[0]
    assert one == 2 * other


def test_many_bars_scroll(shown):
    many = tuple(f"stage {number}" for number in range(60))
    data = CurveData("", "", "", (Series("a", np.arange(60.0), np.arange(60.0)),), many)
    viewer = shown(data, size=(400, 240))
    line = viewer.fontMetrics().height()
    assert viewer.bars.widget().height() >= 60 * line
    assert viewer.bars.verticalScrollBar().maximum() > 0


def test_curves_take_the_place_of_bars_again(shown):
    viewer = shown(bars([1.0, 2.0, 3.0]))
    viewer.take(Answer(2, viewer.owner, PortDataQuery(PORT), MRTD))
    assert viewer.canvas.isVisible()
    assert not viewer.bars.isVisible()


def test_bars_are_exported_with_their_names(shown, tmp_path):
    viewer = shown(bars([10.0, 40.0, np.inf]))
    viewer.export(tmp_path / "b.csv")
    with (tmp_path / "b.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [
            ["stage", "set 0"], ["Optics", "10.0"], ["Detector", "40.0"], ["Jitter", "inf"],
        ]  # fmt: skip
    viewer.export(tmp_path / "b.png")
    assert (tmp_path / "b.png").stat().st_size > 1000


def test_a_logarithmic_curve_is_drawn_by_its_logarithm_with_gaps(shown):
    viewer = shown(MRTD)
    assert viewer.bar.log.isChecked()
    _, y = viewer.canvas._curves[0]["0"].getData()
    seen = FREQUENCY <= 1.5
    np.testing.assert_allclose(y[seen], FREQUENCY[seen] - 2.0, atol=1e-12)
    assert np.isnan(y[~seen]).all()
    low, high = viewer.canvas._plots[0].getViewBox().viewRange()[1]
    assert low < -2.0 < -0.5 < high < 0.0


def test_ticks_of_a_logarithmic_axis_have_room(shown):
    viewer = shown(MRTD)
    axis = viewer.canvas._plots[0].getAxis("left")
    texts = axis.tickStrings([-2.0, math.log10(0.05), math.log10(0.07), -1.0], 1.0, 1)
    assert [bool(text) for text in texts] == [True, True, False, True]
    assert [float(text) for text in texts if text] == [0.01, 0.05, 0.1]


def test_what_the_cursor_reads_is_no_logarithm(shown, qtbot):
    viewer = shown(MRTD)
    read = []
    viewer.canvas.read.connect(read.append)
    box = viewer.canvas._plots[0].getViewBox()
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.0, -1.0)))
    value = float(read[-1].split("MRTD: ")[1].split()[0])
    assert value == pytest.approx(0.1, rel=0.05)
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.8, -1.0)))  # in the gap
    assert read[-1] == ""


def test_the_button_switches_until_something_else_is_plotted(shown, qtbot):
    viewer = shown(MRTD)
    qtbot.mouseClick(viewer.bar.log, Qt.MouseButton.LeftButton)
    _, y = viewer.canvas._curves[0]["0"].getData()
    assert y[100] == pytest.approx(0.1)
    viewer.take(Answer(1, viewer.owner, PortDataQuery(PORT), MRTD))
    assert not viewer.bar.log.isChecked()
    viewer.look_at("b.curve")
    viewer.take(Answer(1, viewer.owner, PortDataQuery("b.curve"), MRTD))
    assert viewer.bar.log.isChecked()


def test_rounding_far_below_does_not_squeeze_a_logarithmic_plot():
    data = CurveData("", "", "MTF", (Series("a", np.arange(3.0), np.array([1.0, 0.1, 1e-30])),))
    (panel,) = curve_drawing(data, log=True).panels
    low, _ = y_range(panel, ["0"])
    assert -9 < low <= -8


def test_csv_of_curves_keeps_infinite_values():
    rows = list(csv.reader(io.StringIO(csv_text(MRTD))))
    assert rows[0] == ["MRTD: frequency (cyc/mrad)", "MRTD: MRTD (K)"]
    assert rows[-1] == ["2.0", "inf"]
