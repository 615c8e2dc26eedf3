"""The question whether to read pictures from another computer, before any is read."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QMessageBox, QWidget

from app.editor.session import Session

_BUTTON = QMessageBox.StandardButton


class ShareQuestion(QObject):
    """Opens once for each computer that a network names; returns at once.

    Parameters
    ----------
    session : Session
        Keeps the answers.
    window : QWidget
        What the question lies above.
    """

    def __init__(self, session: Session, window: QWidget) -> None:
        super().__init__(window)
        self._session = session
        self._window = window
        self._box: QMessageBox | None = None
        session.opened.connect(self._ask)
        session.changed.connect(self._ask)

    def _ask(self, *_: object) -> None:
        session = self._session
        servers = session.shares.unanswered(session.network, session.library)
        if self._box is not None or not servers:
            return
        box = QMessageBox(self._window)
        box.setObjectName("share_question")
        box.setIcon(QMessageBox.Icon.Question)
        box.setTextFormat(Qt.TextFormat.PlainText)
        box.setWindowTitle("Read from another computer?")
        box.setText(f"The network names files on another computer: {servers[0][:200]}")
        box.setInformativeText(
            "Reading them tells that computer your name on this one. Allow it only if you know "
            "where the network comes from. The answer holds until the editor is closed."
        )
        box.setStandardButtons(_BUTTON.Yes | _BUTTON.No)
        box.setDefaultButton(_BUTTON.No)
        box.finished.connect(partial(self._answered, servers[0]))
        self._box = box
        box.open()

    def _answered(self, server: str, answer: int) -> None:
        if self._box is not None:
            self._box.deleteLater()
            self._box = None
        self._session.answer_share(server, answer == _BUTTON.Yes.value)
        self._ask()
