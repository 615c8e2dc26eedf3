"""What all viewers have in common: they post queries while visible, and show the answers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Query
from app.editor.notices import Mark, close_button
from app.editor.session import Session
from app.editor.theme import ERROR, TEXT, Theme, theme_of
from app.editor.widgets import ElidedLabel


class Viewer(QWidget):
    """A widget that shows answers.

    Subclasses return their queries in `queries` and show the answers in `take`; they call `ask`
    when the queries change. Without an evaluator nothing is shown. The owner is the viewer's name,
    unique in the window.
    """

    posted = Signal()  # its queries have been posted: it may show something else

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        owner: str,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName(owner)
        self.session = session
        self.evaluator = evaluator
        self.owner = owner
        self._active = False
        self._posted: tuple[Query, ...] = ()
        if evaluator is not None:
            evaluator.answered.connect(self._answered)
        session.changed.connect(self.follow)
        session.opened.connect(self.follow_opening)

    @property
    def theme(self) -> Theme:
        return theme_of(self)

    def queries(self) -> Sequence[Query]:
        return ()

    def accepts(self, query: Query) -> bool:
        """Whether an answer to this is still of use."""
        return query in self._posted

    def take(self, answer: Answer) -> None:
        """Show an answer that `accepts` lets through."""

    def follow(self, before: Any, after: Any) -> None:
        """The document has changed: the networks before and after."""

    def follow_opening(self) -> None:
        """Another document is open."""

    def ask(self) -> None:
        """Post the present queries, if the viewer is visible."""
        if not self._active:
            return
        self._posted = tuple(self.queries())
        if self.evaluator is not None:
            self.evaluator.ask(self.owner, self._posted)
        self.posted.emit()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._active = True
        self.ask()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._active:
            self._active = False
            self._posted = ()
            if self.evaluator is not None:
                self.evaluator.forget(self.owner)

    def _answered(self, answer: Any) -> None:
        if answer.owner == self.owner and self._active and self.accepts(answer.query):
            self.take(answer)


# The line below what a viewer shows: two texts; the first one may say what went wrong.


class StatusLine(QWidget):
    """What is shown or why nothing is, and what there is to read under the cursor.

    `description` and `more` are what these texts are, for those who cannot see them.
    """

    def __init__(self, owner: str, description: str, more: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.mark = Mark(self)
        self.mark.show_severity("error")
        self.title = ElidedLabel(f"{owner}.title", description, self)
        self.more = ElidedLabel(f"{owner}.read", more, self)
        self.away = close_button(f"{owner}.close", self)
        self.away.clicked.connect(lambda: self.show_text(""))
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 0, 6, 2)
        layout.addWidget(self.mark)
        layout.addWidget(self.title, 1)
        layout.addWidget(self.away)
        layout.addWidget(self.more, 0)
        self.show_text("")

    def show_text(self, text: str, *, failed: bool = False) -> None:
        self.title.show_text(text)
        self.title.setForegroundRole(ERROR if failed else TEXT)
        self.mark.setVisible(failed)
        self.away.setVisible(failed)

    def show_more(self, text: str) -> None:
        self.more.show_text(text)
