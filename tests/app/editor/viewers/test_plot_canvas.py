"""Curves, bars and logarithms as the plot viewer draws them: what they need to be read."""

import csv

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QColor, QKeyEvent

from app.editor.evaluation.queries import Answer
from app.editor.theme import DARK, LIGHT
from app.editor.viewers.plot.plot_canvas import PlotCanvas
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.viewers.plot.plotted_lines import PortDataQuery, curve_drawing
from core.chain.wires import CurveData, CurveMark, Series
from core.editing.operations import set_parameter
from panel_hands import NoEvaluator

PORT = "a.curve"


@pytest.fixture
def shown(session, qtbot):
    """A viewer of data that need no network; gives it."""

    def show(data, theme=DARK, size=(640, 360)):
        viewer = PlotViewer(session, NoEvaluator(session))
        viewer.setPalette(theme.palette())
        viewer.look_at(PORT)
        qtbot.addWidget(viewer)
        viewer.resize(*size)
        viewer.show()
        viewer.take(Answer(1, viewer.owner, PortDataQuery(PORT), data))
        qtbot.wait(20)
        return viewer

    return show


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


def test_bars_are_as_long_as_their_values(shown):
    viewer = shown(bars([10.0, 40.0, np.inf], [5.0, -1.0, 2.0]))
    plot = viewer.canvas.bars
    assert [bar.opts["x1"].tolist() for bar in plot.bars] == [[10.0, 40.0, 0.0], [5.0, 0.0, 2.0]]
    assert [bar.opts["x0"].tolist() for bar in plot.bars] == [[0.0] * 3, [0.0, -1.0, 0.0]]
    seen = plot.getViewBox().viewRange()
    assert seen[0] == pytest.approx([-1.0, 40.0])
    assert seen[1] == pytest.approx([2.5, -0.5] if seen[1][0] > seen[1][1] else [-0.5, 2.5])
    upper, lower = (bar.boundingRect() for bar in plot.bars)
    assert upper.top() < lower.top()
    assert viewer.canvas.accessibleDescription().endswith("; Jitter: ∞, 2")


def test_curves_in_place_of_which_bars_are_drawn_are_gone_from_the_scene(qtbot):
    canvas = PlotCanvas()
    qtbot.addWidget(canvas)
    canvas.show()
    scene = canvas.scene()

    def draw(data, width):
        drawing = curve_drawing(data, log=False)
        canvas.resize(width, 300)
        canvas.show_drawing(drawing, {entry.name for entry in drawing.entries})
        qtbot.wait(20)

    for _ in range(3):
        draw(MRTD, 360)
        draw(MRTD, 200)
        plots = canvas.plots  # held: what the scene still had of them would be freed memory
        draw(bars([10.0, 40.0, 30.0]), 200)
        found = scene.items(scene.sceneRect())
        assert canvas.bars in found
        assert not set(plots) & set(found)


def test_bars_of_one_line_each_have_a_row_and_are_exported_with_their_names(shown, tmp_path):
    plot = shown(bars([10.0, 0.0, 20.0], [0.0, 5.0, 0.0])).canvas.bars
    assert {tuple(bar.opts["y"]) for bar in plot.bars} == {(0.0, 1.0, 2.0)}  # a row each
    assert "Detector: 0, 5" in plot.description
    viewer = shown(bars([10.0, 40.0, np.inf]))
    viewer.export(tmp_path / "b.csv")
    with (tmp_path / "b.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [
            ["stage", "set 0"], ["Optics", "10.0"], ["Detector", "40.0"], ["Jitter", "inf"],
        ]  # fmt: skip
    viewer.export(tmp_path / "b.png")
    assert (tmp_path / "b.png").stat().st_size > 1000


def test_a_logarithmic_curve_is_drawn_with_gaps_and_read_as_it_is(shown):
    viewer = shown(MRTD)
    assert viewer.bar.log.isChecked()
    _, y = viewer.canvas.plots[0].drawn["0"].getData()
    seen = FREQUENCY <= 1.5
    np.testing.assert_allclose(y[seen], FREQUENCY[seen] - 2.0, atol=1e-12)
    assert np.isnan(y[~seen]).all()
    low, high = viewer.canvas.plots[0].getViewBox().viewRange()[1]
    assert low < -2.0 < -0.5 < high < 0.0
    read = []
    viewer.canvas.read.connect(read.append)
    box = viewer.canvas.plots[0].getViewBox()
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.0, -1.0)))
    value = float(read[-1].split("MRTD: ")[1].split()[0])
    assert value == pytest.approx(0.1, rel=0.05)
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.8, -1.0)))  # in the gap
    assert read[-1] == ""


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


def test_a_mark_in_a_low_plot_has_its_number_alone(shown):
    series = (Series("a", FREQUENCY, np.cos(FREQUENCY)),)
    viewer = shown(CurveData("", "x", "MTF", series, marks=(CurveMark("pixels' Nyquist", 0.5),)))
    (mark,) = viewer.canvas.plots[0].marks
    assert mark.label.format == "pixels' Nyquist 0.5"
    viewer.canvas.plots[0].getViewBox().resize(300, 60)
    assert mark.label.format == "0.5"


def test_a_measured_mtf_marks_half_a_cycle_per_pixel(window, idle):
    window.files.open_now("measured_mtf")
    idle(window)
    plot = window.viewers.plot
    assert plot.port == "measured.curve"
    image = window.evaluator.plan.output("electronics.image")
    assert image.interval_x_mrad == pytest.approx(image.interval_y_mrad)
    (mark,) = plot.canvas.drawing.marks
    assert mark.text == "Nyquist"
    assert mark.x == pytest.approx(0.5 / image.interval_x_mrad)
    window.session.do(set_parameter("measured", "axis", "cyc_per_pixel"))
    idle(window)
    (mark,) = plot.canvas.drawing.marks
    assert mark.x == 0.5


def test_keys_read_along_a_curve_and_from_curve_to_curve(shown, qtbot):
    """Each step is a hundredth of the abscissa, ten with Shift; nothing is read beyond its ends."""
    canvas = shown(NOW).canvas
    read = []
    canvas.read.connect(read.append)

    def press(key, modifier=Qt.KeyboardModifier.NoModifier):
        qtbot.keyClick(canvas, key, modifier)
        place, _, value = read[-1].partition(" cyc/mrad   ")
        title, value = value.split(": ")
        assert canvas.plots[0].cursor.value() == pytest.approx(float(place), abs=1e-4)
        return title.removesuffix(", MTF"), float(place), float(value)

    keys, shift = Qt.Key, Qt.KeyboardModifier.ShiftModifier
    assert press(keys.Key_Right) == ("optics", 0.01, 0.99)
    assert press(keys.Key_Right, shift) == ("optics", 0.11, 0.89)
    assert press(keys.Key_Down) == ("detector", 0.11, 0.945)
    assert press(keys.Key_Up) == ("optics", 0.11, 0.89)
    assert press(keys.Key_Up) == ("jitter", 0.11, 0.9725)  # from the first to the last
    assert press(keys.Key_Left) == ("jitter", 0.1, 0.975)
    assert press(keys.Key_Left, shift) == ("jitter", 0.0, 1.0)
    assert press(keys.Key_Left) == ("jitter", 0.0, 1.0)
    canvas.set_limits(False, 0.2, 0.4)
    assert canvas.limits(False) == pytest.approx((0.2, 0.4))
    passed_on = QKeyEvent(QEvent.Type.KeyPress, keys.Key_Q, Qt.KeyboardModifier.NoModifier)
    canvas.keyPressEvent(passed_on)
    assert not passed_on.isAccepted()
    assert not canvas.framed
    press(keys.Key_F)
    assert canvas.limits(False) == pytest.approx((-0.02, 1.02))


@pytest.mark.parametrize("lines", [1, 2])
@pytest.mark.parametrize("height", [250, 900])
def test_bars_of_a_group_touch_and_groups_stand_apart(shown, lines, height):
    """Lower or higher: six dots between groups, and no bar above one and a half lines of text."""
    plot = shown(bars(*[[10.0, 40.0, 30.0]] * lines), size=(640, height)).canvas.bars
    group = plot.getViewBox().height() / len(NAMES)
    places = np.array([bar.opts["y"] for bar in plot.bars])
    thick = plot.bars[0].opts["height"] * group / 0.94
    assert places.mean(axis=0) == pytest.approx([0.0, 1.0, 2.0])
    assert np.diff(places, axis=0) * group == pytest.approx(thick)
    widest = 1.5 * plot._metrics.height()
    assert thick == pytest.approx(min(widest, (group - 6) / lines))
    assert plot.least_height >= len(NAMES) * (lines * plot._metrics.height() + 6)


def test_logarithmic_bars_begin_at_the_decade_below_the_least(shown):
    plot = shown(bars([20.0, 300.0, 0.0], log=True)).canvas.bars
    assert plot.bars[0].opts["x0"] == pytest.approx([1.0, 1.0, 1.0])
    assert plot.bars[0].opts["x1"] == pytest.approx([*np.log10([20.0, 300.0]), 1.0])
    assert plot.getViewBox().viewRange()[0] == pytest.approx([1.0, np.log10(300.0)])
    assert plot.getAxis("bottom").labelText == "share (%), logarithmic"
    texts = [text for _, text in plot.getAxis("right")._tickLevels[0]]
    assert texts == ["20", "300", "0"]
