"""Hands on a whole window: keys go where the focus is, as a person's do."""

import time

from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit, QMessageBox, QPushButton

from app.editor.window.files import shipped_copy
from canvas_hands import PLAIN, CanvasHands
from child_process import PATIENCE_S
from core.editing.document import Document
from core.editing.wiring import new_node
from small_networks import SHIPPED, small_network

KEY = Qt.Key
CTRL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


class WindowHands(CanvasHands):
    """Presses, drags and types in a window that is shown."""

    def __init__(self, window):
        super().__init__(window.canvas)
        self.window = window

    def begin(self):
        """An empty network, the canvas in front and with the focus."""
        self.window.files.new()
        self.focus()

    def focus(self):
        """Go back to the canvas, as after a dialog."""
        give_focus(self.window.canvas.view)

    def select(self, *names):
        """Click on the heads of nodes, further ones with Ctrl."""
        for number, name in enumerate(names):
            self.click(self.head(name), CTRL if number else Qt.KeyboardModifier.NoModifier)
        assert self.window.level.selection == names

    def drop_files(self, widget, pos, paths):
        """Drag files over a widget and drop them there; whether they were taken."""
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
        return self.drop(widget, pos, data)

    @staticmethod
    def drop(widget, pos, data):
        """What a drag from elsewhere sends to the widget under the pointer, or to its parents.

        Qt gives the events of a drag to the first one upwards that accepts drops.
        """
        while widget is not None and not widget.acceptDrops():
            pos, widget = widget.mapToParent(pos), widget.parentWidget()
        if widget is None:
            return False
        action, left = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton
        none = Qt.KeyboardModifier.NoModifier
        enter = drag_event(QDragEnterEvent, pos, action, data, left, none)
        QApplication.sendEvent(widget, enter)
        if not enter.isAccepted():
            return False
        move = drag_event(QDragMoveEvent, pos, action, data, left, none)
        QApplication.sendEvent(widget, move)
        if not move.isAccepted():
            return False
        drop = QDropEvent(QPointF(pos), action, data, left, none)
        QApplication.sendEvent(widget, drop)
        return drop.isAccepted()


def drag_event(kind, pos, *rest):
    """A drag event; their points are of floating point from Qt 6.12 on."""
    try:
        return kind(QPointF(pos), *rest)
    except TypeError:
        return kind(pos, *rest)


def give_focus(widget):
    """As by a click: to a widget's window, then to it."""
    widget.window().activateWindow()
    widget.setFocus()
    end = time.monotonic() + PATIENCE_S
    while not widget.hasFocus():
        assert time.monotonic() < end, f"{widget.objectName()} does not get the focus"
        QTest.qWait(20)


def add(window, key, at=(0.0, 0.0)):
    """A node of a module, by the document; gives its name."""
    name, operation = new_node(window.session.network, window.session.library, key, at)
    assert window.session.do(operation)
    return name


def show_small(window, name, size=128):
    """Open a shipped network with a scene of fewer samples, as the copy that its card opens."""
    document = Document(
        small_network(name, size, size),
        library=window.session.library,
        path=SHIPPED / f"{name}.json",
    )
    window.files.show(shipped_copy(document))


def answer(qtbot, window, button):
    """Press a button of the question that is open."""
    qtbot.waitUntil(lambda: window.findChild(QMessageBox, "save_changes") is not None)
    box = window.findChild(QMessageBox, "save_changes")
    box.setObjectName("answered")
    QTest.mouseClick(box.findChild(QPushButton, button), Qt.MouseButton.LeftButton)


def turn(widget, place=None, keys=PLAIN):
    """Turn the wheel by a notch, at a place or in the middle."""
    at = QPointF(widget.rect().center() if place is None else place)
    none, phase = Qt.MouseButton.NoButton, Qt.ScrollPhase.NoScrollPhase
    far = widget.mapToGlobal(at)
    event = QWheelEvent(at, far, QPoint(), QPoint(0, 120), none, keys, phase, False)
    QApplication.sendEvent(widget, event)


def choose_file(button, path):
    """Press a button that opens a file dialog, and enter a file's name there."""
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    dialogs = button.window().findChildren(QFileDialog)
    line = next(one for one in dialogs if one.isVisible()).findChild(QLineEdit, "fileNameEdit")
    line.setText(str(path))
    QTest.keyClick(line, KEY.Key_Return)


def place_in(plots, index, value):
    """Where an abscissa of a trade-off lies, half the way up a chart that has been drawn."""
    frame = plots.charts[index].frame
    return QPointF(frame.left() + plots.span.share(value) * frame.width(), frame.center().y())
