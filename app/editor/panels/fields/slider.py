"""A slider that signals what a person does with it, and shows values without signals."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QSlider, QWidget

from app.editor.panels.fields.type_in import WHEEL_REST_MS
from app.editor.widgets import takes_wheel

_STEPS = {
    Qt.Key.Key_Right: 1,
    Qt.Key.Key_Up: 1,
    Qt.Key.Key_Left: -1,
    Qt.Key.Key_Down: -1,
    Qt.Key.Key_PageUp: 10,
    Qt.Key.Key_PageDown: -10,
}


class Slider(QSlider):
    """Horizontal, from 0 to `positions`.

    Signals
    -------
    moved(position)
        Dragged, clicked, or sent to an end.
    stepped(steps)
        By keys or the wheel: small steps from the value, whatever the position shows of it.
    finished
        The mouse or the key is up, or the wheel rests.
    """

    moved = Signal(int)
    stepped = Signal(int)
    finished = Signal()

    def __init__(self, positions: int, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.setRange(0, positions)
        self.setPageStep(max(1, positions // 10))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self.setMinimumWidth(self.fontMetrics().height() * 4)
        self.valueChanged.connect(self.moved)
        self._rest = QTimer(self, singleShot=True, interval=WHEEL_REST_MS)
        self._rest.timeout.connect(self.finished)

    def show_position(self, position: int) -> None:
        """Show a value of the document, unless the person is dragging it."""
        if not self.isSliderDown():
            with QSignalBlocker(self):
                self.setValue(position)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Step by the value."""
        if event.key() in _STEPS:
            self.stepped.emit(_STEPS[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """The end of stepping."""
        super().keyReleaseEvent(event)
        if not event.isAutoRepeat():
            self.finished.emit()

    def event(self, event: QEvent) -> bool:
        """A dialog ends a drag: the release of the button behind it does not arrive."""
        if event.type() == QEvent.Type.WindowBlocked and self.isSliderDown():
            self.setSliderDown(False)
            self.finished.emit()
        return bool(super().event(event))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """The end of a drag."""
        super().mouseReleaseEvent(event)
        self.finished.emit()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The end of what keys or the wheel began."""
        super().focusOutEvent(event)
        if not self.isSliderDown():
            self._rest.stop()
            self.finished.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Step where it has the focus; else the panel scrolls."""
        turned = event.angleDelta().y()
        if not turned or not takes_wheel(self):
            event.ignore()
            return
        self.stepped.emit(1 if turned > 0 else -1)
        self._rest.start()
        event.accept()
