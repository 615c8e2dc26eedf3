"""What the Edit and View menus do to the document, the canvas and the clipboard."""

from __future__ import annotations

from collections.abc import Callable, Collection

from PySide6.QtCore import QObject
from PySide6.QtGui import QGuiApplication

from app.editor.canvas.canvas import Canvas
from app.editor.panels.fields.panel_node import copy_values, paste_values
from app.editor.session import Level
from core.editing.backdrops import Backdrop, add, around, laid_out
from core.editing.clipboard import copied, duplicated, pasted
from core.editing.grouping import group, ungroup
from core.editing.layout import Edge, Point, Way, aligned, arranged, distributed
from core.editing.operations import (
    Move,
    Operation,
    Rewire,
    Together,
    keeping_values,
    output_toggled,
    set_node_field,
)
from core.editing.wire_dots import dots_of, moved_with_dots, straighten
from core.editing.wiring import deleted, dissolved
from core.errors import ImagechainError

_NEW_BACKDROP = (360.0, 200.0)  # where no node is selected
_NEW_NOTE = (220.0, 90.0)


class EditCommands(QObject):
    def __init__(self, session: Level, canvas: Canvas, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._canvas = canvas

    def copy(self) -> None:
        names = self._session.selection
        if names:
            session = self._session
            text = copied(session.network, names, session.library, session.value)
            QGuiApplication.clipboard().setText(text)

    def cut(self) -> None:
        session = self._session
        if session.selection:
            self.copy()
            self._take_out(dissolved(session.network, session.library, session.selection, "Cut"))

    def paste(self) -> None:
        session = self._session
        text = QGuiApplication.clipboard().text()
        try:
            names, operation = pasted(
                text,
                session.network,
                library=session.library,
                at=self._canvas.cursor_point(),
                sizes=self._canvas.sizes(),
            )
        except ImagechainError as error:
            session.message.emit("error", f"nothing was pasted: {error}")
            return
        if session.do(operation):
            session.select(names)

    def copy_values(self) -> None:
        whole = self._session.session
        copy_values(whole, whole.selection)

    def paste_values(self) -> None:
        whole = self._session.session
        if whole.selection:
            paste_values(whole, whole.selection)

    def duplicate(self) -> None:
        session = self._session
        if session.selection:
            names, operation = duplicated(
                session.network,
                session.selection,
                library=session.library,
                sizes=self._canvas.sizes(),
            )
            if session.do(operation):
                session.select(names)

    def delete(self) -> None:
        """Delete the selected dot or nodes, else the selected wire or backdrop.

        Where there is one way through the nodes, the wire is led past them.
        """
        session, link = self._session, self._canvas.selected_link()
        if self._canvas.dots.remove():
            return
        if session.selection:
            self._take_out(deleted(session.network, session.library, session.selection))
        elif link is not None:
            session.do(Rewire(remove=(link,)))
        else:
            self._canvas.delete_selected_backdrop()

    def _take_out(self, taking: Operation) -> None:
        """Take the selected nodes out; parameters that follow them keep their values."""
        session = self._session
        operation, kept = keeping_values(
            network=session.network, names=session.selection, taking=taking, value_of=session.value
        )
        if session.do(operation) and kept:
            more = f" and {len(kept) - 3} more" if kept[3:] else ""
            session.message.emit(
                "note", f"no longer linked, with the value it had: {', '.join(kept[:3])}{more}"
            )

    def select_all(self) -> None:
        self._session.select(self._session.network.nodes)

    def disable(self) -> None:
        nodes = [self._session.network.nodes[name] for name in self._session.selection]
        off = not all(node.disabled for node in nodes)
        steps: list[Operation] = [
            set_node_field(node.id, "disabled", off) for node in nodes if node.disabled != off
        ]
        if steps:
            self._session.do(steps[0] if len(steps) == 1 else Together(steps))

    def mark_output(self) -> None:
        session = self._session
        for name in session.selection[-1:]:
            try:
                session.do(output_toggled(session.network, session.library, name))
            except ImagechainError as error:
                session.message.emit("error", str(error))

    def group(self) -> None:
        session = self._session
        try:
            name, operation = group(
                session.network,
                session.library,
                session.selection,
                where=session.head,
                value_of=session.value,
            )
        except ImagechainError as error:
            session.message.emit("error", str(error))
            return
        if session.do(operation):
            session.select([name])

    def ungroup(self) -> None:
        session = self._session
        for macro in session.selection[-1:]:
            try:
                names, operation = ungroup(session.network, session.library, macro, session.head)
            except ImagechainError as error:
                session.message.emit("error", str(error))
                return
            if session.do(operation):
                session.select(names)

    def backdrop(self) -> None:
        session = self._session
        if session.selection:
            operation = around(session.network, session.selection, self._canvas.sizes())
        else:
            x, y = self._canvas.cursor_point()
            operation = add(session.network, Backdrop("Backdrop", x, y, *_NEW_BACKDROP))
        if session.do(operation):
            self._canvas.edit_last_title()

    def note(self) -> None:
        x, y = self._canvas.cursor_point()
        operation = add(self._session.network, Backdrop("Note", x, y, *_NEW_NOTE, note=True))
        if self._session.do(operation):
            self._canvas.edit_last_title()

    def arrange(self) -> None:
        """Lay out the selected nodes, or all; long chains in rows of the canvas's width."""
        session, canvas = self._session, self._canvas
        drawn, room = canvas.sizes_with_thumbnails(), canvas.view.natural_room()
        if len(session.selection) > 1:
            places = arranged(session.network, drawn, only=session.selection, room=room)
            session.do(self._without_dots(Move(places, "Lay out"), session.selection))
        elif session.network.nodes:
            moving = laid_out(session.network, canvas.sizes(), room, drawn)
            session.do(self._without_dots(moving, session.network.nodes))
        self._canvas.frame_all()

    def _without_dots(self, moving: Operation, names: Collection[str]) -> Operation:
        """Wires at nodes that are laid out find their own way: dots are of another picture."""
        network = self._session.network
        bent = [link for link in dots_of(network) if {link.source, link.target} & set(names)]
        return Together((moving, straighten(network, bent)), moving.text) if bent else moving

    def align(self, edge: Edge) -> None:
        self._arranged(aligned, edge, f"Align at the {edge}")

    def distribute(self, way: Way) -> None:
        self._arranged(distributed, way, f"Distribute {way}")

    def _arranged(self, places: Callable[..., dict[str, Point]], how: str, label: str) -> None:
        session = self._session
        points = places(session.network, session.selection, self._canvas.sizes(), how)
        if points:
            session.do(moved_with_dots(session.network, Move(dict(points), label)))
        else:
            session.message.emit("note", f"{label.lower()}: select two nodes or more")

    def frame(self) -> None:
        if self._session.selection:
            self._canvas.frame_selection()
        else:
            self._canvas.frame_all()
