"""Every plot of the window has a menu: copy it, save it, its numbers, its axes."""

import csv
import io

import numpy as np
import pytest
from PySide6.QtGui import QContextMenuEvent, QGuiApplication, QImage
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit

from app.editor.docks.edges import DrawnEdge
from window_hands import show_small

COPY, NUMBERS, SAVE = "plot.copy", "plot.copy_numbers", "plot.save"


def menu_of(widget):
    """The menu of the right button or of the menu key."""
    point = widget.rect().center()
    reason = QContextMenuEvent.Reason.Keyboard
    QApplication.sendEvent(widget, QContextMenuEvent(reason, point, widget.mapToGlobal(point)))
    return opened()


def opened():
    menu = QApplication.activePopupWidget()
    assert menu is not None
    return menu


def names(menu):
    return [action.objectName() for action in menu.actions() if action.objectName()]


def choose(menu, name):
    action = next(action for action in menu.actions() if action.objectName() == name)
    menu.close()
    action.trigger()


def copied_rows():
    return list(csv.reader(io.StringIO(QGuiApplication.clipboard().text())))


def saved(widget, path):
    """Save by the menu, and answer the dialog."""
    choose(menu_of(widget), SAVE)
    dialog = widget.findChild(QFileDialog, "plot_dialog")
    dialog.selectFile(str(path))
    dialog.accept()
    QApplication.processEvents()
    return path.read_bytes()


def limits_are_typed(canvas):
    """And all is shown again."""
    whole = canvas.limits(False)
    menu = menu_of(canvas)
    line = menu.findChild(QLineEdit, "plot.limits.abscissa")
    assert " to " in line.text()
    line.setText("1.5 to x")
    line.returnPressed.emit()
    assert opened() is menu  # nothing that could be used
    line.setText("0.5 to 1.5")
    line.returnPressed.emit()
    assert canvas.limits(False) == pytest.approx((0.5, 1.5))
    menu = menu_of(canvas)
    line = menu.findChild(QLineEdit, "plot.limits.ordinate")
    line.setText("-0.25, 1e0")
    line.returnPressed.emit()
    assert canvas.limits(True) == pytest.approx((-0.25, 1.0))
    assert canvas.limits(False) == pytest.approx((0.5, 1.5))
    choose(menu_of(canvas), "plot.all")
    assert canvas.limits(False) == pytest.approx(whole)


def test_every_plot_has_its_menu(window, idle, tmp_path):
    show_small(window, "mwir_camera")
    idle(window)
    window.activateWindow()
    window.session.select(["jitter"])
    idle(window)
    # Curves are copied, saved, and seen by their logarithm.
    plot = window.viewers.plot
    canvas = plot.canvas
    assert names(menu_of(canvas))[:4] == [COPY, NUMBERS, SAVE, "plot.log"]
    choose(opened(), COPY)
    assert not QGuiApplication.clipboard().pixmap().isNull()
    choose(menu_of(canvas), NUMBERS)
    rows = copied_rows()
    assert rows[0][0] == "frequency_cyc_per_mrad"
    assert "jitter.mtf" in rows[0]
    choose(menu_of(canvas), "plot.log")
    assert plot.bar.log.isChecked()
    assert canvas.drawing.panels[0].log
    choose(menu_of(canvas), "plot.log")
    limits_are_typed(canvas)
    # A histogram is copied as numbers.
    viewer = window.viewers.images[1]
    viewer._open_menu(viewer.mapToGlobal(viewer.rect().center()))
    choose(opened(), "copy_histogram")
    (unit, samples), *rows = copied_rows()
    assert (unit, samples) == (viewer.picture.facts.unit, "samples")
    assert [int(count) for _, count in rows] == viewer.picture.spread.counts.tolist()
    # A trade-off is saved as picture and numbers.
    window.viewers.trade_off("jitter", "sigma_mrad")
    idle(window)
    plots = window.viewers.tradeoff.plots
    assert names(menu_of(plots)) == [COPY, NUMBERS, SAVE]
    opened().close()
    assert QImage.fromData(saved(plots, tmp_path / "trade.png")).width() == 2 * plots.width()
    assert saved(plots, tmp_path / "trade.csv").count(b"\n") > 10
    assert b"<svg" in saved(plots, tmp_path / "trade.svg")
    # A fit gives its samples.
    chart = window.fitting.chart
    window.fit_dock.show()
    assert NUMBERS not in names(menu_of(chart))
    opened().close()
    chart.show_edge(DrawnEdge("edge", np.arange(3.0), np.arange(3.0), np.ones(3)))
    choose(menu_of(chart), NUMBERS)
    assert copied_rows() == [
        ["distance (samples)", "picture", "chain"],
        *([f"{place}.0", f"{place}.0", "1.0"] for place in range(3)),
    ]
