"""What the mouse does on the canvas: which gesture begins where, and what the pointer marks."""

from __future__ import annotations

from PySide6.QtCore import QObject, QPoint, Qt, Signal
from PySide6.QtGui import QMouseEvent

from app.editor.canvas.hands.dots import Dots, DragDot
from app.editor.canvas.hands.drag_nodes import DragNodes, ResizeBackdrop
from app.editor.canvas.hands.drag_wire import DragWire, Dropped
from app.editor.canvas.hands.gestures import Cut, Gesture, Pan, RubberBand
from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.items.hits import Hit
from app.editor.canvas.items.marks import Marks
from core.editing.backdrops import nodes_on

_LEFT, _MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton
_ALT, _SHIFT = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ShiftModifier
_CTRL = Qt.KeyboardModifier.ControlModifier


class Mouse(QObject):
    """Begins gestures, leads them and ends them.

    Parameters
    ----------
    surface : Surface
        What it works with.
    marks : Marks
        The selected wire or backdrop, and what the pointer is over.
    dots : Dots
        What puts a dot on a wire.
    dropped : callable
        Called when a wire ends on empty ground.
    parent : QObject
        What owns it.

    Signals
    -------
    activated(name)
        A node was double-clicked.
    search_wanted(pos)
        Empty ground was double-clicked, at this pixel of the view.
    title_wanted(index)
        A backdrop's title was double-clicked.
    """

    activated = Signal(str)
    search_wanted = Signal(QPoint)
    title_wanted = Signal(int)

    def __init__(
        self, surface: Surface, marks: Marks, dots: Dots, dropped: Dropped, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._dots = dots
        self._dropped = dropped
        self._surface = surface
        self._marks = marks
        self._gesture: Gesture | None = None
        self._button = Qt.MouseButton.NoButton
        self.pos: QPoint | None = None

    @property
    def busy(self) -> bool:
        """Whether a gesture is under way."""
        return self._gesture is not None

    def press(self, event: QMouseEvent) -> None:
        """Begin what begins there."""
        self.pos = event.position().toPoint()
        self._surface.view.setFocus(Qt.FocusReason.MouseFocusReason)
        if self._gesture is not None:
            return
        self._marks.hover(Hit())
        self._gesture = self._begun(event, self.pos)
        self._button = event.button()

    def move(self, event: QMouseEvent) -> None:
        """Go on with it, or mark what is under the pointer."""
        self.pos = event.position().toPoint()
        if self._gesture is not None:
            self._gesture.to(self.pos)
        elif event.buttons() == Qt.MouseButton.NoButton:
            self._marks.hover(self._surface.hit(self._surface.view.scene_point(self.pos)))

    def release(self, event: QMouseEvent) -> None:
        """End it."""
        self.pos = event.position().toPoint()
        if self._gesture is not None and event.button() == self._button:
            gesture, self._gesture = self._gesture, None
            gesture.release(self.pos)

    def cancel(self) -> None:
        """Give up what is under way."""
        if self._gesture is not None:
            gesture, self._gesture = self._gesture, None
            gesture.cancel()

    def leave(self) -> None:
        """The pointer is elsewhere."""
        self.pos = None
        if self._gesture is None:
            self._marks.hover(Hit())

    def double_click(self, event: QMouseEvent) -> None:
        """Open what is there, or search for what could be."""
        if event.button() != _LEFT or self._gesture is not None:
            return
        pos = event.position().toPoint()
        hit = self._surface.hit(self._surface.view.scene_point(pos))
        if hit.node is not None:
            self.activated.emit(hit.node.id)
        elif hit.backdrop is not None:
            self.title_wanted.emit(hit.backdrop.index)
        elif hit.wire is None:
            self.search_wanted.emit(pos)
        elif hit.dot is None:
            self._dots.add_at(hit.wire, self._surface.view.scene_point(pos))

    def _begun(self, event: QMouseEvent, pos: QPoint) -> Gesture | None:
        surface, keys = self._surface, event.modifiers()
        if event.button() == _MIDDLE or (event.button() == _LEFT and keys & _ALT):
            cutting = event.button() == _LEFT and keys & _SHIFT
            return Cut(surface, pos) if cutting else Pan(surface, pos)
        if event.button() != _LEFT:
            return None
        hit = surface.hit(surface.view.scene_point(pos))
        adding = bool(keys & (_SHIFT | _CTRL))
        if hit.port is not None:
            return DragWire(surface, pos, hit.port, self._dropped)
        if hit.node is not None:
            return self._on_node(hit.node.id, pos, adding)
        self._marks.choose(hit.wire.link if hit.wire else None, hit.backdrop, hit.dot)
        if hit.wire is not None:
            surface.session.select(())
            return None if hit.dot is None else DragDot(surface, pos, hit.wire, hit.dot)
        if hit.backdrop is not None:
            surface.session.select(())
            if hit.handle:
                return ResizeBackdrop(surface, pos, hit.backdrop)
            names = nodes_on(surface.session.network, hit.backdrop.index, surface.content.sizes())
            return DragNodes(surface, pos, names, hit.backdrop)
        return RubberBand(surface, pos, surface.session.selection if adding else ())

    def _on_node(self, name: str, pos: QPoint, adding: bool) -> Gesture | None:
        session = self._surface.session
        self._marks.choose(None, None)
        selected = session.selection
        if adding:
            others = tuple(other for other in selected if other != name)
            session.select(others if name in selected else (*selected, name))
            if name in selected:
                return None
        elif name not in selected:
            session.select([name])
        grabbed = "" if adding else name
        return DragNodes(self._surface, pos, session.selection, grabbed=grabbed)
