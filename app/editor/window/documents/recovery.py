"""Work that a crash has left behind."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject

from app.editor.recovery_files import Autosaver, Recovered, recoverable
from app.editor.window.documents.files import Files
from app.editor.window.documents.opening import Opened
from core.errors import ImagechainError
from nodes.library import standard_library


class Recovery(QObject):
    """Finds, opens and throws away what can be recovered."""

    def __init__(self, folder: Path, autosaver: Autosaver, parent: QObject) -> None:
        super().__init__(parent)
        self._folder = folder
        self._autosaver = autosaver

    def unsaved_work(self) -> tuple[Recovered, ...]:
        """Work of windows that are no more."""
        return recoverable(self._folder)

    def open(self, work: object, files: Files) -> None:
        """Open recovered work as unsaved; its file is kept until the window keeps its own."""
        if isinstance(work, Recovered):
            files.after_asking(lambda: self._show(work, files))

    def discard(self, work: object) -> None:
        """Throw it away."""
        if isinstance(work, Recovered):
            work.discard()

    def _show(self, work: Recovered, files: Files) -> None:
        try:
            document = work.document(standard_library())
        except ImagechainError as error:
            files.refuse(f"not recovered: {error}")
            return
        files.show(Opened(document, "recovered: save it to keep it"))
        self._autosaver.write_now(work.discard)
