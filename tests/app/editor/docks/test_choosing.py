"""What a person chooses in the trade-off dock, drags, undoes and writes."""

import csv

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMenu

from app.editor.docks.tradeoff_plots import Span
from core.editing import macros
from core.editing.operations import rename_node
from window_hands import give_focus, place_in

KEY, LEFT = Qt.Key, Qt.MouseButton.LeftButton
SIGMA, LISTED = "blur.sigma_x_mrad", "σ x of blur (mrad)"
MTF = "total.mtf_nyquist_x"


def sigma(window):
    return window.session.network.nodes["blur"].params["sigma_x_mrad"]


def open_figures(view):
    """What a press on the button opens, which would wait in a loop of its own."""
    view.choice.popup(view.choose.mapToGlobal(QPoint(0, 0)))
    return {view.list.item(row).text(): view.list.item(row) for row in range(view.list.count())}


def test_a_parameter_is_found_by_keys_by_typing_and_by_the_menu_of_its_value(opened_window, idle):
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
    combo = view.parameter
    assert combo.hasFocus()
    assert view.list.count() == 0
    open_figures(view)
    assert view.list.count() == len(view.figures) > 5
    view.choice.close()
    give_focus(combo)
    field = combo.lineEdit()
    field.selectAll()
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
    assert combo.toolTip() == "blur.sigma_y_mrad"
    assert len(view.points) == view.span.count
    field.selectAll()
    QTest.keyClicks(field, SIGMA)  # as the history, links and `--vary` write it
    QTest.keyClick(field, KEY.Key_Return)
    assert combo.currentText() == LISTED
    assert combo.toolTip() == SIGMA
    give_focus(combo)
    QTest.keyClick(combo, KEY.Key_T, Qt.KeyboardModifier.ControlModifier)
    assert not view.isVisible()
    assert not action.isChecked()
    # The menu of a value leads to it.
    window.session.select(["jitter"])
    idle(window)
    field = window.panels.panels["jitter"].body.sections.field("sigma_mrad")
    choose_trade_off(window, field)
    idle(window)
    assert view.isVisible()
    assert combo.currentText() == "σ of jitter (mrad)"
    assert len(view.points) == view.span.count


def choose_trade_off(window, field):
    """By the menu of the right button."""
    window.panels.ensureWidgetVisible(field)
    at = field.label.rect().center()
    QTest.mouseClick(field.label, Qt.MouseButton.RightButton, pos=at)
    field.open_menu(field.label.mapToGlobal(at))
    menu = field.findChild(QMenu, "field.menu")
    next(each for each in menu.actions() if each.objectName() == "trade_off").trigger()
    menu.close()


def test_drags_clicks_and_keys_set_the_parameter_each_as_a_step(opened_window, dock, idle):
    plots, before = dock.plots, opened_window.session.network
    start, end = (place_in(plots, 0, value).toPoint() for value in (0.5, 0.9))
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
    QTest.mouseClick(dock.plots, LEFT, pos=place_in(dock.plots, 1, 0.2).toPoint())
    assert sigma(opened_window) == pytest.approx(0.2, abs=0.01)
    QTest.mouseClick(dock.plots, LEFT, pos=place_in(dock.plots, 0, 0.7).toPoint())
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


def test_range_and_figures_are_chosen_and_written(opened_window, dock, idle, graph, tmp_path):
    give_focus(dock.range)
    for text in ("0.1:10", "0.1:10:3:log"):
        dock.range.selectAll()
        QTest.keyClicks(dock.range, text)
        QTest.keyClick(dock.range, KEY.Key_Return)
        if text == "0.1:10":
            assert "write FROM:TO:COUNT" in dock.status.title.text()
            assert dock.span == Span(0.0, 1.0)
    idle(opened_window)
    assert dock.span == Span(0.1, 10.0, log=True, count=3)
    assert graph(MTF).x == pytest.approx([0.1, 1.0, 10.0])
    rows = open_figures(dock)
    assert rows["NETD system of electronics (K)"].checkState() == Qt.CheckState.Checked
    rows["NER of electronics (W/m²/sr)"].setCheckState(Qt.CheckState.Checked)
    idle(opened_window)
    assert [line.name for _, line in dock.plots.graphs] == [
        MTF,
        "electronics.ner",
        "electronics.netd_system_K",
        "electronics.snr",
    ]
    assert np.isfinite(graph("electronics.ner").y).all()
    assert dock.list.isVisible()
    dock.choice.close()
    assert not dock.list.isVisible()
    give_focus(dock.plots)
    opened_window.actions_by_name["export"].trigger()
    dialog = opened_window.findChild(QFileDialog, "export_dialog")
    dialog.fileSelected.emit(str(tmp_path / "a.csv"))
    dialog.reject()
    with (tmp_path / "a.csv").open(newline="") as file:
        written = list(csv.DictReader(file))
    assert [float(row[SIGMA]) for row in written] == list(graph(MTF).x)
    assert [float(row[MTF]) for row in written] == list(graph(MTF).y)
    dock.export(tmp_path / "a.png")
    assert QImage(str(tmp_path / "a.png")).width() == 2 * dock.plots.width()


def test_what_is_varied_and_shown_follows_a_macro_that_is_renamed(opened_window, idle):
    session, views = opened_window.session, opened_window.viewers
    name, grouped = macros.group(session.network, session.library, ["blur"], "lens")
    session.do(grouped)
    end, grouped = macros.group(session.network, session.library, ["electronics"], "end")
    session.do(grouped)
    views.trade_off(f"{name}/blur", "sigma_x_mrad")
    view = views.tradeoff
    view.show_figure(MTF, False)
    view.show_figure(f"{end}/electronics.snr", True)
    session.do(rename_node(name, "telescope"))
    session.do(rename_node(end, "camera"))
    idle(opened_window)
    assert (view.varied.node, view.varied.name) == ("telescope/blur", "sigma_x_mrad")
    assert "camera/electronics.snr" in [one.name for _, one in view.plots.graphs]
