"""What is put on the canvas from elsewhere: modules of the library, files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QEvent, QMimeData, QObject, QPointF
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QWidget

from app.editor.canvas.canvas import Canvas
from app.editor.gestures import accept_copy
from app.editor.level import Level
from app.editor.library_view import LibraryView
from app.editor.window.files import Files, is_network_file
from app.run.own_scene import OwnScene, scene_nodes, with_own_scene
from app.run.preset_files import (
    KEY,
    Preset,
    own_presets,
    placed,
    preset_of,
    save_preset,
    shipped_presets,
)
from core.chain.engine import Engine
from core.editing.operations import Operation, Restored, Together, set_parameter
from core.editing.wiring import new_node
from core.errors import ImagechainError
from core.network.macro import expanded
from core.network.network import Network

READ_IMAGE = "read_image"
_DRAGGING = (QEvent.Type.DragEnter, QEvent.Type.DragMove, QEvent.Type.Drop)
# From one file dropped to the next: a node and its picture have room.
_ACROSS, _DOWN, _IN_A_COLUMN = 220.0, 190.0, 5


class Drops(QObject):
    def __init__(self, session: Level, files: Files, canvas: Canvas, window: QWidget) -> None:
        super().__init__(window)
        self._session = session
        self._files = files
        self._canvas = canvas
        window.setAcceptDrops(True)
        window.installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Take files dropped on a part of the window that has no use for them itself."""
        if not isinstance(event, QDropEvent) or event.type() not in _DRAGGING:
            return False
        paths = dropped_files(event.mimeData())
        if paths:
            accept_copy(event)
            if event.type() == QEvent.Type.Drop:
                self.files(paths, QPointF(*self._canvas.cursor_point()))
        return bool(paths)

    def files(self, paths: list[str], point: QPointF) -> None:
        """Open a network, or read pictures: each becomes a Read Image at the point."""
        networks = [path for path in paths if is_network_file(Path(path))]
        if networks:
            self._files.open(networks[0])
            return
        under = self._canvas.node_or_thumbnail_at(point)
        if len(paths) == 1 and under is not None and self._replaced(under, Path(paths[0])):
            return
        steps: list[Operation] = []
        names = []
        network = self._session.network
        for number, path in enumerate(paths):
            column, row = divmod(number, _IN_A_COLUMN)
            at = (point.x() + column * _ACROSS, point.y() + row * _DOWN)
            name, adding = new_node(network, self._session.library, READ_IMAGE, at)
            step = Together((adding, set_parameter(name, "path", self._stored(Path(path)))))
            network = step.apply(network)
            steps.append(step)
            names.append(name)
        if steps and self._session.do(Together(steps, f"Read {_named(paths)}")):
            self._session.select(names)

    def _replaced(self, name: str, path: Path) -> bool:
        """Put a picture in place of the scene that it is dropped on; False where that is none."""
        level = self._session
        network, library = level.network, level.library
        if name not in scene_nodes(network, library):
            return False
        plan = Engine(library).plan(expanded(network, library), folder=level.folder)
        try:
            new = with_own_scene(
                network,
                OwnScene(path, hints=False),
                library=library,
                plan=plan,
                node=name,
                stored=self._stored(path),
            )
        except ImagechainError as error:
            level.message.emit("error", str(error))
            return True
        if level.do(Restored(new.network, f"Put {path.name} in place of {name}")):
            level.select([name])
            level.message.emit("note", "; ".join(new.lines))
        return True

    def _stored(self, path: Path) -> str:
        """Relative to the network's folder where it lies below it."""
        folder = self._session.folder.absolute()
        inside = path.is_relative_to(folder)
        return (path.relative_to(folder) if inside else path).as_posix()


def dropped_files(data: QMimeData) -> list[str]:
    """Paths of the files of this machine that are dragged; none where other things are."""
    return [url.toLocalFile() for url in data.urls() if url.isLocalFile()]


def _named(paths: list[str]) -> str:
    return Path(paths[0]).name if len(paths) == 1 else f"{len(paths)} files"


# The presets of the library: added as macros, and saved from them.


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
            name, operation = placed(preset, level.network, level.library, at, level.folder)
        except ImagechainError as error:
            level.message.emit("error", str(error))
            return
        if level.do(operation):
            level.select([name])
