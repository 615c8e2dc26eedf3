"""Of a file's path its own name is seen at any width, all of it while it is edited."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from core.editing.operations import set_parameter
from panel_hands import drop, field_of, panel_area

NAME = "runway_after_rain.exr"
LONG = "/data/campaigns/2024-spring/flights/17/calibrated/radiance/" + NAME


@pytest.fixture
def area(qtbot, session):
    made = panel_area(qtbot, session)
    drop(session, "read_image")
    return made


def line_of(area, session, path, width=360):
    """The line with that path in a panel of that width, without the focus."""
    area.resize(width, 700)
    session.do(set_parameter("node", "path", path))
    field = field_of(area, session, "path")
    area.setFocus()
    QTest.qWait(50)
    assert not field.edit.hasFocus()
    return field.edit


def ink(line):
    """Which dots of the line, seen without its frame, are not ground."""
    image = line.grab().toImage()
    ground = image.pixelColor(image.width() - 6, 5)
    return [
        (x, y)
        for x in range(4, image.width() - 4)
        for y in range(4, image.height() - 4)
        if abs(image.pixelColor(x, y).lightness() - ground.lightness()) > 40
    ]


@pytest.mark.parametrize("width", [300, 800])
def test_the_files_name_is_seen_at_any_width(area, session, width):
    line = line_of(area, session, LONG, width)
    room = line.width()
    fits = line.fontMetrics().horizontalAdvance(NAME) < room - 16
    shown = line.shown_text()
    assert line.fontMetrics().horizontalAdvance(shown) < room
    if fits:
        assert shown.endswith(NAME)
    assert shown.endswith("exr")
    assert line.text() == LONG  # for screen readers, and to be copied
    right = max(x for x, _ in ink(line))
    assert right < room - 4  # no letter is cut by the end of the line


def test_while_it_is_edited_all_of_it_is_there(area, session, qtbot):
    line = line_of(area, session, LONG)
    QTest.mouseClick(line, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(line.hasFocus)
    assert line.shown_text() == LONG
    QTest.keyClick(line, Qt.Key.Key_End)
    QTest.keyClicks(line, "2")
    QTest.keyClick(line, Qt.Key.Key_Return)
    assert session.network.nodes["node"].params["path"] == LONG + "2"
