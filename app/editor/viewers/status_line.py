"""The line below what a viewer shows: two texts, the first one in red where it is an error."""

from __future__ import annotations

from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.editor.theme import Theme
from app.editor.widgets import ElidedLabel


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
