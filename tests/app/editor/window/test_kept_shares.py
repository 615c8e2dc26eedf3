"""Docks keep the shares of the window that the user gives them, and only those."""

import itertools

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QDockWidget

from app.editor.window.viewer_docks import in_sight

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


@pytest.fixture
def opened(window, idle):
    window.files.open_now("first_steps")
    idle(window)
    return window


def title_of(dock):
    """A point on a dock's title."""
    return QPoint(40, 8)


def drag_separator(window, dx):
    start, bench = QPoint(window.panel_dock.x() - 3, window.panel_dock.y() + 200), window.workbench
    QTest.mousePress(bench, LEFT, PLAIN, start)
    for step in (4, dx // 2, dx):
        QTest.mouseMove(bench, start + QPoint(step, 0))
        QTest.qWait(30)
    QTest.mouseRelease(bench, LEFT, PLAIN, start + QPoint(dx, 0))


def test_a_floated_dock_leaves_its_room_to_the_others(opened, idle, qtbot):
    drag_separator(opened, -90)
    idle(opened)
    before = opened.layout_in_use.shares
    QTest.mouseDClick(opened.panel_dock, LEFT, PLAIN, title_of(opened.panel_dock))
    qtbot.waitUntil(opened.panel_dock.isFloating)
    idle(opened)
    now = opened.layout_in_use.shares
    assert "dock.panels" in before
    assert "dock.panels" not in now
    curves = opened.viewers.plot_dock
    assert now["dock.curves"][1] == pytest.approx(curves.height() / opened.workbench.height())
    assert now["dock.curves"][1] > 1.5 * before["dock.curves"][1]
    opened.resize(2000, 1125)
    idle(opened)
    assert curves.width() == pytest.approx(now["dock.curves"][0] * 2000, abs=3)
    opened.panel_dock.setFloating(False)  # its title is the window manager's now
    idle(opened)
    assert opened.layout_in_use.shares["dock.panels"][0] == pytest.approx(
        opened.panel_dock.width() / 2000
    )


@pytest.mark.parametrize("layout", ["canvas_first", "picture_below", "picture_beside"])
def test_at_the_least_size_no_part_covers_another(window, qtbot, layout):
    window.files.open_now("first_steps")
    window.resize(704, 463)
    window.choose_layout(layout)
    qtbot.wait(100)
    docks = [dock for dock in window.findChildren(QDockWidget) if in_sight(dock)]
    assert len(docks) >= 3
    for one, other in itertools.combinations(docks, 2):
        assert not one.geometry().intersects(other.geometry()), (
            one.objectName(),
            other.objectName(),
        )
