"""Buttons that turn the pages of a panel, on as many lines as they need."""

from __future__ import annotations

from collections.abc import Collection

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QWidget

from app.editor.theme import Theme
from app.editor.widgets.flow_layout import FlowLayout
from app.editor.widgets.outlined import Toggle


class PageTabs(QWidget):
    """One button for each page; one of them is down.

    Signals
    -------
    turned
        Another page is to be shown.
    """

    turned = Signal()

    def __init__(self, pages: tuple[str, ...], theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("pages")
        self.setAccessibleName("pages of the panel")
        self._pages = pages
        self._group = QButtonGroup(self)
        self.buttons: list[Toggle] = []
        flow = FlowLayout(self, across=2, down=2)
        flow.setContentsMargins(0, 4, 0, 0)
        for number, page in enumerate(pages):
            button = Toggle(self)
            button.setObjectName(f"page.{page}")
            button.setText(page)
            button.setAccessibleName(f"page {page}")
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            self._group.addButton(button, number)
            self.buttons.append(button)
            flow.addWidget(button)
        if self.buttons:
            self.buttons[0].setChecked(True)
        self._group.idToggled.connect(self._toggled)
        self.set_theme(theme)

    @property
    def page(self) -> str:
        """The page that is shown; empty where there are none."""
        return self._pages[self._group.checkedId()] if self._pages else ""

    def turn_to(self, page: str) -> None:
        """Show a page."""
        if page in self._pages:
            self.buttons[self._pages.index(page)].setChecked(True)

    def offer(self, pages: Collection[str]) -> None:
        """Offer only these pages."""
        for page, button in zip(self._pages, self.buttons, strict=True):
            button.setVisible(page in pages)

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        for button in self.buttons:
            button.set_theme(theme)

    def _toggled(self, _number: int, on: bool) -> None:
        if on:
            self.turned.emit()
