"""What all viewers have in common: they post queries while visible, and show the answers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import Signal
from PySide6.QtGui import QCloseEvent, QColor, QHideEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.theme import Theme
from app.editor.widgets import ElidedLabel
from core.network.network import Network

if TYPE_CHECKING:
    from app.editor.evaluation.evaluator import Evaluator


class Viewer(QWidget):
    """A widget that shows answers.

    Subclasses return their queries in `queries` and show the answers in `take`; they call `ask`
    when the queries change.

    Parameters
    ----------
    session : Session
        The open document.
    evaluator : Evaluator or None
        Answers the queries; None shows nothing.
    theme : Theme
        Colours.
    owner : str
        The viewer's name, unique in the window.
    parent : QWidget, optional
        Qt's owner.

    Signals
    -------
    posted
        Its queries have been posted: it may show something else.
    """

    posted = Signal()

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        theme: Theme,
        owner: str,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName(owner)
        self.session = session
        self.evaluator = evaluator
        self.theme = theme
        self.owner = owner
        self._active = False
        self._posted: tuple[Query, ...] = ()
        if evaluator is not None:
            evaluator.answered.connect(self._answered)
        session.changed.connect(self._changed)
        session.opened.connect(self._opened)

    def queries(self) -> Sequence[Query]:
        """The queries of what is shown now."""
        return ()

    def accepts(self, query: Query) -> bool:
        """Whether an answer to this is still of use."""
        return query in self._posted

    def take(self, answer: Answer) -> None:
        """Show an answer that `accepts` lets through."""

    def follow(self, before: Network, after: Network) -> None:
        """The document has changed."""

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
        """Post queries from now on."""
        super().showEvent(event)
        self._active = True
        self.ask()

    def hideEvent(self, event: QHideEvent) -> None:
        """Withdraw the queries."""
        super().hideEvent(event)
        self._release()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Withdraw the queries."""
        super().closeEvent(event)
        self._release()

    def _release(self) -> None:
        if self._active:
            self._active = False
            self._posted = ()
            if self.evaluator is not None:
                self.evaluator.forget(self.owner)

    def _answered(self, answer: Any) -> None:
        if answer.owner == self.owner and self._active and self.accepts(answer.query):
            self.take(answer)

    def _changed(self, before: Any, after: Any) -> None:
        self.follow(before, after)

    def _opened(self) -> None:
        self.follow_opening()


# The line below what a viewer shows: two texts, the first one in red where it is an error.


class StatusLine(QWidget):
    """What is shown or why nothing is, and what there is to read under the cursor.

    Parameters
    ----------
    owner : str
        The viewer's name, which those of the texts begin with.
    description, more : str
        What the texts are, for those who cannot see them.
    parent : QWidget
        The viewer.
    """

    def __init__(self, owner: str, description: str, more: str, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme: Theme | None = None
        self._failed = False
        self.title = ElidedLabel(f"{owner}.title", description, self)
        self.more = ElidedLabel(f"{owner}.read", more, self)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 0, 6, 2)
        layout.addWidget(self.title, 1)
        layout.addWidget(self.more, 0)

    def set_theme(self, theme: Theme) -> None:
        """Write in other colours."""
        self._theme = theme
        palette = self.palette()
        colour = theme.error if self._failed else theme.text
        palette.setColor(self.title.foregroundRole(), QColor(colour))
        self.title.setPalette(palette)

    def show_text(self, text: str, *, failed: bool = False) -> None:
        """Show what the viewer shows, or what has failed."""
        self.title.show_text(text)
        if failed != self._failed:
            self._failed = failed
            if self._theme is not None:
                self.set_theme(self._theme)

    def show_more(self, text: str) -> None:
        """Show what is under the cursor."""
        self.more.show_text(text)
