"""The window's QActions, made of their specifications."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu, QMenuBar, QWidget

from app.editor.gestures import without_argument
from app.editor.window.actions.action_specs import ACTIONS, BELOW_A_LINE, ActionSpec
from core.editing.history import History

_SCOPES = {
    "application": Qt.ShortcutContext.ApplicationShortcut,
    "window": Qt.ShortcutContext.WindowShortcut,
    "canvas": Qt.ShortcutContext.WidgetWithChildrenShortcut,
}


class Actions(dict[str, QAction]):
    """Every action by name. `targets` has what each does; its keys work in `window` or `canvas`."""

    def __init__(
        self, targets: Mapping[str, Callable[[], object]], *, window: QWidget, canvas: QWidget
    ) -> None:
        super().__init__()
        for spec in ACTIONS:
            action = _action(spec, window)
            action.triggered.connect(partial(without_argument, targets[spec.name]))
            (canvas if spec.scope == "canvas" else window).addAction(action)
            self[spec.name] = action

    def of_names(self, names: Iterable[str]) -> list[QAction]:
        return [self[name] for name in names]

    def fill(self, bar: QMenuBar) -> dict[str, QMenu]:
        menus: dict[str, QMenu] = {}
        for spec in ACTIONS:
            menu = menus.get(spec.menu)
            if menu is None:
                menu = menus[spec.menu] = bar.addMenu(spec.menu)
                menu.setToolTipsVisible(True)
            if spec.name in BELOW_A_LINE and menu.actions():
                menu.addSeparator()
            menu.addAction(self[spec.name])
        return menus

    def follow_selection(self, selected: bool) -> None:
        for spec in ACTIONS:
            if spec.needs_selection:
                self[spec.name].setEnabled(selected)

    def follow_history(self, history: History) -> None:
        for name, verb, step in (
            ("undo", "&Undo", history.undo_text),
            ("redo", "&Redo", history.redo_text),
        ):
            action = self[name]
            action.setEnabled(bool(step))
            action.setText(f"{verb} {step.replace('&', '&&')}".strip())


def _action(spec: ActionSpec, parent: QWidget) -> QAction:
    action = QAction(spec.text, parent)
    action.setObjectName(f"action.{spec.name}")
    action.setShortcuts([QKeySequence(key) for key in spec.keys])
    action.setShortcutContext(_SCOPES[spec.scope])
    action.setToolTip(spec.tip)
    action.setStatusTip(spec.tip)
    action.setCheckable(spec.checkable)
    return action
