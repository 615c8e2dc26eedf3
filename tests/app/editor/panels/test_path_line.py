"""Of a file's path its own name is seen, however long its folder."""

from PySide6.QtCore import QPoint

from core.editing.operations import set_parameter
from panel_hands import drop, field_of, panel_area

LONG = "/data/campaigns/2024-spring/flights/17/calibrated/radiance/runway_after_rain.exr"


def test_the_end_of_a_path_is_seen(qtbot, session):
    area = panel_area(qtbot, session, width=360)
    drop(session, "read_image")
    session.do(set_parameter("node", "path", LONG))
    line = field_of(area, session, "path").edit
    area.setFocus()
    line.grab()
    assert line.text() == LONG
    assert line.fontMetrics().horizontalAdvance(LONG) > line.width()
    assert line.cursorPositionAt(QPoint(line.width() - 3, line.height() // 2)) == len(LONG)
