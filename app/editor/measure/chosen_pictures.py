"""The pictures that are measured, or fitted to: files, or what a viewer shows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QEvent, QMimeData, QObject
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QWidget

from app.editor.gestures import accept_copy
from app.editor.measure.viewer_pictures import ViewerPicture
from nodes.files.common.file_format import JSON

Pictures = tuple[Path, ...] | ViewerPicture
_DRAGGING = (QEvent.Type.DragEnter, QEvent.Type.DragMove, QEvent.Type.Drop)


def pictures_name(pictures: Pictures) -> str:
    """Short enough for a line."""
    if isinstance(pictures, ViewerPicture):
        return pictures.name
    more = len(pictures) - 1
    return pictures[0].name + (f" and {more} more" if more else "")


def pictures_text(pictures: Pictures) -> str:
    """In full, a line each."""
    if isinstance(pictures, ViewerPicture):
        return pictures.name
    return "\n".join(map(str, pictures))


class PictureDrops(QObject):
    """Takes picture files that are dropped on a widget. Networks are left to its window."""

    def __init__(self, widget: QWidget, taken: Callable[[tuple[Path, ...]], object]) -> None:
        super().__init__(widget)
        self._taken = taken
        widget.setAcceptDrops(True)
        widget.installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Take pictures, as copies."""
        if not isinstance(event, QDropEvent) or event.type() not in _DRAGGING:
            return False
        paths = _dropped(event.mimeData())
        if not paths:
            event.ignore()
            return True
        accept_copy(event)
        if event.type() == QEvent.Type.Drop and event.isAccepted():
            self._taken(paths)
        return True


def _dropped(data: QMimeData) -> tuple[Path, ...]:
    """The picture files that are dragged; none where anything else is among them."""
    paths = tuple(Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile())
    network = any(path.suffix.lower() in JSON.suffixes for path in paths)
    return () if network or len(paths) < len(data.urls()) else paths
