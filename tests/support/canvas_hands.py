"""Real mouse events on the canvas's view, at the places of its parts or in units of the scene."""

from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from screen_places import place_of_head, place_of_node, place_of_port, place_of_wire

LEFT, MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton
PLAIN = Qt.KeyboardModifier.NoModifier
STEPS = 5


class CanvasHands:
    """Presses, drags and types on a canvas that is shown."""

    def __init__(self, canvas):
        self.canvas = canvas
        self.view = canvas.view
        self.port_of_view = canvas.view.viewport()

    def port(self, node, port, side):
        return self.port_of_view.mapFromGlobal(place_of_port(self.canvas, node, port, side))

    def head(self, node):
        return self.port_of_view.mapFromGlobal(place_of_head(self.canvas, node))

    def middle(self, node):
        return self.port_of_view.mapFromGlobal(place_of_node(self.canvas, node))

    def wire(self, link):
        return self.port_of_view.mapFromGlobal(place_of_wire(self.canvas, link))

    def at(self, x, y):
        """The pixel of a point of the scene."""
        return self.view.mapFromScene(QPointF(x, y))

    def press(self, pos, keys=PLAIN, button=LEFT):
        QTest.mouseMove(self.port_of_view, pos)
        QTest.mousePress(self.port_of_view, button, keys, pos)

    def move(self, start, end):
        for step in range(1, STEPS + 1):
            QTest.mouseMove(self.port_of_view, start + (end - start) * step / STEPS)

    def release(self, pos, keys=PLAIN, button=LEFT):
        QTest.mouseRelease(self.port_of_view, button, keys, pos)

    def drag(self, start, end, keys=PLAIN, button=LEFT):
        self.press(start, keys, button)
        self.move(start, end)
        self.release(end, keys, button)

    def click(self, pos, keys=PLAIN, button=LEFT):
        self.press(pos, keys, button)
        self.release(pos, keys, button)

    def double_click(self, pos):
        self.click(pos)
        QTest.mouseDClick(self.port_of_view, LEFT, PLAIN, pos)
        QTest.mouseRelease(self.port_of_view, LEFT, PLAIN, pos)

    def wheel(self, pos, eighths):
        event = QWheelEvent(
            QPointF(pos),
            QPointF(self.port_of_view.mapToGlobal(pos)),
            QPoint(),
            QPoint(0, eighths),
            Qt.MouseButton.NoButton,
            PLAIN,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(self.port_of_view, event)

    def ask_for_menu(self, pos):
        reason = QContextMenuEvent.Reason.Mouse
        where = self.port_of_view.mapToGlobal(pos)
        QApplication.sendEvent(self.port_of_view, QContextMenuEvent(reason, pos, where))

    def key(self, key, keys=PLAIN):
        QTest.keyClick(QApplication.focusWidget() or self.view, key, keys)

    def type(self, text):
        QTest.keyClicks(QApplication.focusWidget() or self.view, text)
