"""What to do on a canvas with nothing on it; gone with the first node."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QLabel, QWidget

from app.editor.level import Level
from app.editor.session import Session
from app.editor.theme import FAINT

TEXT = "Tab or double-click adds a module; drag one from the library; drop a file"


class EmptyHint(QLabel):
    """A line in the middle of an empty canvas, through which the mouse reaches the canvas.

    Parameters
    ----------
    session : Session or Level
        Its network decides whether the line is there.
    ground : QWidget
        What it stands in the middle of.
    """

    def __init__(self, session: Session | Level, ground: QWidget) -> None:
        super().__init__(TEXT, ground)
        self.setObjectName("canvas.empty_hint")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setWordWrap(True)
        self.setForegroundRole(FAINT)
        self._session = session
        self._ground = ground
        ground.installEventFilter(self)
        session.opened.connect(self._follow)
        session.changed.connect(self._follow)
        self._follow()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Stay in the middle."""
        if watched is self._ground and event.type() is QEvent.Type.Resize:
            self._fill()
        return False

    def _follow(self, *_: object) -> None:
        empty = not self._session.network.nodes
        if empty:
            self._fill()
        self.setVisible(empty)

    def _fill(self) -> None:
        self.setGeometry(self._ground.rect().adjusted(24, 0, -24, 0))
