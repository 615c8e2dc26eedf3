"""Presets in the window: listed in the library, put on the canvas, saved from a macro."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, QPointF

from app.editor.canvas.canvas import Canvas
from app.editor.level import Level
from app.editor.library_view import LibraryView
from app.run.preset_files import (
    KEY,
    Preset,
    own_presets,
    placed,
    preset_of,
    save_preset,
    shipped_presets,
)
from core.errors import ImagechainError
from core.network.network import Network


class PresetShelf(QObject):
    def __init__(
        self, level: Level, canvas: Canvas, library_view: LibraryView, folder: Path, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._level = level
        self._canvas = canvas
        self._view = library_view
        self.folder = folder
        self.presets: tuple[Preset, ...] = ()
        self.refresh()
        canvas.preset_dropped.connect(self.add_at)

    def refresh(self) -> None:
        library = self._level.library
        self.presets = (*shipped_presets(library), *own_presets(self.folder, library))
        self._view.show_presets(self.presets)

    def add(self, key: str) -> bool:
        """Put a preset where the mouse was last; False for the key of a module."""
        if not key.startswith(KEY):
            return False
        self._put(key, self._canvas.cursor_point())
        return True

    def add_at(self, key: str, point: QPointF) -> None:
        self._put(key, (round(point.x()), round(point.y())))
        self._canvas.view.setFocus()

    def save(self) -> None:
        level = self._level
        for name in level.selection[-1:]:
            try:
                node = level.network.nodes[name]
                values = {one: level.value(name, one) for one in node.linked}
                alone = Network(nodes={name: replace(node, params={**node.params, **values})})
                path = save_preset(alone, name, self.folder, level.library)
            except ImagechainError as error:
                level.message.emit("error", f"not saved as a preset: {error}")
                return
            self.refresh()
            level.message.emit("note", f"saved as a preset: {path}")

    def _put(self, key: str, at: tuple[float, float]) -> None:
        preset = preset_of(key, self.presets)
        level = self._level
        try:
            if preset is None:
                return
            name, operation = placed(preset, level.network, level.library, at)
        except ImagechainError as error:
            level.message.emit("error", str(error))
            return
        if level.do(operation):
            level.select([name])
