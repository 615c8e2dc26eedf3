"""What is dropped on the canvas from elsewhere: modules of the library, files."""

from __future__ import annotations

from PySide6.QtCore import QMimeData, QObject, QPointF, Signal
from PySide6.QtGui import QDropEvent

from app.editor.canvas.hands.insertion import added_at, wire_for_new
from app.editor.canvas.hands.surface import Surface
from app.editor.library.library_view import dragged_module
from app.presets.preset_files import KEY
from core.network.network import Link


class Dropping(QObject):
    """Takes modules, which become nodes, and files, which the window opens.

    Signals
    -------
    files_dropped(paths, point)
        Files, with the point of the scene.
    preset_dropped(key, point)
        A preset of the library, with the point of the scene.
    """

    files_dropped = Signal(list, QPointF)
    preset_dropped = Signal(str, QPointF)

    def __init__(self, surface: Surface, parent: QObject) -> None:
        super().__init__(parent)
        self._surface = surface
        self._over: Link | None = None

    def over(self, event: QDropEvent) -> bool:
        """Mark the wire that a module would be put into; whether anything can be dropped."""
        module = dragged_module(event.mimeData())
        if module in self._surface.session.library:
            wire = wire_for_new(self._surface, module, self._point(event))
            self._mark(wire.link if wire is not None else None)
            return True
        return module.startswith(KEY) or bool(_files(event.mimeData()))

    def left(self) -> None:
        """It is dragged elsewhere."""
        self._mark(None)

    def drop(self, event: QDropEvent) -> bool:
        """Put it there; whether it could be."""
        self._mark(None)
        session, point = self._surface.session, self._point(event)
        module = dragged_module(event.mimeData())
        if module in session.library:
            name, operation = added_at(self._surface, module, point)
            if session.do(operation):
                session.select([name])
                self._surface.view.setFocus()
            return True
        if module.startswith(KEY):
            self.preset_dropped.emit(module, point)
            return True
        paths = _files(event.mimeData())
        if paths:
            self.files_dropped.emit(paths, point)
        return bool(paths)

    def _point(self, event: QDropEvent) -> QPointF:
        return self._surface.view.scene_point(event.position())

    def _mark(self, link: Link | None) -> None:
        wires = self._surface.content.wires
        for marked, on in ((self._over, False), (link, True)):
            if marked is not None and marked in wires:
                wires[marked].set_state(target=on)
        self._over = link


def _files(data: QMimeData) -> list[str]:
    return [url.toLocalFile() for url in data.urls() if url.isLocalFile()]
