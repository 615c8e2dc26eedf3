"""What a person chooses in the trade-off dock, drags, undoes and writes."""

import csv

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMenu

from app.editor.docks.tradeoff_plots import Span
from app.editor.theme import LIGHT
from tradeoff_network import mtf
from window_hands import give_focus

KEY, LEFT = Qt.Key, Qt.MouseButton.LeftButton
SIGMA, LISTED = "blur.sigma_x_mrad", "σ x of blur (mrad)"
MTF = "total.mtf_nyquist_x"


def sigma(window):
    return window.session.network.nodes["blur"].params["sigma_x_mrad"]


def open_figures(view):
    """What a press on the button opens, which would wait in a loop of its own."""
    view.bar.figures.menu().popup(view.bar.figures.mapToGlobal(QPoint(0, 0)))
    return {view.list.item(row).text(): view.list.item(row) for row in range(view.list.count())}


def test_it_is_hidden_until_it_is_asked_for(opened_window, idle):
    window = opened_window
    view, action = window.viewers.tradeoff, window.actions_by_name["trade_off"]
    assert not view.isVisible()
    assert not action.isChecked()
    assert view.list.count() == 0  # nothing is listed that nobody sees
    give_focus(window.canvas.view)
    QTest.keyClick(window.canvas.view, KEY.Key_T, Qt.KeyboardModifier.ControlModifier)
    idle(window)
    assert view.isVisible()
    assert action.isChecked()
    assert view.bar.parameter.hasFocus()
    assert view.list.count() == 0
    open_figures(view)
    assert view.list.count() == len(view.figures) > 5
    view.bar.figures.menu().close()
    QTest.keyClick(view.bar.parameter, KEY.Key_T, Qt.KeyboardModifier.ControlModifier)
    assert not view.isVisible()
    assert not action.isChecked()


def test_a_parameter_is_chosen_by_the_keyboard(opened_window, idle):
    window = opened_window
    window.actions_by_name["trade_off"].trigger()
    view = window.viewers.tradeoff
    combo = view.bar.parameter
    give_focus(combo)
    assert combo.currentText() == "Choose a parameter"
    for _ in range(combo.findText(LISTED)):
        if combo.currentText() != LISTED:
            QTest.keyClick(combo, KEY.Key_Down)
    assert combo.currentText() == LISTED
    assert combo.toolTip() == SIGMA
    idle(window)
    span = view.span
    assert (span.low, span.high) == (0.0, 1.0)  # around the present 0.5
    drawn = next(each for each in view.plots.graphs if each.name == MTF)
    x, y = drawn.x, drawn.y
    assert len(x) == span.count
    assert y == pytest.approx([mtf(value) for value in x], rel=1e-12)


def test_a_parameter_is_found_by_typing_a_part_of_its_name(opened_window, idle):
    window = opened_window
    window.actions_by_name["trade_off"].trigger()
    view = window.viewers.tradeoff
    combo = view.bar.parameter
    give_focus(combo)
    idle(window)
    field = combo.lineEdit()
    QTest.keyClicks(field, "y of blur")
    listed = combo.completer().completionModel()
    assert [listed.index(row, 0).data() for row in range(listed.rowCount())] == [
        "σ y of blur (mrad)"
    ]
    QTest.keyClicks(field, " of nothing")
    QTest.keyClick(field, KEY.Key_Return)
    assert combo.currentText() == "Choose a parameter"  # what is none is not taken
    field.selectAll()
    QTest.keyClicks(field, "Y OF blur")
    popup = combo.completer().popup()
    QTest.keyClick(popup, KEY.Key_Down)
    QTest.keyClick(popup, KEY.Key_Return)
    idle(window)
    assert view.bar.parameter.toolTip() == "blur.sigma_y_mrad"
    assert len(view.points) == view.span.count
    field.selectAll()
    QTest.keyClicks(field, SIGMA)  # as the history, links and `--vary` write it
    QTest.keyClick(field, KEY.Key_Return)
    assert combo.currentText() == LISTED
    assert combo.toolTip() == SIGMA


def test_the_menu_of_a_value_leads_to_it(opened_window, idle, qtbot):
    window = opened_window
    window.session.select(["jitter"])
    idle(window)
    field = window.panels.panels["jitter"].body.sections.field("sigma_mrad")
    window.panels.ensureWidgetVisible(field)
    at = field.label.rect().center()
    QTest.mouseClick(field.label, Qt.MouseButton.RightButton, pos=at)
    field.open_menu(field.label.mapToGlobal(at))
    menu = field.findChild(QMenu, "field.menu")
    action = next(each for each in menu.actions() if each.objectName() == "trade_off")
    action.trigger()
    menu.close()
    idle(window)
    view = window.viewers.tradeoff
    assert view.isVisible()
    assert view.bar.parameter.currentText() == "σ of jitter (mrad)"
    assert len(view.points) == view.span.count


def test_a_long_name_is_shown_from_its_beginning(dock):
    """Integration time of focal_plane (s) is wider than the field."""
    field = dock.bar.parameter.lineEdit()
    assert field.text() == LISTED
    assert field.cursorPosition() == 0


def test_choices_have_no_such_menu(opened_window, idle):
    opened_window.session.select(["electronics"])
    idle(opened_window)
    field = opened_window.panels.panels["electronics"].body.sections.field("gain_model")
    field.open_menu(QPoint(10, 10))
    menu = field.findChild(QMenu, "field.menu")
    assert "trade_off" not in [each.objectName() for each in menu.actions()]
    menu.close()


def test_a_drag_of_the_mark_is_one_step_to_undo(opened_window, dock, idle, qtbot):
    plots, before = dock.plots, opened_window.session.network
    start, end = (plots.place(0, value).toPoint() for value in (0.5, 0.9))
    QTest.mousePress(plots, LEFT, pos=start)
    for share in (0.25, 0.5, 0.75, 1.0):
        QTest.mouseMove(plots, start + (end - start) * share)
    QTest.mouseRelease(plots, LEFT, pos=end)
    assert sigma(opened_window) == pytest.approx(0.9, abs=0.01)
    assert plots.mark == sigma(opened_window)
    idle(opened_window)
    opened_window.actions_by_name["undo"].trigger()
    assert opened_window.session.network == before
    assert sigma(opened_window) == 0.5
    assert plots.mark == 0.5


def test_clicks_and_keys_set_the_parameter_each_as_a_step(opened_window, dock):
    QTest.mouseClick(dock.plots, LEFT, pos=dock.plots.place(1, 0.2).toPoint())
    assert sigma(opened_window) == pytest.approx(0.2, abs=0.01)
    QTest.mouseClick(dock.plots, LEFT, pos=dock.plots.place(0, 0.7).toPoint())
    opened_window.session.undo()
    assert sigma(opened_window) == pytest.approx(0.2, abs=0.01)
    opened_window.session.undo()
    give_focus(dock.plots)
    QTest.keyClick(dock.plots, KEY.Key_Right)
    assert sigma(opened_window) == pytest.approx(0.51)
    QTest.keyClick(dock.plots, KEY.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    assert sigma(opened_window) == pytest.approx(0.41)
    opened_window.session.undo()
    assert sigma(opened_window) == pytest.approx(0.51)


def test_another_range_and_number_of_points(opened_window, dock, idle, graph):
    for edit, text in ((dock.bar.low, "0.1"), (dock.bar.high, "10")):
        give_focus(edit)
        edit.selectAll()
        QTest.keyClicks(edit, text)
        QTest.keyClick(edit, KEY.Key_Return)
    dock.bar.log.click()
    dock.bar.count.setValue(3)
    idle(opened_window)
    assert dock.span == Span(0.1, 10.0, log=True, count=3)
    assert graph(MTF).x == pytest.approx([0.1, 1.0, 10.0])


@pytest.mark.parametrize(
    ("text", "told"), [("x", "'x' is not a number"), ("7", "below the second")]
)
def test_a_range_that_is_none_is_refused(opened_window, dock, text, told):
    give_focus(dock.bar.low)
    dock.bar.low.selectAll()
    QTest.keyClicks(dock.bar.low, text)
    QTest.keyClick(dock.bar.low, KEY.Key_Return)
    assert told in dock.status.title.text()
    assert dock.bar.low.marked
    assert dock.span.low == 0.0
    QTest.keyClick(dock.bar.low, KEY.Key_Escape)
    assert dock.bar.low.text() == "0"


def test_figures_are_ticked_in_the_list(opened_window, dock, idle, graph):
    rows = open_figures(dock)
    assert rows["NETD system of electronics (K)"].checkState() == Qt.CheckState.Checked
    rows["NER of electronics (W/m²/sr)"].setCheckState(Qt.CheckState.Checked)
    idle(opened_window)
    assert [each.name for each in dock.plots.graphs] == [
        "electronics.ner",
        "electronics.netd_system_K",
        "electronics.snr",
        MTF,
    ]
    assert np.isfinite(graph("electronics.ner").y).all()
    assert dock.list.isVisible()
    dock.bar.figures.menu().close()
    assert not dock.list.isVisible()


def test_the_list_is_searched_and_has_the_names_in_full(dock, qtbot):
    rows = open_figures(dock)
    search = dock.bar.choice.search
    qtbot.waitUntil(search.hasFocus)
    QTest.keyClicks(search, "mtf pixels")
    shown = {text for text, item in rows.items() if not item.isHidden()}
    assert shown == {text for text in rows if "MTF" in text and "pixels" in text}
    assert 1 < len(shown) < len(rows)
    QTest.keyClick(search, KEY.Key_Tab)
    assert dock.list.hasFocus()
    search.clear()
    assert not any(item.isHidden() for item in rows.values())
    room = dock.list.viewport().width()
    assert dock.list.sizeHintForColumn(0) <= room
    dock.bar.figures.menu().close()


def test_the_charts_have_the_width_of_the_dock_and_each_its_height(dock, idle, opened_window):
    assert dock.plots.width() >= dock.width() - 30
    for name in list(open_figures(dock))[:9]:
        open_figures(dock)[name].setCheckState(Qt.CheckState.Checked)
        idle(opened_window)
    dock.bar.figures.menu().close()
    dock.resize(dock.width(), 260)
    idle(opened_window)
    dock.plots.grab()
    line = dock.plots.fontMetrics().height()
    heights = [frame.height() for frame in dock.plots._frames]
    assert len(heights) >= 9
    assert min(heights) > 2.2 * line


def test_numbers_and_pictures_are_written(opened_window, dock, tmp_path, graph):
    give_focus(dock.plots)
    opened_window.actions_by_name["export"].trigger()
    dialog = opened_window.findChild(QFileDialog, "export_dialog")
    dialog.fileSelected.emit(str(tmp_path / "a.csv"))
    dialog.reject()
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row[SIGMA]) for row in rows] == list(graph(MTF).x)
    assert [float(row[MTF]) for row in rows] == list(graph(MTF).y)
    dock.export(tmp_path / "a.png")
    assert QImage(str(tmp_path / "a.png")).width() == 2 * dock.plots.width()


def test_the_status_line_reads_under_the_mouse(dock):
    QTest.mouseMove(dock.plots, dock.plots.place(0, 0.5).toPoint())
    told = dock.status.more.text()
    assert "NETD system" in told
    assert "MTF ξ, samples' Nyquist" in told
    QTest.mouseMove(dock.plots, QPoint(1, 1))
    assert dock.status.more.text() == ""


def test_every_control_is_reached_and_named(dock):
    bar = dock.bar
    for widget in (
        bar.parameter,
        bar.low,
        bar.high,
        bar.log,
        bar.count,
        bar.figures,
        dock.plots,
        dock.list,
    ):
        assert widget.focusPolicy() & Qt.FocusPolicy.TabFocus, widget.objectName()
        assert widget.accessibleName(), widget.objectName()


def test_the_light_look_is_light(dock):
    dock.setPalette(LIGHT.palette())
    picture = dock.plots.grab().toImage()
    assert picture.pixelColor(picture.width() - 2, 2).lightness() > 200
