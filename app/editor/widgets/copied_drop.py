"""Taking what is dropped without taking it away from where it came from."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QDropEvent

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
