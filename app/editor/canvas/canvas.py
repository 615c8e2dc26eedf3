"""The canvas: the picture of the document's network, and everything one does on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QKeyEvent,
)
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from app.editor.canvas.crumbs import TitleEditor
from app.editor.canvas.hands.adding import Adding, Dropping
from app.editor.canvas.hands.gestures import Surface
from app.editor.canvas.hands.menus import Keys, Menus
from app.editor.canvas.hands.mouse import Dots, Mouse
from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.canvas.items.content import Content
from app.editor.canvas.items.hits import Marks, node_at
from app.editor.canvas.view.canvas_view import GraphView, Handler, Minimap
from app.editor.canvas.view.choice_popup import ChoicePopup
from app.editor.canvas.view.node_thumbnails import NodeThumbnails
from app.editor.evaluation.evaluator import Evaluator
from app.editor.level import Level
from app.editor.session import Session
from app.editor.theme import FAINT, raised_palette, theme_of
from app.editor.widgets import filled, named
from core.editing.backdrops import backdrops_of, change
from core.network.network import Link

_TYPE = QEvent.Type


class Canvas(QWidget):
    """Shows the session's network and follows it; gestures become operations on the document."""

    activated = Signal(str)  # (name): a node was double-clicked, or Enter pressed on it
    view_wanted = Signal(str)  # (name): a node was clicked with Ctrl and Shift, and is selected
    # (paths, point): files were dropped at a point of the scene
    files_dropped = Signal(list, QPointF)
    preset_dropped = Signal(str, QPointF)  # (key, point): a preset of the library was dropped there

    def __init__(self, session: Session | Level) -> None:
        super().__init__()
        named(self, "canvas", "Canvas")
        self._style = style = CanvasStyle(theme_of(self), self.font())
        self._session = session
        self.thumbnails: NodeThumbnails | None = None
        self.view = GraphView(style, self)
        self.setFocusProxy(self.view)
        self.content = Content(self.view.scene(), session.library, style)
        self._surface = surface = Surface(session, self.view, self.content, self)
        self.empty_hint = EmptyHint(session, self.view.viewport())
        self.marks = Marks(self.content)
        self.minimap = Minimap(self.view, self.content)
        self.popup = ChoicePopup(self.view)
        self.title_editor = TitleEditor(self.view)
        self.adding = Adding(surface, self.popup)
        self.dots = Dots(surface, self.marks)
        self.mouse = mouse = Mouse(surface, self.marks, self.dots, self.adding.ask_for_wire)
        self.keys = Keys(surface, self.marks, self.dots)
        self.menus = Menus(surface, self.marks, self.dots, self)
        dropping = Dropping(surface)
        self.view.handler = Handler(
            press=mouse.press,
            move=mouse.move,
            release=mouse.release,
            double_click=mouse.double_click,
            leave=mouse.leave,
            interrupted=mouse.cancel,
            wants_key=self._wants_key,
            key=self._key,
            key_released=self.keys.release,
            menu=self.menus.open,
            drag_over=dropping.over,
            drag_left=dropping.left,
            drop=dropping.drop,
        )
        filled(QVBoxLayout(self), self.view)
        self._connect()
        self._take_look()
        self._opened()

    # For the window's actions

    def set_menus(self, node_actions: Sequence[QAction], canvas_actions: Sequence[QAction]) -> None:
        self.menus.fill(node_actions, canvas_actions)

    def set_badges(self, badges: Any) -> None:
        self.content.set_badges(dict(badges))

    def show_thumbnails(self, evaluator: Evaluator) -> None:
        self.thumbnails = NodeThumbnails(self._session, evaluator, self.view.scene(), self.content)

    def frame_all(self) -> None:
        """Show the whole network, no larger than natural."""
        whole = self.content.bounds()
        if self.thumbnails is not None:
            whole = whole.united(self.thumbnails.bounds())
        self.view.frame(whole)

    def show_all_nodes(self) -> None:
        """Pan, as little as needed, so that all nodes are in sight."""
        self.view.make_visible(self.content.bounds())

    def frame_selection(self) -> None:
        self.view.frame(self.content.bounds(self._session.selection))

    def zoom_by(self, factor: float) -> None:
        pos = self._surface.pointer
        self.view.zoom_at(factor, None if pos is None else QPointF(pos))

    def sizes(self) -> dict[str, tuple[float, float]]:
        return self.content.sizes()

    def node_or_thumbnail_at(self, point: QPointF) -> str | None:
        node = node_at(self.content, point)
        if node is not None:
            return node.id
        return self.thumbnails.node_at(point) if self.thumbnails is not None else None

    def sizes_with_thumbnails(self) -> dict[str, tuple[float, float]]:
        below = self.thumbnails.heights() if self.thumbnails is not None else {}
        return {
            name: (width, height + below.get(name, 0.0))
            for name, (width, height) in self.sizes().items()
        }

    def cursor_point(self) -> tuple[float, float]:
        """The point of the scene under the mouse, or in the middle, in whole units."""
        return self._surface.cursor_point()

    def add_module(self, key: str) -> None:
        """Add a node at the cursor; with a node selected, wired on to that one."""
        self.adding.add(key, self.cursor_point())

    def open_search(self) -> None:
        self.adding.search(self.cursor_point())

    def search_is_open(self) -> bool:
        return self.popup.is_open

    def toggle_thumbnails(self) -> None:
        if self.thumbnails is not None:
            self.thumbnails.toggle()

    def edit_last_title(self) -> None:
        self._edit_title(len(self.content.backdrops) - 1)

    def connect_selected(self) -> None:
        self.adding.connect_selected()

    def add_dot(self) -> None:
        """Bend the wire under the pointer, or the selected one, through a dot."""
        self.dots.add(self._surface.pointer)

    def selected_link(self) -> Link | None:
        return self.marks.link

    def delete_selected_backdrop(self) -> None:
        self.menus.delete_backdrop()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (_TYPE.FontChange, _TYPE.PaletteChange) and hasattr(self, "adding"):
            self._take_look()

    def _take_look(self) -> None:
        """Draw in the colours and the letters that the window has now."""
        theme, style = theme_of(self), self._style
        if not style.is_of(theme, self.font()):  # to measure letters takes long
            style = self._style = CanvasStyle(theme, self.font())
        self.content.set_style(style)
        if self.thumbnails is not None:
            self.thumbnails.set_style(style)
        self.view.set_style(style)
        self.minimap.update()
        for floating in (self.popup, self._surface.hint):
            floating.setPalette(raised_palette(theme))

    def _connect(self) -> None:
        session = self._session
        session.opened.connect(self._opened)
        session.changed.connect(self._changed)
        session.selection_changed.connect(self._selection_changed)
        surface = self._surface
        surface.activated.connect(self.activated)
        surface.view_wanted.connect(self.view_wanted)
        surface.search_wanted.connect(lambda at: self.adding.search((at.x(), at.y())))
        surface.title_wanted.connect(self._edit_title)
        surface.files_dropped.connect(self.files_dropped)
        surface.preset_dropped.connect(self.preset_dropped)
        self.title_editor.edited.connect(self._retitle)

    def _wants_key(self, event: QKeyEvent) -> bool:
        return self.mouse.busy and event.key() == Qt.Key.Key_Escape

    def _key(self, event: QKeyEvent) -> bool:
        if self._wants_key(event):
            self.mouse.cancel()
            return True
        return self.keys.press(event)

    def _opened(self) -> None:
        self._let_go()
        self.content.clear()
        self.content.follow(self._session.network)
        self.content.mark_selected(self._session.selection)
        self.frame_all()

    def _changed(self, *_: object) -> None:
        self._let_go()
        self.content.follow(self._session.network)
        self.minimap.follow()

    def _let_go(self) -> None:
        """What is under way was about a network that is no more."""
        self.mouse.cancel()
        self.adding.dismiss()
        self.title_editor.dismiss()

    def _selection_changed(self, names: tuple[str, ...]) -> None:
        if names:
            self.marks.choose(None, None)
        self.content.mark_selected(names)
        self.minimap.follow()

    def _edit_title(self, index: int) -> None:
        self.title_editor.edit(self.content.backdrops[index])

    def _retitle(self, index: int, title: str) -> None:
        network = self._session.network
        backdrop = replace(backdrops_of(network)[index], title=title)
        self._session.do(change(network, index, backdrop))


# What to do on a canvas with nothing on it; gone with the first node.

TEXT = "Tab or double-click adds a module; drag one from the library; drop a file"


class EmptyHint(QLabel):
    """A line in the middle of an empty canvas, through which the mouse reaches the canvas."""

    def __init__(self, session: Session | Level, ground: QWidget) -> None:
        super().__init__(TEXT, ground)
        self.setObjectName("canvas.empty_hint")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setWordWrap(True)
        self.setForegroundRole(FAINT)
        self._session = session
        self._ground = ground
        ground.installEventFilter(self)
        session.opened.connect(self._follow)
        session.changed.connect(self._follow)
        self._follow()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self._ground and event.type() is QEvent.Type.Resize:
            self._fill()
        return False

    def _follow(self, *_: object) -> None:
        empty = not self._session.network.nodes
        if empty:
            self._fill()
        self.setVisible(empty)

    def _fill(self) -> None:
        self.setGeometry(self._ground.rect().adjusted(24, 0, -24, 0))
