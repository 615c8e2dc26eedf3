"""What the keys do on the canvas: nudge, go from node to node, wire, open."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QKeyEvent

from app.editor.canvas.hands.dots import Dots
from app.editor.canvas.hands.gestures import Surface
from app.editor.canvas.hands.mouse import backdrop_at, moved_together
from app.editor.canvas.items.backdrop_item import BackdropItem
from app.editor.canvas.items.marks import Marks
from core.editing.backdrops import change, nodes_on
from core.editing.operations import Move
from core.editing.wire_dots import moved_with_dots

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
