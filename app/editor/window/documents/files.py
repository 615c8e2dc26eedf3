"""New, open, save and close: nothing is lost without a question to the person."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from app.editor.session import Session
from app.editor.window.documents.opening import NETWORK_SUFFIX, Opened, open_named
from app.editor.window.documents.recent_files import Settings
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


# A dialog for the name of a file to be written, with a question before one is replaced.

_ROLE = QMessageBox.ButtonRole


class SaveDialog(QFileDialog):
    """Asks the person, without blocking, whether an existing file is to be replaced.

    Qt's own question would stop the window until it is answered, and swallow the close that the
    window's manager sends meanwhile.
    """

    def __init__(self, parent: QWidget, title: str, folder: str, kinds: str) -> None:
        super().__init__(parent, title, folder, kinds)
        self.setOption(QFileDialog.Option.DontUseNativeDialog)
        self.setOption(QFileDialog.Option.DontConfirmOverwrite)
        self.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        self._agreed: str | None = None
        self._question: QMessageBox | None = None

    def accept(self) -> None:
        """Take the name, unless a file of that name is there and the person has not agreed."""
        files = self.selectedFiles()
        if files and Path(files[0]).is_file() and files[0] != self._agreed:
            self._ask(files[0])
        else:
            super().accept()

    def done(self, result: int) -> None:
        """Take the question away with the dialog."""
        self._drop_question()
        super().done(result)

    def _ask(self, file: str) -> None:
        self._drop_question()
        box = QMessageBox(self)
        box.setObjectName("replace_file")
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("Replace file?")
        box.setText(f"{Path(file).name} is there already. Replace it?")
        replace = box.addButton("&Replace", _ROLE.AcceptRole)
        replace.setObjectName("replace")
        cancel = box.addButton("Cancel", _ROLE.RejectRole)
        cancel.setObjectName("cancel")
        box.setDefaultButton(cancel)
        box.setEscapeButton(cancel)
        replace.clicked.connect(lambda: self._agree(file))
        box.finished.connect(self._forget_question)  # before it is deleted
        box.finished.connect(box.deleteLater)
        self._question = box
        box.setModal(False)
        box.show()
        box.activateWindow()

    def _agree(self, file: str) -> None:
        self._agreed = file
        self.accept()

    def _forget_question(self) -> None:
        self._question = None

    def _drop_question(self) -> None:
        box, self._question = self._question, None
        if box is not None:
            box.hide()
            box.deleteLater()


# The questions before work is lost. Each blocks the window until it is answered.

Answer = Literal["save", "discard", "reload", "overwrite", "save_as", "stop", "cancel"]


class Question(QMessageBox):
    """A question whose answers have names; Esc, or closing it, is to cancel."""

    def __init__(self, parent: QWidget, name: str, title: str) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self.setIcon(QMessageBox.Icon.Question)
        self.setWindowTitle(title)
        self.finished.connect(self.deleteLater)

    def offer(self, answer: Answer, text: str, role: QMessageBox.ButtonRole) -> None:
        """Offer an answer with a text of its own; Enter takes the first one."""
        button = self.addButton(text, role)
        button.setObjectName(answer)
        if len(self.buttons()) == 1:
            self.setDefaultButton(button)
        if role == _ROLE.RejectRole:
            self.setEscapeButton(button)

    @property
    def answer(self) -> Answer:
        """What was answered."""
        button = self.clickedButton()
        names: dict[str, Answer] = {
            "save": "save",
            "discard": "discard",
            "reload": "reload",
            "overwrite": "overwrite",
            "save_as": "save_as",
            "stop": "stop",
        }
        return names.get(button.objectName(), "cancel") if button is not None else "cancel"


def save_changes(parent: QWidget, network: str) -> Question:
    """What is to become of unsaved work."""
    box = Question(parent, "save_changes", "Save changes?")
    box.setText(f"Save the changes of {network or 'this network'}?")
    box.setInformativeText("Without saving they are lost.")
    for answer, text, standard in (
        ("save", "&Save", QMessageBox.StandardButton.Save),
        ("discard", "&Discard", QMessageBox.StandardButton.Discard),
        ("cancel", "Cancel", QMessageBox.StandardButton.Cancel),
    ):
        button = box.addButton(standard)
        button.setObjectName(answer)
        button.setText(text)  # with a key to each on every desktop
    box.setDefaultButton(QMessageBox.StandardButton.Save)
    return box


def changed_file(parent: QWidget, file: str, done: str) -> Question:
    """What is to become of a file that was changed or removed by another program."""
    box = Question(parent, "changed_file", "Save over it?")
    box.setText(f"{file} has been {done} by another program since it was opened or saved here.")
    box.offer("save_as", "Save &As…", _ROLE.AcceptRole)
    if done == "removed":
        box.setInformativeText("Overwrite makes it anew.")
    else:
        consequence = "Overwrite loses what was changed there; Reload loses the changes made here."
        box.setInformativeText(consequence)
        box.offer("reload", "&Reload", _ROLE.DestructiveRole)
    box.offer("overwrite", "&Overwrite", _ROLE.DestructiveRole)
    box.offer("cancel", "Cancel", _ROLE.RejectRole)
    return box


def runs_go_on(parent: QWidget, runs: Sequence[str]) -> Question:
    """Whether runs in the background are to end with the window."""
    box = Question(parent, "runs_go_on", "Stop the runs?")
    number = f"{len(runs)} runs are" if len(runs) > 1 else "A run is"
    box.setText(f"{number} not done yet: {runs[0]}{' …' if len(runs) > 1 else ''}")
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setInformativeText("Quitting stops them; what they have not written yet is lost.")
    box.offer("cancel", "&Keep Running", _ROLE.RejectRole)
    box.offer("stop", "&Stop and Quit", _ROLE.DestructiveRole)
    return box
