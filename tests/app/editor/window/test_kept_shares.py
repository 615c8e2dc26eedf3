"""Docks keep the shares of the window that the user gives them, and only those."""

import itertools

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QDockWidget

from app.editor.window.viewer_docks import in_sight

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def drag_separator(window, dx):
    start, bench = QPoint(window.panel_dock.x() - 3, window.panel_dock.y() + 200), window.workbench
    QTest.mousePress(bench, LEFT, PLAIN, start)
    for step in (4, dx // 2, dx):
        QTest.mouseMove(bench, start + QPoint(step, 0))
        QTest.qWait(30)
    QTest.mouseRelease(bench, LEFT, PLAIN, start + QPoint(dx, 0))


def test_docks_keep_what_the_user_gives_them(window, idle, qtbot):
    window.files.open_now("first_steps")
    idle(window)
    first = window.panel_dock.width()
    drag_separator(window, -90)
    idle(window)
    assert window.panel_dock.width() == pytest.approx(first + 90, abs=8)
    before = window.layout_in_use.shares
    # A floated dock leaves its room to the others.
    QTest.mouseDClick(window.panel_dock, LEFT, PLAIN, QPoint(40, 8))
    qtbot.waitUntil(window.panel_dock.isFloating)
    idle(window)
    now = window.layout_in_use.shares
    assert "dock.panels" in before
    assert "dock.panels" not in now
    curves = window.viewers.plot_dock
    assert now["dock.curves"][1] == pytest.approx(curves.height() / window.workbench.height())
    assert now["dock.curves"][1] > 1.5 * before["dock.curves"][1]
    window.resize(2000, 1125)
    idle(window)
    assert curves.width() == pytest.approx(now["dock.curves"][0] * 2000, abs=3)
    window.panel_dock.setFloating(False)  # its title is the window manager's now
    idle(window)
    wide = window.panel_dock.width()
    assert window.layout_in_use.shares["dock.panels"][0] == pytest.approx(wide / 2000)
    window.resize(2400, 1350)
    idle(window)
    assert window.panel_dock.width() == pytest.approx(1.2 * wide, abs=3)
    # At the least size no part covers another.
    window.resize(704, 463)
    view = window.menus["&View"]
    for layout in ("canvas_first", "picture_below", "picture_beside"):
        view.popup(window.mapToGlobal(QPoint(0, 0)))
        QTest.mouseClick(
            view, LEFT, pos=view.actionGeometry(window.actions_by_name[layout]).center()
        )
        idle(window)
        docks = [dock for dock in window.findChildren(QDockWidget) if in_sight(dock)]
        assert len(docks) >= 2
        for one, other in itertools.combinations([*docks, window.workbench.centralWidget()], 2):
            names = layout, one.objectName(), other.objectName()
            assert not one.geometry().intersects(other.geometry()), names
            assert window.workbench.rect().contains(one.geometry()), names
