"""Menu entries that show and hide docks: whatever is closed can be shown again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Protocol

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QMenu

from app.editor.window.docks.viewer_docks import ViewerDocks


class _ByName(Protocol):
    def __getitem__(self, name: str) -> QAction: ...


def add_dock_toggles(menu: QMenu, docks: Iterable[QDockWidget], viewers: ViewerDocks) -> None:
    """Add an entry for each of these docks, and for viewers made later."""

    def add(dock: Any) -> None:
        menu.addAction(dock.toggleViewAction())

    menu.addSeparator()
    for dock in docks:
        add(dock)
    viewers.made.connect(add)


def follow_docks(actions: _ByName, docks: Mapping[str, QDockWidget]) -> None:
    """Check an action, by its name, while its dock is in front."""
    for name, dock in docks.items():
        dock.visibilityChanged.connect(actions[name].setChecked)
