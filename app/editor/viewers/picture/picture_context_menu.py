"""The menu of a right click on a picture: the bar's menus, and what concerns the whole."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Protocol

from PySide6.QtCore import QPoint
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from app.editor.gestures import without_argument


class Bar(Protocol):
    """The menus of the bar above the picture."""

    @property
    def menus(self) -> tuple[QMenu, ...]:
        """Display and Compare."""


def open_context_menu(
    viewer: QWidget,
    point: QPoint,
    *,
    bar: Bar,
    own: Iterable[tuple[str, str, Callable[[], None]]],
    window_actions: Iterable[QAction],
) -> None:
    """Open the menu at a point of the screen.

    Parameters
    ----------
    viewer : QWidget
        The viewer; the menu goes with it.
    point : QPoint
        Where, on the screen.
    bar : Bar
        Its menus become submenus.
    own : iterable of (str, str, callable)
        Text, the key that does the same or "", and what is done.
    window_actions : iterable of QAction
        Actions of the window that concern what is shown.
    """
    menu = QMenu(viewer)
    menu.setObjectName("picture_menu")
    menu.aboutToHide.connect(menu.deleteLater)
    for text, keys, done in own:
        action = menu.addAction(f"{text}\t{keys}" if keys else text)
        action.triggered.connect(partial(without_argument, done))
    menu.addSeparator()
    for inner in bar.menus:
        menu.addMenu(inner)
    menu.addSeparator()
    for action in window_actions:
        menu.addAction(action)
    menu.popup(point)
