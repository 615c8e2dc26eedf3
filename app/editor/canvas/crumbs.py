"""The way to the macro that is shown: a bar on top of the canvas, only inside of macros.

It lies over the canvas, which stays where it is when the bar comes and goes.
"""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QToolButton, QWidget

from app.editor.declared_text import tip
from app.editor.level import Level
from app.editor.theme import FAINT, Theme, set_ground

_BETWEEN = "›"


class Crumbs(QWidget):
    """Buttons for the network and each macro on the way, and one that leads back by one.

    Parameters
    ----------
    level : Level
        What the canvas shows.
    theme : Theme
        Colours.
    parent : QWidget, optional
        Its parent.
    """

    def __init__(self, level: Level, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("crumbs")
        self.setAccessibleName("way to the macro shown")
        self._level = level
        self._theme = theme
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(4, 2, 4, 2)
        self._row.setSpacing(2)
        self.up = self._button("crumbs.up", "↑ Up", "Show what lies around this macro (Alt+PgUp)")
        self.up.clicked.connect(level.leave)
        self.steps: list[QToolButton] = []
        self._others: list[QLabel] = []
        self._row.addWidget(self.up)
        self._row.addStretch(1)
        level.opened.connect(self._fill)
        level.changed.connect(self._fill)
        level.session.state_changed.connect(self._fill)
        self._shown: tuple[str, ...] | None = None
        self.set_theme(theme)
        self._fill()

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        self._theme = theme
        set_ground(self, theme.raised)

    def _fill(self, *_: object) -> None:
        document = self._level.session.document
        name = document.network.name or (document.path.stem if document.path else "network")
        path = self._level.path
        self.setVisible(bool(path))
        if self._shown == (name, *path):
            return
        self._shown = (name, *path)
        for widget in (*self.steps, *self._others):
            self._row.removeWidget(widget)
            widget.hide()
            widget.deleteLater()
        self.steps, self._others = [], []
        for depth, text in enumerate((name, *path)):
            if depth:
                self._put(self._label(_BETWEEN))
            button = self._button(f"crumb.{depth}", text, f"Show the nodes of {text}")
            button.setEnabled(depth < len(path))
            button.clicked.connect(partial(self._go, path[:depth]))
            self.steps.append(button)
            self._put(button)
        for widget in (*self.steps, *self._others):
            widget.show()
        self._row.activate()
        self.resize(self.sizeHint())
        self.raise_()

    def _go(self, path: tuple[str, ...], *_: object) -> None:
        self._level.go_to(path)

    def _put(self, widget: QWidget) -> None:
        self._row.insertWidget(self._row.count() - 1, widget)

    def _label(self, text: str) -> QLabel:
        label = QLabel(text, self)
        label.setForegroundRole(FAINT)
        self._others.append(label)
        return label

    def _button(self, name: str, text: str, about: str) -> QToolButton:
        button = QToolButton(self)
        button.setObjectName(name)
        button.setText(text.replace("&", "&&"))
        button.setAutoRaise(True)
        button.setAccessibleName(about)
        button.setToolTip(tip(about))
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        return button
