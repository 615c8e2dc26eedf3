"""The window's QActions, made of their specifications."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu, QMenuBar, QWidget

from app.editor.window.actions.action_specs import ACTIONS, ActionSpec, starts_a_group, viewer_specs
from app.editor.window.actions.shortcut_search import OR
from core.editing.history import History

_SCOPES = {
    "application": Qt.ShortcutContext.ApplicationShortcut,
    "window": Qt.ShortcutContext.WindowShortcut,
    "canvas": Qt.ShortcutContext.WidgetWithChildrenShortcut,
}


class Actions:
    """Every action by name.

    Parameters
    ----------
    targets : mapping
        What each does, by its name.
    window, canvas : QWidget
        Where the keys work.

    Raises
    ------
    KeyError
        If an action has no target.
    """

    def __init__(
        self, targets: Mapping[str, Callable[[], object]], *, window: QWidget, canvas: QWidget
    ) -> None:
        self.specs = (*ACTIONS, *viewer_specs())
        self._actions: dict[str, QAction] = {}
        for spec in self.specs:
            action = _action(spec, window)
            action.triggered.connect(targets[spec.name])
            (canvas if spec.scope == "canvas" else window).addAction(action)
            self._actions[spec.name] = action

    def __getitem__(self, name: str) -> QAction:
        return self._actions[name]

    def of_names(self, names: Iterable[str]) -> list[QAction]:
        """The actions of these names, in their order."""
        return [self._actions[name] for name in names]

    def fill(self, bar: QMenuBar) -> dict[str, QMenu]:
        """Make the menus; returns them by title."""
        menus: dict[str, QMenu] = {}
        for spec in self.specs:
            menu = menus.get(spec.menu)
            if menu is None:
                menu = menus[spec.menu] = bar.addMenu(spec.menu)
                menu.setToolTipsVisible(True)
            if starts_a_group(spec) and menu.actions():
                menu.addSeparator()
            menu.addAction(self._actions[spec.name])
        return menus

    def follow_selection(self, selected: bool) -> None:
        """Grey out what works on selected nodes where there are none."""
        for spec in self.specs:
            if spec.needs_selection:
                self._actions[spec.name].setEnabled(selected)

    def follow_history(self, history: History) -> None:
        """Have the entries of undo and redo name what each would do."""
        for name, verb, step in (
            ("undo", "&Undo", history.undo_text),
            ("redo", "&Redo", history.redo_text),
        ):
            action = self._actions[name]
            action.setEnabled(bool(step))
            action.setText(f"{verb} {step.replace('&', '&&')}".strip())

    def listed(self) -> list[tuple[str, str, str, str]]:
        """Menu, text, keys and meaning of every action that has keys, read off the actions."""
        rows = []
        for spec in self.specs:
            action = self._actions[spec.name]
            keys = [key.toString(_NATIVE) for key in action.shortcuts()]
            if keys:
                plain = action.text().replace("&", "").rstrip("…")
                menu = spec.menu.replace("&", "")
                rows.append((menu, plain, OR.join(keys), action.toolTip()))
        return rows


_NATIVE = QKeySequence.SequenceFormat.NativeText


def _action(spec: ActionSpec, parent: QWidget) -> QAction:
    action = QAction(spec.text, parent)
    action.setObjectName(f"action.{spec.name}")
    action.setShortcuts([QKeySequence(key) for key in spec.keys])
    action.setShortcutContext(_SCOPES[spec.scope])
    action.setToolTip(spec.tip)
    action.setStatusTip(spec.tip)
    action.setCheckable(spec.checkable)
    return action
