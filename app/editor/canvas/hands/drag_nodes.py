"""Moving nodes and backdrops with the mouse."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from PySide6.QtCore import QPoint, QPointF, QRectF, QSizeF

from app.editor.canvas.hands.gestures import Gesture
from app.editor.canvas.hands.insertion import insertion_at
from app.editor.canvas.hands.new_nodes import with_way_made
from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.items.backdrop_item import SMALLEST, BackdropItem
from app.editor.canvas.items.wire_item import WireItem
from core.editing.backdrops import Backdrop, change
from core.editing.operations import Move, Operation, Together
from core.editing.wire_dots import moved_with_dots
from core.network.network import Network


class DragNodes(Gesture):
    """Move nodes, and a backdrop with what stands on it. One node on a wire is put into it.

    Parameters
    ----------
    surface : Surface
        What it works with.
    pos : QPoint
        The pixel of the view that was pressed.
    names : iterable of str
        The nodes to move.
    backdrop : BackdropItem, optional
        The backdrop to move.
    grabbed : str
        The node under the pointer; a mere click selects it alone.
    """

    def __init__(
        self,
        surface: Surface,
        pos: QPoint,
        names: Iterable[str],
        backdrop: BackdropItem | None = None,
        grabbed: str = "",
    ) -> None:
        super().__init__(surface, pos)
        nodes = surface.content.nodes
        self._from = {name: nodes[name].pos() for name in names if name in nodes}
        self._backdrop = backdrop
        self._frame = backdrop.frame() if backdrop is not None else QRectF()
        self._grabbed = grabbed
        self._target: WireItem | None = None
        self._inserting: Operation | None = None

    def drag(self, _pos: QPoint, point: QPointF) -> None:
        """The items follow the pointer; a wire that takes the node is marked."""
        by = point - self.start
        self.surface.content.place({name: at + by for name, at in self._from.items()})
        if self._backdrop is not None:
            self._backdrop.place(self._frame.translated(by))
        self._look_for_wire(point)

    def drop(self, _pos: QPoint, point: QPointF) -> None:
        """Put them there, as one step."""
        by = point - self.start
        session = self.surface.session
        places = {name: at + by for name, at in self._from.items()}
        moving = Move({name: _whole(at) for name, at in places.items()})
        operation = moved_with_dots(session.network, moving)
        if self._backdrop is not None:
            frame = self._frame.translated(by)
            operation = moved_together(session.network, self._backdrop, frame, places)
        if self._inserting is not None:
            operation = Together((operation, self._inserting), self._inserting.text)
            (name,) = self._from
            operation = with_way_made(self.surface, operation, name)
        session.do(operation)

    def click(self) -> None:
        """Of several selected nodes the clicked one stays."""
        if self._grabbed:
            self.surface.session.select([self._grabbed])

    def leave(self) -> None:
        """Everything where the document has it."""
        self._mark(None)
        self.surface.content.restore()

    def _look_for_wire(self, point: QPointF) -> None:
        if len(self._from) != 1 or self._backdrop is not None:
            return
        (name,) = self._from
        insertion = insertion_at(self.surface, name, point)
        self._mark(insertion[0] if insertion else None)
        self._inserting = insertion[1] if insertion else None

    def _mark(self, wire: WireItem | None) -> None:
        if self._target is not None and self._target is not wire:
            self._target.set_state(target=False)
        self._target = wire
        if wire is not None:
            wire.set_state(target=True)


class ResizeBackdrop(Gesture):
    """Drag a backdrop's corner."""

    def __init__(self, surface: Surface, pos: QPoint, backdrop: BackdropItem) -> None:
        super().__init__(surface, pos)
        self._backdrop = backdrop
        self._frame = backdrop.frame()

    def drag(self, _pos: QPoint, point: QPointF) -> None:
        """The corner follows the pointer."""
        self._backdrop.place(self._resized(point))

    def drop(self, _pos: QPoint, point: QPointF) -> None:
        """Resize it."""
        session = self.surface.session
        changed = backdrop_at(self._backdrop.shown, self._resized(point))
        session.do(change(session.network, self._backdrop.index, changed))

    def leave(self) -> None:
        """As the document has it."""
        self.surface.content.restore()

    def _resized(self, point: QPointF) -> QRectF:
        by = point - self.start
        size = QSizeF(self._frame.width() + by.x(), self._frame.height() + by.y())
        return QRectF(self._frame.topLeft(), size.expandedTo(SMALLEST))


def moved_together(
    network: Network, backdrop: BackdropItem, frame: QRectF, places: Mapping[str, QPointF]
) -> Operation:
    """Move a backdrop, and nodes with it."""
    moved = change(network, backdrop.index, backdrop_at(backdrop.shown, frame))
    whole = {name: _whole(at) for name, at in places.items()}
    moving = moved_with_dots(network, Move(whole))
    return Together((moved, moving), f"Move {backdrop.title or 'backdrop'}")


def backdrop_at(backdrop: Backdrop, frame: QRectF) -> Backdrop:
    """The backdrop with this frame, in whole units."""
    x, y = _whole(frame.topLeft())
    size = frame.size().expandedTo(SMALLEST)
    width, height = float(round(size.width())), float(round(size.height()))
    return replace(backdrop, x=x, y=y, width=width, height=height)


def _whole(point: QPointF) -> tuple[float, float]:
    return float(round(point.x())), float(round(point.y()))
