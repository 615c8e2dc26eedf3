"""A line to type a value in, and a name that is dragged to change it; both are given up on Esc."""

from PySide6 import QtGui
from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtWidgets import QCompleter, QLabel, QLineEdit, QWidget

from app.editor.theme import ERROR
from app.editor.widgets import is_escape

STEPS = {Qt.Key.Key_Up: 1, Qt.Key.Key_Down: -1, Qt.Key.Key_PageUp: 10, Qt.Key.Key_PageDown: -10}
_OF_LIST = {*STEPS, Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Tab, Qt.Key.Key_Escape}
FINER, COARSER = 0.1, 10.0
_UNDO, _REDO = QtGui.QKeySequence.StandardKey.Undo, QtGui.QKeySequence.StandardKey.Redo


def step_factor(keys: Qt.KeyboardModifier) -> float:
    """How large steps are: Shift makes them finer, Ctrl coarser."""
    if keys & Qt.KeyboardModifier.ShiftModifier:
        return FINER
    return COARSER if keys & Qt.KeyboardModifier.ControlModifier else 1.0


class TypeIn(QLineEdit):
    """A line edit that signals what was typed once it is complete."""

    # text: Enter, or the focus has left; only if something was typed since it was shown
    committed = Signal(str)
    given_up = Signal()  # Esc: what was typed does not count
    stepped = Signal(float)  # steps: an arrow key (±1) or a page key (±10), where `steps` is set
    turned = Signal(object)  # event: the wheel, which scrolls what is around unless it is accepted
    step_ended = Signal()  # that key was released

    def __init__(
        self, parent: QWidget | None = None, *, characters: int = 8, steps: bool = False
    ) -> None:
        super().__init__(parent)
        self._steps = steps
        self.marked = False
        """Whether the text was refused."""
        self.names: QCompleter | None = None  # lists names to be taken into the text
        self.is_left_by_mouse = False
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)  # the field has one
        width = self.fontMetrics().averageCharWidth() * characters
        self.setMinimumWidth(width + 2 * self.fontMetrics().height() // 2)
        self.returnPressed.connect(self.commit)
        self.textEdited.connect(self._unmark)

    @property
    def unsettled(self) -> bool:
        """Whether it shows something else than the document has."""
        return self.isModified() or self.marked

    def show_text(self, text: str) -> None:
        if text != self.text() or self.isUndoAvailable() or self.isRedoAvailable():
            self.setText(text)
            self.setCursorPosition(0)
        self.setModified(False)
        self._unmark()

    def mark(self) -> None:
        self.marked = True
        self.update()

    def commit(self) -> None:
        if self.isModified():
            self.committed.emit(self.text())

    def give_up(self) -> None:
        self.setModified(False)
        self.given_up.emit()

    def event(self, event: QEvent) -> bool:
        """Leave undo to the document where nothing is typed; keep Esc where something is."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QtGui.QKeyEvent):
            nothing = (event.matches(_UNDO) and not self.isUndoAvailable()) or (
                event.matches(_REDO) and not self.isRedoAvailable()
            )
            if nothing:
                event.ignore()
                return False
            if event.key() == Qt.Key.Key_Escape and self.unsettled:
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        names = self.names.popup() if self.names is not None else None
        if event.key() in _OF_LIST and names is not None and names.isVisible():
            event.ignore()  # Qt gives it to the list
        elif event.key() == Qt.Key.Key_Escape and self.unsettled:
            self.give_up()
        elif self._steps and event.key() in STEPS:
            self.commit()
            self.stepped.emit(STEPS[Qt.Key(event.key())] * step_factor(event.modifiers()))
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QtGui.QKeyEvent) -> None:
        super().keyReleaseEvent(event)
        if self._steps and event.key() in STEPS and not event.isAutoRepeat():
            self.step_ended.emit()

    def wheelEvent(self, event: QtGui.QWheelEvent) -> None:
        event.ignore()
        self.turned.emit(event)

    def focusOutEvent(self, event: QtGui.QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() != Qt.FocusReason.PopupFocusReason:
            self.is_left_by_mouse = event.reason() == Qt.FocusReason.MouseFocusReason
            self.commit()
            self.is_left_by_mouse = False

    def paintEvent(self, event: QtGui.QPaintEvent) -> None:
        """Draw a frame over Qt's own: of what was refused, and one that is seen on dark grounds."""
        super().paintEvent(event)
        with QtGui.QPainter(self) as painter:
            if self.marked:
                painter.setPen(QtGui.QPen(self.palette().color(ERROR), 2))
                painter.drawRect(self.rect().adjusted(1, 1, -1, -1))
            elif not self.hasFocus():
                painter.setPen(self.palette().color(QtGui.QPalette.ColorRole.Mid))
                painter.drawRect(self.rect().adjusted(0, 0, -1, -1))

    def _unmark(self, _text: str = "") -> None:
        if self.marked:
            self.marked = False
            self.update()


def discard_typing(widget: QWidget) -> None:
    for edit in widget.findChildren(TypeIn):
        if edit.unsettled:
            edit.give_up()


PIXELS_A_STEP = 4
START_PIXELS = 3


class NameLabel(QLabel):
    """A name whose middle is left out where it is too wide; a number's is dragged sideways."""

    # steps: so many more, parts of one included: to the right is up
    dragged = Signal(float)
    finished = Signal()  # the button is up
    given_up = Signal()  # Esc during a drag

    drags = False
    column = 0
    _last: float | None = None
    _moving = False

    def sizeHint(self) -> QSize:
        return QSize(self.column, super().sizeHint().height())

    def minimumSizeHint(self) -> QSize:
        return QSize(0, super().minimumSizeHint().height())

    def set_drags(self, on: bool) -> None:
        self.drags = on
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus if on else Qt.FocusPolicy.NoFocus)
        self.setCursor(Qt.CursorShape.SizeHorCursor if on else Qt.CursorShape.ArrowCursor)

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        room = self.contentsRect()
        middle = Qt.TextElideMode.ElideMiddle
        with QtGui.QPainter(self) as painter:
            text = painter.fontMetrics().elidedText(self.text(), middle, room.width())
            painter.setPen(self.palette().color(self.foregroundRole()))
            painter.drawText(room, int(self.alignment()), text)

    def event(self, event: QEvent) -> bool:
        """End a drag by Esc, and by a dialog: the release of the button behind it never arrives."""
        if self._last is not None:
            if is_escape(event):
                self._last = None
                self.given_up.emit()
                event.accept()
            elif event.type() == QEvent.Type.WindowBlocked:
                self._last = None
                self.finished.emit()
        return bool(super().event(event))

    def mousePressEvent(self, event: QtGui.QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton and self.drags:
            self._last, self._moving = event.position().x(), False

    def mouseMoveEvent(self, event: QtGui.QMouseEvent) -> None:
        way = 0.0 if self._last is None else event.position().x() - self._last
        if way and (self._moving or abs(way) >= START_PIXELS):
            self._moving, self._last = True, event.position().x()
            self.dragged.emit(way / PIXELS_A_STEP * step_factor(event.modifiers()))

    def mouseReleaseEvent(self, event: QtGui.QMouseEvent) -> None:
        if self._last is not None and event.button() == Qt.MouseButton.LeftButton:
            self._last = None
            self.finished.emit()
