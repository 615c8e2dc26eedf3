"""What the mouse does, beside what single widgets make of it."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QMimeData, QObject, Qt, QTimer
from PySide6.QtGui import QDropEvent, QKeyEvent, QMouseEvent, QWindow
from PySide6.QtWidgets import QApplication, QWidget


class AfterRelease(QObject):
    """Calls once the mouse is up, each kind of call once; looks at events only meanwhile."""

    def __init__(self, owner: QObject) -> None:
        super().__init__(owner)
        self._waiting: dict[str, Callable[[], None]] = {}

    def do(self, name: str, call: Callable[[], None]) -> None:
        """Call at the next release; in the place of what waits under that name."""
        if not self._waiting:
            QApplication.instance().installEventFilter(self)
        self._waiting[name] = call

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """See the release, or that it was missed: the mouse moves with no button down."""
        released = event.type() == QEvent.Type.MouseButtonRelease or (
            event.type() == QEvent.Type.MouseMove
            and isinstance(event, QMouseEvent)
            and event.buttons() == Qt.MouseButton.NoButton
        )
        if released and self._waiting:
            QApplication.instance().removeEventFilter(self)
            # What the release itself does comes first.
            QTimer.singleShot(0, self, self._call)
        return super().eventFilter(watched, event)

    def _call(self) -> None:
        waiting, self._waiting = self._waiting, {}
        for call in waiting.values():
            call()


class EscapeInDrag(QObject):
    """Calls when Esc is pressed during a drag, in whatever widget the keyboard is."""

    def __init__(self, owner: QWidget, call: Callable[[], None]) -> None:
        super().__init__(owner)
        self._owner, self._call = owner, call
        self._window: QWindow | None = None

    def begin(self) -> None:
        self.end()
        self._window = self._owner.window().windowHandle()
        if self._window is not None:
            self._window.installEventFilter(self)

    def end(self) -> None:
        if self._window is not None:
            self._window.removeEventFilter(self)
            self._window = None

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Keep Esc from the shortcuts of the window, which stop the computation."""
        if event.type() != QEvent.Type.ShortcutOverride or not isinstance(event, QKeyEvent):
            return False
        if event.key() != Qt.Key.Key_Escape:
            return False
        event.accept()
        self._call()
        return True


_ACTIONS = (Qt.DropAction.CopyAction, Qt.DropAction.LinkAction)


def accept_copy(event: QDropEvent) -> None:
    """Accept it as a copy, or a link; refuse what can only be moved.

    What is proposed is a move where a file manager would move on the same disk, and who proposes
    it may delete the file once it is taken.
    """
    for action in _ACTIONS:
        if event.possibleActions() & action:
            event.setDropAction(action)
            event.accept()
            return
    event.ignore()


def local_files(data: QMimeData) -> list[str]:
    """Paths of the files of this machine that are dragged; none where other things are."""
    return [url.toLocalFile() for url in data.urls() if url.isLocalFile()]


def without_argument(target: Callable[..., object], *_: object) -> None:
    """Call it without the signal's argument, whether the action is checked."""
    target()
