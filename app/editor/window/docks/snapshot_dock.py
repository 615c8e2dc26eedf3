"""The dock of snapshots, and what keeps and compares them in the window."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow

from app.editor.docks.snapshots import Comparing, Snapshots
from app.editor.docks.snapshots_view import SnapshotsView
from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.editor.window.docks.viewer_docks import ViewerDocks, add_dock

_KEYS = ("keep_snapshot", "flip", "wipe")


class ByName(Protocol):
    """Actions of the window."""

    def __getitem__(self, name: str) -> QAction:
        """The action of that name."""


class SnapshotDock(QObject):
    """Snapshots of the document, in a dock that is hidden until it is wanted.

    Parameters
    ----------
    session, evaluator
        As for the viewers.
    viewers : ViewerDocks
        The viewers that show A beside the present.
    window : QMainWindow
        The window.
    """

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator,
        viewers: ViewerDocks,
        window: QMainWindow,
    ) -> None:
        super().__init__(window)
        self._viewers = viewers
        self.snapshots = Snapshots(session, evaluator, self)
        self.comparing = Comparing(session, self.snapshots, viewers)
        self.view = SnapshotsView(session, evaluator, self.snapshots, self.comparing)
        area = Qt.DockWidgetArea.BottomDockWidgetArea
        self.dock = add_dock(window, "Snapshots", "dock.snapshots", self.view, area)
        self.dock.hide()
        self.dock.visibilityChanged.connect(viewers.name_tabs)

    def toggle(self) -> None:
        """Show the snapshots, or hide them where they are in front."""
        if self.view.isVisible():
            self.dock.hide()
        else:
            self.dock.show()
            self.dock.raise_()
            self.view.list.setFocus(Qt.FocusReason.OtherFocusReason)

    def follow_actions(self, actions: ByName) -> None:
        """Let the keys work on pictures, curves and the list, too; mark what is shown."""
        keys = [actions[name] for name in _KEYS]
        self._viewers.add_compare_actions(keys)
        for widget in (self.view.list, self.view.figures):
            widget.addActions(keys)
        self.dock.visibilityChanged.connect(actions["snapshots"].setChecked)
