"""Which wire and which backdrop are selected, and what the pointer is over: the view's alone.

Held by their names in the document, never as items: items are replaced.
"""

from __future__ import annotations

from app.editor.canvas.items.backdrop_item import BackdropItem
from app.editor.canvas.items.canvas_style import Side
from app.editor.canvas.items.content import Content
from app.editor.canvas.items.hits import Hit
from core.network.network import Link


class Marks:
    """At most one wire, one dot of it, or one backdrop is selected; nodes are in the session."""

    def __init__(self, content: Content) -> None:
        self._content = content
        self._link: Link | None = None
        self._backdrop: int | None = None
        self._dot: int | None = None
        self._over_port: tuple[str, Side, str] | None = None
        self._over_wire: Link | None = None

    @property
    def link(self) -> Link | None:
        """The selected wire's link, while it is there."""
        return self._link if self._link in self._content.wires else None

    @property
    def backdrop(self) -> BackdropItem | None:
        backdrops = self._content.backdrops
        index = self._backdrop
        return backdrops[index] if index is not None and index < len(backdrops) else None

    @property
    def dot(self) -> int | None:
        wire = self._content.wires.get(self._link) if self._link is not None else None
        there = wire is not None and self._dot is not None and self._dot < len(wire.dots)
        return self._dot if there else None

    def choose(
        self, link: Link | None, backdrop: BackdropItem | None, dot: int | None = None
    ) -> None:
        self._show_chosen(False)
        self._link, self._dot = link, dot
        self._backdrop = backdrop.index if backdrop is not None else None
        self._show_chosen(True)

    def hover(self, hit: Hit) -> None:
        port = hit.port
        over = (port.node.id, port.side, port.name) if port is not None else None
        if over != self._over_port:
            self._show_port(False)
            self._over_port = over
            self._show_port(True)
        link = hit.wire.link if hit.wire is not None else None
        if link != self._over_wire:
            self._show_wire(False)
            self._over_wire = link
            self._show_wire(True)

    def _show_chosen(self, on: bool) -> None:
        wire = self._content.wires.get(self._link) if self._link is not None else None
        if wire is not None:
            wire.chosen_dot = self._dot if on else None
            wire.set_state(chosen=on)
            wire.update()
        if self.backdrop is not None:
            self.backdrop.setSelected(on)
            self.backdrop.update()

    def _show_port(self, on: bool) -> None:
        if self._over_port is None:
            return
        name, side, port = self._over_port
        item = self._content.nodes.get(name)
        if item is not None and (side, port) in item.ports:
            item.ports[side, port].hovered = on
            item.update()

    def _show_wire(self, on: bool) -> None:
        wire = self._content.wires.get(self._over_wire) if self._over_wire is not None else None
        if wire is not None:
            wire.set_state(hovered=on)
