"""Of a file's path its own name is seen at any width, all of it while it is edited."""

import html

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest

from app.editor.evaluation.queries import Badge
from app.editor.theme import DARK
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


@pytest.mark.parametrize("width", [300, 360, 500, 800, 1600])
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


def test_two_files_of_one_folder_look_different(area, session):
    one = ink(line_of(area, session, LONG, 420))
    other = ink(line_of(area, session, LONG.replace("rain", "snow"), 420))
    assert one != other


def test_the_middle_of_the_folder_goes_first(area, session):
    shown = line_of(area, session, LONG, 640).shown_text()
    folder, _, name = shown.rpartition("/")
    assert name == NAME
    assert folder.startswith("/d")
    assert folder.count("…") == 1


def test_a_short_path_is_shown_whole(area, session):
    assert line_of(area, session, "a/b.exr").shown_text() == "a/b.exr"


def test_while_it_is_edited_all_of_it_is_there(area, session, qtbot):
    line = line_of(area, session, LONG)
    QTest.mouseClick(line, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(line.hasFocus)
    assert line.shown_text() == LONG
    QTest.keyClick(line, Qt.Key.Key_End)
    QTest.keyClicks(line, "2")
    QTest.keyClick(line, Qt.Key.Key_Return)
    assert session.network.nodes["node"].params["path"] == LONG + "2"


def test_the_tooltip_has_the_whole_path(area, session, tmp_path):
    assert html.escape(LONG) in line_of(area, session, LONG).toolTip()
    tip = line_of(area, session, "pictures/a.exr").toolTip()
    assert html.escape((session.folder.absolute() / "pictures/a.exr").as_posix()) in tip


def test_a_refused_path_keeps_its_frame(area, session, qtbot):
    line = line_of(area, session, LONG)
    line.mark()
    image = line.grab().toImage()
    assert QColor(image.pixel(1, image.height() // 2)).name() == DARK.error


def test_an_error_with_a_long_name_leaves_the_panel_its_width(area, session):
    line_of(area, session, "short.png")
    panel = area.panels["node"]
    width = panel.width()
    area.set_badges({"node": Badge("error", f"/data/{'m' * 250}.png: no such file")})
    QTest.qWait(50)
    problem = panel.head.problem
    assert panel.width() == width
    assert problem.text().replace("\u200b", "") == f"/data/{'m' * 250}.png: no such file"
    letters = 255 * problem.fontMetrics().horizontalAdvance("m") / problem.width()
    assert problem.height() >= int(letters) * problem.fontMetrics().height()  # all of it is seen
