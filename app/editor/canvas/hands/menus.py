"""The menus of the right button: what can be done with a node, a wire, a backdrop, the canvas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QPoint
from PySide6.QtGui import QAction, QContextMenuEvent
from PySide6.QtWidgets import QMenu, QWidget

from app.editor.canvas.hands.dots import Dots
from app.editor.canvas.hands.gestures import Surface
from app.editor.canvas.items.canvas_style import COLOUR, TINTS
from app.editor.canvas.items.hits import Hit
from app.editor.canvas.items.marks import Marks
from app.editor.gestures import without_argument
from app.editor.widgets import Menu
from core.editing.backdrops import change, remove
from core.editing.operations import ABSENT, Rewire, Together, named, set_node_field


class Menus:
    def __init__(self, surface: Surface, marks: Marks, dots: Dots, parent: QWidget) -> None:
        self._dots, self._surface, self._marks = dots, surface, marks
        self.node_menu = _menu("canvas.menu.node", parent)
        self.canvas_menu = _menu("canvas.menu.canvas", parent)
        self.wire_menu = _menu("canvas.menu.wire", parent)
        self.backdrop_menu = _menu("canvas.menu.backdrop", parent)
        self._colours = _menu("canvas.menu.colours", parent)
        self._colours.setTitle("Co&lour")
        for name in ("", *TINTS):
            action = self._colours.addAction(name.capitalize() or "&As its group")
            action.triggered.connect(partial(self._colour, name))
        self.wire_menu.addAction("&Disconnect").triggered.connect(self._disconnect)
        self._add_dot = self.wire_menu.addAction("&Add Dot")
        self._add_dot.setToolTip("Bend the wire through a dot here (R, or double-click)")
        self._add_dot.triggered.connect(self._put_dot)
        self._delete_dot = self.wire_menu.addAction("D&elete Dot")
        self._delete_dot.triggered.connect(partial(without_argument, dots.remove))
        self._straighten = self.wire_menu.addAction("&Straighten")
        self._straighten.setToolTip("Remove all dots from the wire")
        self._straighten.triggered.connect(partial(without_argument, dots.straighten))
        self._pos: QPoint | None = None
        self.backdrop_menu.addAction("&Edit Title").triggered.connect(self._edit_title)
        self.backdrop_menu.addAction("&Delete Backdrop").triggered.connect(self.delete_backdrop)
        self.backdrop_menu.addMenu(self._colours)

    def fill(self, node_actions: Sequence[QAction], canvas_actions: Sequence[QAction]) -> None:
        for menu, actions in ((self.node_menu, node_actions), (self.canvas_menu, canvas_actions)):
            menu.clear()
            menu.addActions(list(actions))
        self.node_menu.addMenu(self._colours)

    def delete_backdrop(self, *_: object) -> None:
        session, backdrop = self._surface.session, self._marks.backdrop
        if backdrop is not None:
            self._marks.choose(None, None)
            session.do(remove(session.network, backdrop.index))

    def open(self, event: QContextMenuEvent) -> None:
        """Pop up the menu of what is under the pointer or, by the keyboard, what is selected."""
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            hit, pos = self._selected()
        else:
            pos = event.pos()
            hit = self._surface.hit(self._surface.view.scene_point(pos))
        self._pos = pos
        menu = self._menu_of(hit)
        if menu.actions():
            menu.popup(self._surface.view.viewport().mapToGlobal(pos))

    def _menu_of(self, hit: Hit) -> QMenu:
        session = self._surface.session
        if hit.node is not None:
            if hit.node.id not in session.selection:
                self._marks.choose(None, None)
                session.select([hit.node.id])
            return self.node_menu
        if hit.wire is not None or hit.backdrop is not None:
            session.select(())
            self._marks.choose(hit.wire.link if hit.wire else None, hit.backdrop, hit.dot)
            self._add_dot.setEnabled(hit.dot is None)
            self._delete_dot.setEnabled(hit.dot is not None)
            self._straighten.setEnabled(hit.wire is not None and bool(hit.wire.dots))
            return self.wire_menu if hit.wire is not None else self.backdrop_menu
        return self.canvas_menu

    def _selected(self) -> tuple[Hit, QPoint]:
        content, view = self._surface.content, self._surface.view
        names = self._surface.session.selection
        link, backdrop = self._marks.link, self._marks.backdrop
        if names:
            item = content.nodes[names[-1]]
            return Hit(node=item), view.pixel(item.frame().center())
        if link is not None:
            wire = content.wires[link]
            dot = self._marks.dot
            middle = wire.line()[len(wire.line()) // 2] if dot is None else wire.dots[dot]
            return Hit(wire=wire, dot=dot), view.pixel(middle)
        if backdrop is not None:
            return Hit(backdrop=backdrop), view.pixel(backdrop.head(view.zoom).center())
        return Hit(), view.viewport().rect().center()

    def _colour(self, name: str, *_: object) -> None:
        session, backdrop = self._surface.session, self._marks.backdrop
        if session.selection:
            value = name or ABSENT
            steps = [set_node_field(node, COLOUR, value) for node in session.selection]
            session.do(Together(steps, f"Colour {named(session.selection)}"))
        elif backdrop is not None:
            changed = replace(backdrop.shown, colour=name)
            session.do(change(session.network, backdrop.index, changed))

    def _disconnect(self) -> None:
        link = self._marks.link
        if link is not None:
            self._surface.session.do(Rewire(remove=(link,)))

    def _put_dot(self) -> None:
        self._dots.add(self._pos)

    def _edit_title(self) -> None:
        if self._marks.backdrop is not None:
            self._surface.title_wanted.emit(self._marks.backdrop.index)


def _menu(name: str, parent: QWidget) -> QMenu:
    menu = Menu(parent)
    menu.setObjectName(name)
    menu.setToolTipsVisible(True)
    return menu
