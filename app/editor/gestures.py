"""What the mouse does, beside what single widgets make of it."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QMimeData, Qt
from PySide6.QtGui import QDropEvent, QKeyEvent

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


def is_escape(event: QEvent) -> bool:
    """Whether Esc is pressed and may be kept from shortcuts: whoever accepts the event has it."""
    override = event.type() == QEvent.Type.ShortcutOverride
    return override and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape


def local_files(data: QMimeData) -> list[str]:
    """Paths of the files of this machine that are dragged; none where other things are."""
    return [url.toLocalFile() for url in data.urls() if url.isLocalFile()]


def without_argument(target: Callable[..., object], *_: object) -> None:
    """Call it without the signal's argument, whether the action is checked."""
    target()
