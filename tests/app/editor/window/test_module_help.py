"""F1 shows a module's formulas typeset, and its parameters in a table, in either look."""

import pytest
from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QColor, QImage, QTextDocument, QTextTable
from PySide6.QtTest import QTest

from app.editor.theme import DARK, LIGHT
from app.editor.window.help import ModuleText
from core.modules.declaration import declaration
from window_hands import add, give_focus

IMAGE = int(QTextDocument.ResourceType.ImageResource.value)


@pytest.fixture
def told(window, qtbot, library):
    """The help of a module that has formulas and many parameters, by its key."""
    window.session.select([add(window, "focal_plane")])
    give_focus(window.canvas.view)
    QTest.keyClick(window.canvas.view, Qt.Key.Key_F1)
    made = window.findChild(ModuleText)
    qtbot.waitUntil(lambda: tables(made) != [])
    return made


def tables(told):
    frames = told.text.document().rootFrame().childFrames()
    return [frame for frame in frames if isinstance(frame, QTextTable)]


def formula(told, number):
    return QImage.fromData(told.text.document().resource(IMAGE, QUrl(f"formula:{number}")))


def test_parameters_stand_in_a_table(told, library):
    (table,) = tables(told)

    def cell(row, column):
        cursor = table.cellAt(row, column).firstCursorPosition()
        cursor.setPosition(table.cellAt(row, column).lastPosition(), cursor.MoveMode.KeepAnchor)
        return cursor.selectedText().replace("\u2028", " ")

    heads = [cell(0, column) for column in range(table.columns())]
    assert heads == ["Parameter", "Unit", "Range", "Default", "Meaning"]
    declared = declaration(library["focal_plane"]).parameters
    assert table.rows() == len(declared) + 1
    rows = {cell(row, 0).split()[-1]: row for row in range(1, table.rows())}
    for one in declared:
        row = rows[one.name]
        assert cell(row, 1) == one.param.unit
        assert cell(row, 2) == one.allowed()
        assert cell(row, 4).casefold() == one.param.text.casefold()


def test_formulas_are_drawn_in_the_ink_of_the_look(told, window, qtbot, library):
    many = len(declaration(library["focal_plane"]).formulas)
    assert many > 3
    assert "\\frac" not in told.text.toPlainText()
    for theme in (DARK, LIGHT):
        window.set_theme(theme)

        def inks(theme=theme):
            wanted = QColor(theme.text).rgb()
            picture = formula(told, 0)
            places = [(x, y) for x in range(picture.width()) for y in range(picture.height())]
            return any(picture.pixelColor(*place).rgba() == wanted for place in places)

        qtbot.waitUntil(inks)
    sizes = [(formula(told, n).width(), formula(told, n).height()) for n in range(many)]
    line = told.fontMetrics().height()
    assert all(width > 4 * line and height > 1.6 * line for width, height in sizes)
