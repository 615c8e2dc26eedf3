"""New, open, save and close: nothing is lost without being asked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from app.editor.session import Session
from app.editor.window.opening import Opened, open_named
from app.editor.window.settings import Settings
from core.editing.document import Document
from core.editing.moved_folder import rebased
from core.errors import ImagechainError
from core.network import Network

_FILTER = "Networks (*.json);;All files (*)"
_BUTTON = QMessageBox.StandardButton
Next = Callable[[], object]


class Files(QObject):
    """The document's way from and to files.

    Dialogs open without stopping the window; what is to follow a question is a function that is
    called once it is answered.

    Signals
    -------
    opened
        Another document is in the window.
    about_to_save
        What has been typed but not yet entered is to be taken now.
    """

    opened = Signal()
    about_to_save = Signal()

    def __init__(self, session: Session, settings: Settings, window: QWidget) -> None:
        super().__init__(window)
        self._session = session
        self._settings = settings
        self._window = window
        self._next: Next | None = None

    def new(self) -> None:
        """Begin an empty network, after asking for unsaved work."""
        self.after_asking(self._new)

    def open_dialog(self) -> None:
        """Ask for a file and open it."""
        dialog = self._dialog("Open a network", QFileDialog.AcceptMode.AcceptOpen)
        dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        dialog.fileSelected.connect(self.open)
        dialog.open()

    def open(self, text: str) -> None:
        """Open a network by path or shipped name, after asking for unsaved work."""
        self.after_asking(lambda: self.open_now(text))

    def open_now(self, text: str) -> bool:
        """Open a network in place of the present one; whether that worked."""
        try:
            found = open_named(text, library=self._session.library)
        except ImagechainError as error:
            self._session.told.emit("error", f"not opened: {error}")
            return False
        self.show(found)
        return True

    def show(self, found: Opened) -> None:
        """Put an opened document in the window."""
        if found.document.path is not None:
            self._settings.add_recent(found.document.path)
        self._session.open(found.document)
        self.opened.emit()
        if found.remark:
            self._session.told.emit("note", found.remark)

    def refuse(self, text: str) -> None:
        """Say why something was not done."""
        self._session.told.emit("error", text)

    def save(self, following: Next | None = None) -> None:
        """Save to the document's file, or ask for one; then go on, if it was saved."""
        self.about_to_save.emit()
        if self._session.document.path is None:
            self.save_as(following)
        elif self._save_to(self._session.document.path) and following is not None:
            following()

    def save_as(self, following: Next | None = None) -> None:
        """Ask for a file and save to it; then go on, if it was saved."""
        self.about_to_save.emit()
        dialog = self._dialog("Save the network", QFileDialog.AcceptMode.AcceptSave)
        dialog.setDefaultSuffix("json")
        dialog.selectFile(self._proposal())
        self._next = following
        dialog.fileSelected.connect(self._chosen)
        dialog.open()

    def after_asking(self, following: Next) -> None:
        """Go on with `following`; where there is unsaved work, only once that is answered."""
        self.about_to_save.emit()
        if not self._session.document.modified:
            following()
            return
        box = QMessageBox(self._window)
        box.setObjectName("save_changes")
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("Save changes?")
        box.setText(f"Save the changes of {self._session.network.name or 'this network'}?")
        box.setInformativeText("Without saving they are lost.")
        box.setStandardButtons(_BUTTON.Save | _BUTTON.Discard | _BUTTON.Cancel)
        box.setDefaultButton(_BUTTON.Save)
        self._next = following
        box.finished.connect(self._answered)
        box.open()

    def _answered(self, answer: int) -> None:
        following, self._next = self._next, None
        if following is None:
            return
        if answer == _BUTTON.Save.value:
            self.save(following)
        elif answer == _BUTTON.Discard.value:
            following()

    def _chosen(self, text: str) -> None:
        following, self._next = self._next, None
        if self._save_to(Path(text)) and following is not None:
            following()

    def _save_to(self, path: Path) -> bool:
        """Save; file names in the network keep pointing at the same files."""
        document = self._session.document
        moved = rebased(
            document.network,
            self._session.library,
            document.folder.absolute(),
            path.absolute().parent,
        )
        if moved is not None:
            self._session.do(moved)
        if not self._session.save(path):
            if moved is not None:
                self._session.undo()
            return False
        self._settings.add_recent(path)
        self._session.told.emit("note", f"saved {path}")
        return True

    def _new(self) -> None:
        library = self._session.library
        self.show(Opened(Document(Network(), library=library)))

    def _proposal(self) -> str:
        path = self._session.document.path
        if path is not None:
            return str(path)
        name = self._session.network.name or "network"
        kept = "".join(c if c.isalnum() or c in "-_" else "_" for c in name.lower())
        return f"{kept}.json"

    def _dialog(self, title: str, mode: QFileDialog.AcceptMode) -> QFileDialog:
        path = self._session.document.path
        dialog = QFileDialog(self._window, title, str(path.parent if path else Path.cwd()), _FILTER)
        dialog.setObjectName("file_dialog")
        dialog.setOption(QFileDialog.Option.DontUseNativeDialog)
        dialog.setAcceptMode(mode)
        dialog.finished.connect(dialog.deleteLater)
        return dialog
