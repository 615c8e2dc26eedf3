"""The fit dock in the window: where its pictures come from."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QMainWindow

from app.editor.docks.fit_view import FitView
from app.editor.session import Session
from app.editor.theme import Theme
from app.editor.window.docks.measure_dock import MeasureDock
from app.editor.window.docks.viewer_docks import ViewerDocks, add_dock
from app.editor.window.documents.drops import choose_pictures


class FitDock(QObject):
    """Fits the network to a picture, in a dock that is hidden until it is wanted.

    Parameters
    ----------
    session, theme
        As for the viewers.
    measuring : MeasureDock
        Whose last picture is fitted to where no other is chosen.
    viewers : ViewerDocks
        Beside which it stands.
    window : QMainWindow
        The window.
    finish_typing : callable
        Takes what is being typed, before a fit.
    """

    def __init__(
        self,
        session: Session,
        theme: Theme,
        measuring: MeasureDock,
        viewers: ViewerDocks,
        window: QMainWindow,
        finish_typing: Callable[[], None],
    ) -> None:
        super().__init__(window)
        self._window = window
        self._in_front = False
        self.view = FitView(session, theme, lambda: measuring.view.source, finish_typing)
        area = Qt.DockWidgetArea.BottomDockWidgetArea
        self.dock = add_dock(window, "Fit", "dock.fit", self.view, area)
        self.dock.hide()
        self.dock.visibilityChanged.connect(viewers.name_tabs)
        self.dock.visibilityChanged.connect(self._shown)
        self.view.file_wanted.connect(self.choose_file)
        measuring.view.source_changed.connect(self.view.show_state)

    def set_theme(self, theme: Theme) -> None:
        """Draw in other colours."""
        self.view.set_theme(theme)

    def toggle(self) -> None:
        """Show the dock, or hide it where it is in front."""
        if self._in_front:  # Qt calls a dock visible behind another's tab
            self.dock.hide()
        else:
            self.dock.show()
            self.dock.raise_()
            self.view.table.setFocus(Qt.FocusReason.OtherFocusReason)

    def cancel(self) -> None:
        """Stop the fit."""
        self.view.cancel()

    def close(self) -> None:
        """Stop the fit, and wait for its end."""
        self.view.close_worker()

    def choose_file(self) -> None:
        """Ask the person for a picture."""
        choose_pictures(
            self._window, "Fit to pictures", name="fit_dialog", chosen=self.view.choose_pictures
        )

    def _shown(self, on: bool) -> None:
        self._in_front = on
        if on:
            self.view.show_state()
