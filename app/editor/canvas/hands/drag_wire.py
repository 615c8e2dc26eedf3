"""Drawing a wire with the mouse, from a port to another one or to empty ground."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPoint, QPointF, Qt

from app.editor.canvas.hands.gestures import Gesture
from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.items.hits import node_at, port_near
from app.editor.canvas.items.node_item import NodePort
from app.editor.canvas.items.wire_item import WireItem
from core.editing.links import refusal
from core.editing.operations import Rewire
from core.network.network import Link, Network

# What is done with a wire that ends on empty ground: its fixed end, the wire it was before, where.
Dropped = Callable[[NodePort, Link | None, QPoint], None]


class DragWire(Gesture):
    """Draw a wire from a port. At an input that has a wire, that one is picked up.

    Parameters
    ----------
    surface : Surface
        What it works with.
    pos : QPoint
        The pixel of the view that was pressed.
    port : NodePort
        The port that was pressed.
    dropped : callable
        Called if the wire ends on empty ground.
    """

    def __init__(self, surface: Surface, pos: QPoint, port: NodePort, dropped: Dropped) -> None:
        super().__init__(surface, pos)
        self._carried = _wire_into(surface, port)
        self._fixed: NodePort = self._carried.output_port if self._carried else port
        self._dropped = dropped
        self._network = _without(surface.session.network, self._carried)
        self._candidates: list[NodePort] = []

    def drag(self, pos: QPoint, point: QPointF) -> None:
        """The wire's end follows the pointer, to a port where it fits."""
        surface = self.surface
        if not self._candidates:
            self._begin()
        port, refused = self._target(point)
        end = port.centre() if port is not None and not refused else point
        ends = (self._fixed.centre(), end)
        if self._fixed.face.side == "input":
            ends = (end, self._fixed.centre())
        refusing = bool(refused)
        colour = surface.content.style.port(self._fixed.face.types)
        surface.live.show_wire(*ends, surface.content.style.error if refusing else colour)
        surface.hint.show_at(refused or "", pos)
        shape = Qt.CursorShape.ForbiddenCursor if refusing else Qt.CursorShape.CrossCursor
        surface.view.viewport().setCursor(shape)

    def drop(self, pos: QPoint, point: QPointF) -> None:
        """Wire it, show why not, or offer modules to put there."""
        session = self.surface.session
        old = self._carried.link if self._carried is not None else None
        port, refused = self._target(point)
        if refused:
            session.message.emit("error", refused)
        elif port is not None:
            new = link_between(self._fixed, port)
            session.do(Rewire(add=(new,), remove=(old,) if old else (), label=f"Connect {new}"))
        else:
            self._dropped(self._fixed, old, pos)

    def leave(self) -> None:
        """Remove the live wire and the marks."""
        surface = self.surface
        surface.live.setVisible(False)
        surface.hint.hide()
        surface.view.viewport().unsetCursor()
        if self._carried is not None:
            self._carried.setVisible(True)
        for item in surface.content.nodes.values():
            for port in item.ports.values():
                port.fits = None
            item.update()

    def _begin(self) -> None:
        """Mark which ports it fits."""
        surface = self.surface
        if self._carried is not None:
            self._carried.setVisible(False)
        for item in surface.content.nodes.values():
            for port in item.ports.values():
                if port is not self._fixed:
                    port.fits = self._refusal(port) is None
                    self._candidates.append(port)
            item.update()

    def _target(self, point: QPointF) -> tuple[NodePort | None, str | None]:
        """The port the wire would end at, or why what is there takes no such wire."""
        content = self.surface.content
        port = port_near(content, point, self.surface.view.zoom)
        if port is self._fixed:
            return None, None
        if port is not None:
            return port, self._refusal(port)
        node = node_at(content, point)
        if node is None or node is self._fixed.node:
            return None, None
        if self._carried is not None and node is self._carried.input_port.node:
            return self._carried.input_port, None
        others = [
            other for other in node.ports.values() if other.face.side != self._fixed.face.side
        ]
        fitting = [other for other in others if self._refusal(other) is None]
        free = [other for other in fitting if not (other.wires and other.face.side == "input")]
        if fitting:
            return (free or fitting)[0], None
        side = "input" if self._fixed.face.side == "output" else "output"
        kinds = " or ".join(self._fixed.face.types) or "this wire"
        return None, f"{node.id} has no {side} for {kinds}"

    def _refusal(self, port: NodePort) -> str | None:
        if port.face.side == self._fixed.face.side:
            return f"a wire leads from an output to an input; {port.name} is an {port.face.side}"
        link = link_between(self._fixed, port)
        return refusal(self._network, self.surface.session.library, link)


def link_between(one: NodePort, other: NodePort) -> Link:
    """The link between an output and an input, in whichever order."""
    output, entry = (one, other) if one.face.side == "output" else (other, one)
    return Link(output.node.id, output.name, entry.node.id, entry.name)


def _wire_into(surface: Surface, port: NodePort) -> WireItem | None:
    if port.face.side != "input":
        return None
    wires = surface.content.wires_at(port.node.id)
    return next((wire for wire in wires if wire.input_port is port), None)


def _without(network: Network, wire: WireItem | None) -> Network:
    return network if wire is None else Rewire(remove=(wire.link,)).apply(network)
