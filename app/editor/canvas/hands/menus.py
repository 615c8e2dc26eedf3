"""The menus of the right button: what can be done with a node, a wire, a backdrop, the canvas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QAction, QContextMenuEvent, QKeyEvent
from PySide6.QtWidgets import QMenu, QWidget

from app.editor.canvas.hands.gestures import Surface
from app.editor.canvas.hands.mouse import Dots, backdrop_at, moved_together
from app.editor.canvas.items.backdrop_item import BackdropItem
from app.editor.canvas.items.canvas_style import COLOUR, TINTS
from app.editor.canvas.items.hits import Hit, Marks
from app.editor.gestures import without_argument
from app.editor.widgets import Menu
from core.editing.backdrops import change, nodes_on, remove
from core.editing.operations import ABSENT, Move, Rewire, Together, named, set_node_field
from core.editing.wire_dots import moved_with_dots


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


# What the keys do on the canvas: nudge, go from node to node, wire, open.

_KEY = Qt.Key
_ARROWS: Mapping[int, tuple[float, float]] = {
    _KEY.Key_Left: (-1.0, 0.0),
    _KEY.Key_Right: (1.0, 0.0),
    _KEY.Key_Up: (0.0, -1.0),
    _KEY.Key_Down: (0.0, 1.0),
}
_NUDGE, _FINE = 12.0, 1.0
_ASIDE = 2.5  # how much worse it is to be off the line than to be far


class Keys:
    """The canvas's keys that are no shortcuts of the window.

    Arrows move what is selected, with Shift by one unit; where nothing is selected, and with Ctrl,
    they go from node to node. Shift with Ctrl adds to the selection.
    """

    def __init__(self, surface: Surface, marks: Marks, dots: Dots) -> None:
        self._surface, self._marks, self._dots = surface, marks, dots
        self._nudging = False

    def press(self, event: QKeyEvent) -> bool:
        """Carry out the key's command; whether it has one."""
        arrow = _ARROWS.get(event.key())
        if arrow is not None:
            self._arrow(arrow, event.modifiers())
            return True
        selected = self._surface.session.selection
        if event.key() in (_KEY.Key_Return, _KEY.Key_Enter) and not event.modifiers():
            if selected:
                self._surface.activated.emit(selected[-1])
            elif self._marks.backdrop is not None:
                self._surface.title_wanted.emit(self._marks.backdrop.index)
            return True
        if event.key() == _KEY.Key_Tab:
            self._surface.search_wanted.emit(QPointF(*self._surface.cursor_point()))
            return True
        return False

    def release(self, event: QKeyEvent) -> None:
        if self._nudging and event.key() in _ARROWS and not event.isAutoRepeat():
            self._nudging = False
            self._surface.session.end_gesture()

    def _arrow(self, arrow: tuple[float, float], keys: Qt.KeyboardModifier) -> None:
        selected = self._surface.session.selection
        going = bool(keys & Qt.KeyboardModifier.ControlModifier)
        shift = bool(keys & Qt.KeyboardModifier.ShiftModifier)
        step = _FINE if shift else _NUDGE
        if not (going or selected) and self._dots.nudge(QPointF(*arrow) * step):
            self._nudging = True
        elif going or not (selected or self._marks.backdrop is not None):
            self._go(arrow, adding=shift)
        elif selected:
            self._nudge(QPointF(*arrow) * step)
        elif self._marks.backdrop is not None:
            self._shift_backdrop(self._marks.backdrop, QPointF(*arrow) * _NUDGE, resize=shift)

    def _nudge(self, by: QPointF) -> None:
        session, nodes = self._surface.session, self._surface.content.nodes
        places = {
            name: (nodes[name].x() + by.x(), nodes[name].y() + by.y()) for name in session.selection
        }
        self._nudging = True
        moving = moved_with_dots(session.network, Move(places))
        session.do(moving, gesture=("nudge", session.selection))
        self._surface.view.make_visible(self._surface.content.bounds(session.selection))

    def _shift_backdrop(self, backdrop: BackdropItem, by: QPointF, *, resize: bool) -> None:
        session, content = self._surface.session, self._surface.content
        frame = backdrop.frame()
        gesture = ("backdrop", backdrop.index, resize)
        self._nudging = True
        if resize:
            changed = backdrop_at(backdrop.shown, frame.adjusted(0, 0, by.x(), by.y()))
            session.do(change(session.network, backdrop.index, changed), gesture=gesture)
            return
        names = nodes_on(session.network, backdrop.index, content.sizes())
        places = {name: content.nodes[name].pos() + by for name in names}
        operation = moved_together(session.network, backdrop, frame.translated(by), places)
        session.do(operation, gesture=gesture)

    def _go(self, arrow: tuple[float, float], *, adding: bool) -> None:
        surface = self._surface
        session, content = surface.session, surface.content
        spots: dict[str | int, QPointF] = {
            name: item.frame().center() for name, item in content.nodes.items()
        }
        if not adding:
            spots |= {
                item.index: item.head(surface.view.zoom).center() for item in content.backdrops
            }
        here: str | int | None = session.selection[-1] if session.selection else None
        if here is None and self._marks.backdrop is not None:
            here = self._marks.backdrop.index
        start = spots.pop(here) if here in spots else None
        if start is None:  # nothing selected: the one nearest the middle
            middle = surface.view.visible_rect().center()
            nearest = min(
                spots, key=lambda one: (spots[one] - middle).manhattanLength(), default=None
            )
        else:
            nearest = _next(spots, start, arrow)
        if isinstance(nearest, str):
            self._marks.choose(None, None)
            session.select((*session.selection, nearest) if adding else (nearest,))
            surface.view.make_visible(content.nodes[nearest].frame())
        elif nearest is not None:
            session.select(())
            self._marks.choose(None, content.backdrops[nearest])
            surface.view.make_visible(content.backdrops[nearest].frame())


def _next(
    spots: Mapping[str | int, QPointF], start: QPointF, arrow: tuple[float, float]
) -> str | int | None:
    best: tuple[float, str | int] | None = None
    for candidate, spot in spots.items():
        way = spot - start
        ahead = way.x() * arrow[0] + way.y() * arrow[1]
        aside = abs(way.x() * arrow[1]) + abs(way.y() * arrow[0])
        cost = ahead + _ASIDE * aside
        if ahead > 1.0 and (best is None or cost < best[0]):
            best = (cost, candidate)
    return best[1] if best is not None else None
