"""The lists that add nodes and wires: search, what fits a loose wire, wiring by the keyboard."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, QPoint, QPointF

from app.editor.canvas.hands.new_nodes import added, free_place
from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.hands.wire_choices import possible_links
from app.editor.canvas.items.faces import face_of
from app.editor.canvas.items.geometry import geometry_of
from app.editor.canvas.items.node_item import NodePort
from app.editor.canvas.view.choice_popup import Choice, ChoicePopup
from app.editor.library.module_search import found_by
from app.editor.theme import Theme
from core.editing.layout import Point
from core.editing.operations import Operation, Rewire, Together
from core.editing.wiring import Candidate, End, Side, fitting, wired_to
from core.errors import ImagechainError
from core.modules.declaration import declaration
from core.modules.library_type import local_key
from core.network.network import Link, Node


class Adding(QObject):
    """Opens the lists, and does what is chosen."""

    def __init__(self, surface: Surface, popup: ChoicePopup, parent: QObject) -> None:
        super().__init__(parent)
        self._surface = surface
        self._popup = popup
        self._theme: Theme = surface.content.style.theme
        self._loose: Link | None = None
        popup.chosen.connect(self._chosen)
        popup.abandoned.connect(self._abandoned)

    def set_theme(self, theme: Theme) -> None:
        """Mark the groups in these colours."""
        self._theme = theme

    def dismiss(self) -> None:
        """Close the list: what it was opened for is gone."""
        self._popup.dismiss()
        self._forget_wire()

    def search(self, at: Point) -> None:
        """List every module; the chosen one is added at a point of the scene."""
        library = self._surface.session.library
        choices = [self._module_choice(key, partial(self.add, key, at)) for key in library]
        pixel = self._surface.view.pixel(QPointF(*at))
        self._popup.open_at(pixel, "Add a module", choices)

    def find_node(self) -> None:
        """List the nodes by their names; the chosen one is selected and shown."""
        session, view = self._surface.session, self._surface.view
        choices = []
        for name, item in self._surface.content.nodes.items():
            colour = self._theme.groups.get(item.face.group, self._theme.line)
            module = f"{item.face.module} {session.network.nodes[name].module}"
            choices.append(
                Choice(
                    name,
                    partial(self._show_node, name),
                    item.face.module,
                    module,
                    item.face.summary,
                    colour,
                )
            )
        if not choices:
            session.message.emit("note", "there is no node to find yet")
            return
        room = view.viewport().rect()
        self._popup.open_at(QPoint(room.width() // 3, room.height() // 8), "Find a node", choices)

    def _show_node(self, name: str) -> None:
        surface = self._surface
        if name in surface.content.nodes:
            surface.session.select([name])
            frame = surface.content.nodes[name].frame()
            seen = surface.view.visible_rect()
            if frame.width() < seen.width() and frame.height() < seen.height():
                surface.view.make_visible(frame)
            else:
                surface.view.frame(frame)

    def ask_for_wire(self, port: NodePort, loose: Link | None, pos: QPoint) -> None:
        """List the modules that fit a wire from a port that ended on empty ground.

        `loose` is the link the wire was before; it is taken away unless something takes its place.
        """
        surface = self._surface
        end: End = (port.node.id, port.name, port.face.side)
        other: Side = "input" if port.face.side == "output" else "output"
        point = surface.view.scene_point(pos)
        candidates = fitting(surface.session.library, port.face.types, other)
        choices = [
            self._module_choice(
                candidate.module,
                partial(self._wire_to, end, candidate, point, loose),
                port=candidate.port,
            )
            for candidate in candidates
        ]
        if loose is not None:
            choices.insert(0, Choice(f"Disconnect {loose}", self._disconnect_loose))
        elif not choices:
            kinds = " or ".join(port.face.types) or "a wire of unknown type"
            surface.session.message.emit("note", f"no module has an {other} for {kinds}")
            return
        start, finish = port.centre(), point
        if port.face.side == "input":
            start, finish = finish, start
        title = f"Wire {end[0]}.{end[1]} {'to' if other == 'input' else 'from'}"
        self._popup.open_at(pos, title, choices)
        self._loose = loose
        surface.live.show_wire(start, finish, surface.content.style.port(port.face.types))
        if loose is not None and loose in surface.content.wires:
            surface.content.wires[loose].setVisible(False)

    def connect_selected(self) -> None:
        """List the wires that the selected nodes could have, and those they have to take away."""
        surface = self._surface
        session = surface.session
        if not session.selection:
            session.message.emit("advice", "select the node to be wired first")
            return
        possible = possible_links(session.network, session.library, session.selection)
        choices = [
            Choice(
                str(possibility.link),
                partial(self._do, Rewire(add=(possibility.link,))),
                possibility.remark,
            )
            for possibility in possible
        ]
        there = [
            link
            for link in session.network.links
            if {link.source, link.target} & set(session.selection)
        ]
        choices += [
            Choice(f"Disconnect {link}", partial(self._do, Rewire(remove=(link,))))
            for link in there
        ]
        if not choices:
            session.message.emit("advice", "there is nothing to wire the selected nodes to")
            return
        item = surface.content.nodes[session.selection[-1]]
        title = f"Wire {', '.join(session.selection[:3])}{' …' * (len(session.selection) > 3)}"
        surface.view.make_visible(item.frame())
        self._popup.open_at(surface.view.pixel(item.frame().bottomLeft()), title, choices)

    def _module_choice(self, key: str, value: Callable[[], None], port: str = "") -> Choice:
        known = declaration(self._surface.session.library[key])
        _, summary, further = found_by(known)
        return Choice(
            text=known.title,
            value=value,
            detail=port or known.group,
            words=f"{key} {known.group}",
            further=f"{summary} {further}",
            colour=self._theme.groups.get(known.group, self._theme.line),
            tip=known.summary,
        )

    def add(self, key: str, at: Point) -> None:
        """Add a node at a point of the scene; with a node selected, wired on to that one."""
        session = self._surface.session
        name, operation = added(self._surface, key, at)
        if session.do(operation):
            session.select([name])
            self._surface.view.make_visible(self._surface.content.nodes[name].frame())

    def _wire_to(self, end: End, candidate: Candidate, point: QPointF, loose: Link | None) -> None:
        session = self._surface.session
        steps: list[Operation] = [Rewire(remove=(loose,))] if loose is not None else []
        try:
            network = steps[0].apply(session.network) if steps else session.network
            at = self._at_port(candidate, end[2], point)
            name, operation = wired_to(network, session.library, end, candidate, at)
        except ImagechainError as error:
            session.message.emit("error", str(error))
            return
        if session.do(Together((*steps, operation), operation.text)):
            session.select([name])

    def _at_port(self, candidate: Candidate, drawn_from: str, point: QPointF) -> Point:
        """Where a new node stands if its port is to be where the wire ended."""
        known = declaration(self._surface.session.library[candidate.module])
        node = Node(local_key(candidate.module), candidate.module)
        geometry = geometry_of(face_of(node, known, ()), self._surface.content.style)
        side: Side = "input" if drawn_from == "output" else "output"
        at = point - geometry.ports[side, candidate.port]
        return free_place(self._surface, candidate.module, (at.x(), at.y()))

    def _do(self, operation: Operation) -> None:
        self._surface.session.do(operation)

    def _disconnect_loose(self) -> None:
        """Take away the link whose wire was dropped on empty ground."""
        if self._loose is not None:
            self._surface.session.do(Rewire(remove=(self._loose,)))

    def _chosen(self, value: Any) -> None:
        value()
        self._forget_wire()

    def _abandoned(self) -> None:
        self._disconnect_loose()
        self._forget_wire()

    def _forget_wire(self) -> None:
        link, self._loose = self._loose, None
        self._surface.live.setVisible(False)
        if link is not None and link in self._surface.content.wires:
            self._surface.content.wires[link].setVisible(True)
