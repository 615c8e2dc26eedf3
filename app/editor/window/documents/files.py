"""New, open, save and close: nothing is lost without a question to the person."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.editor.session import Session
from app.editor.window.documents.opening import NETWORK_SUFFIX, Opened, open_named
from app.editor.window.documents.questions import Question, changed_file, save_changes
from app.editor.window.documents.remembered_settings import Settings
from app.editor.window.documents.save_dialog import SaveDialog
from core.editing.document import Document, rebased
from core.errors import ImagechainError
from core.network.network import Network

_FILTER = f"Networks (*{NETWORK_SUFFIX});;All files (*)"
Next = Callable[[], object]


class Files(QObject):
    """The document's way from and to files.

    Dialogs open without stopping the window; what is to follow a question is a function that is
    called once it is answered. Only questions block the window: Qt keeps a close that its manager
    sends from a window that is blocked.

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
        self._question: Question | None = None
        self._dialog: QFileDialog | None = None

    def new(self, following: Next | None = None) -> None:
        """Begin an empty network, after the question about unsaved work; then go on."""
        self.after_asking(lambda: self._new(following))

    def open_dialog(self) -> None:
        """Ask the person for a file and open it."""
        dialog = self._in_place_of_other(QFileDialog(*self._words("Open a network")))
        dialog.setOption(QFileDialog.Option.DontUseNativeDialog)
        dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        dialog.fileSelected.connect(self.open)
        dialog.show()
        dialog.activateWindow()

    def open(self, text: str) -> None:
        """Open a network by path or shipped name, after the question about unsaved work."""
        self.after_asking(lambda: self.open_now(text))

    def open_now(self, text: str) -> bool:
        """Open a network in place of the present one; whether that worked."""
        try:
            opened = open_named(text, library=self._session.library)
        except ImagechainError as error:
            self._session.message.emit("error", f"not opened: {error}")
            return False
        self.show(opened)
        return True

    def show(self, opened: Opened) -> None:
        """Put an opened document in the window."""
        self._drop_dialog()  # it names a file for the document that is closed
        if opened.document.path is not None:
            self._settings.add_recent(opened.document.path)
        self._session.open(opened.document)
        self.opened.emit()
        if opened.remark:
            self._session.message.emit("note", opened.remark)

    def refuse(self, text: str) -> None:
        """Show why something was not done."""
        self._session.message.emit("error", text)

    def save(self, following: Next | None = None) -> None:
        """Save to the document's file, or one the person chooses; then go on, if it was saved."""
        self.about_to_save.emit()
        path = self._session.document.path
        if path is None:
            self.save_as(following)
        else:
            self.save_to(path, following)

    def save_as(self, following: Next | None = None) -> None:
        """Let the person choose a file and save to it; then go on, if it was saved."""
        self.about_to_save.emit()
        dialog = self._in_place_of_other(SaveDialog(*self._words("Save the network")))
        dialog.setDefaultSuffix(NETWORK_SUFFIX.removeprefix("."))
        dialog.selectFile(self._proposal())
        dialog.fileSelected.connect(lambda text: self.save_to(Path(text), following))
        dialog.show()
        dialog.activateWindow()

    def save_to(self, path: Path, following: Next | None = None, *, over: bool = False) -> None:
        """Save, then go on; file names in the network keep pointing at the same files.

        Another program's changes to the document's own file are written over only with `over`;
        else the person is asked first.
        """
        document = self._session.document
        if not over and document.is_own(path) and (done := document.disagreement()):
            self._next = following
            self._ask(changed_file(self._window, path.name, done))
            return
        moved = rebased(
            document.network,
            self._session.library,
            document.folder.absolute(),
            path.absolute().parent,
        )
        if moved is not None:
            self._session.do(moved)
        if not self._session.save(path, over=over):
            if moved is not None:
                self._session.undo()
            return
        self._settings.add_recent(path)
        self._session.message.emit("note", f"saved {path}")
        if following is not None:
            following()

    def has_unsaved_work(self) -> bool:
        """Whether there is work that no file holds, what is being typed included."""
        self.about_to_save.emit()
        return self._session.document.modified

    def after_asking(self, following: Next) -> None:
        """Go on with `following`; where there is unsaved work, only once that is answered."""
        if self.has_unsaved_work():
            self.ask_to_save(following)
        else:
            following()

    def ask_to_save(self, following: Next) -> None:
        """Ask the person about unsaved work, then go on. Of two calls the later one goes on."""
        self._next = following
        if self._question is None:
            self._ask(save_changes(self._window, self._session.network.name))
        else:
            self._question.raise_()
            self._question.activateWindow()

    def _ask(self, question: Question) -> None:
        self._question = question
        question.finished.connect(self._answered)
        question.open()

    def _answered(self) -> None:
        question, self._question = self._question, None
        following, self._next = self._next, None
        answer = question.answer if question is not None else "cancel"
        path = self._session.document.path
        if answer == "save":
            self.save(following)
        elif answer == "save_as":
            self.save_as(following)
        elif answer == "discard" and following is not None:
            following()
        elif answer == "overwrite" and path is not None:
            self.save_to(path, following, over=True)
        elif answer == "reload" and path is not None:
            self.open_now(str(path))

    def _new(self, following: Next | None) -> None:
        library = self._session.library
        self.show(Opened(Document(Network(), library=library)))
        if following is not None:
            following()

    def _proposal(self) -> str:
        path = self._session.document.path
        if path is not None:
            return str(path)
        name = self._session.network.name or "network"
        stem = "".join(c if c.isalnum() or c in "-_" else "_" for c in name.lower())
        return f"{stem}{NETWORK_SUFFIX}"

    def _words(self, title: str) -> tuple[QWidget, str, str, str]:
        path = self._session.document.path
        return self._window, title, str(path.parent if path else Path.cwd()), _FILTER

    def _in_place_of_other(self, dialog: QFileDialog) -> QFileDialog:
        """The dialog, to be filled and shown; the one that is open is closed."""
        self._drop_dialog()
        dialog.setObjectName("file_dialog")
        dialog.finished.connect(lambda: self._forget(dialog))
        dialog.finished.connect(dialog.deleteLater)
        self._dialog = dialog
        return dialog

    def _drop_dialog(self) -> None:
        if self._dialog is not None:
            self._dialog.reject()

    def _forget(self, dialog: QFileDialog) -> None:
        if self._dialog is dialog:
            self._dialog = None
