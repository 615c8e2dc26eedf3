"""The pages of the window: the first page, beside which there are no docks, and the network."""

from __future__ import annotations

from PySide6.QtWidgets import QMainWindow, QStackedWidget, QWidget

from app.editor.gestures import SecondClick
from app.editor.window.docks.dock_places import Curtain
from app.editor.window.docks.layouts import LayoutName
from app.editor.window.docks.window_layout import WindowLayout


class Pages(QStackedWidget):
    """Shows one of both. The docks get their sizes with the network that is shown first.

    Parameters
    ----------
    first, work : QWidget
        The first page, and the one of the network.
    layout : WindowLayout
        Places and sizes the docks.
    window : QMainWindow
        The window, which has the docks.
    """

    def __init__(
        self, first: QWidget, work: QWidget, layout: WindowLayout, window: QMainWindow
    ) -> None:
        super().__init__(window)
        self._first, self._work = first, work
        self._layout = layout
        self._curtain = Curtain(window)
        self._second_click = SecondClick(self)
        self._sized = False
        self.sizes_remembered = False
        """Whether the docks have the sizes of the last window, to be kept."""
        self.addWidget(first)
        self.addWidget(work)

    @property
    def at_first(self) -> bool:
        """Whether the first page is shown."""
        return self.currentWidget() is self._first

    def show_first(self) -> None:
        """Show the first page, without docks."""
        self.setCurrentWidget(self._first)
        self._curtain.close()

    def show_work(self) -> None:
        """Show the network, with the docks."""
        if self.at_first:
            self._second_click.drop()
        self.setCurrentWidget(self._work)
        self.show_docks()
        if not self._sized:
            self._sized = True
            (self._layout.keep if self.sizes_remembered else self._layout.begin)()

    def show_docks(self) -> None:
        """Show the docks, on either page."""
        with self._layout.placing():
            self._curtain.open()

    def choose_layout(self, name: LayoutName) -> None:
        """Place the docks by a named layout; beside the first page they stay hidden until later."""
        self.show_docks()
        self._layout.choose(name)
        if self.at_first:
            self._curtain.close()
            self.sizes_remembered = self._sized = False
