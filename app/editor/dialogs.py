"""Dialogs beside the work, and questions; none stops the window in a loop of its own."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QFileInfo, Qt
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import (
    QDialog,
    QFileDialog,
    QFileIconProvider,
    QMessageBox,
    QPushButton,
    QWidget,
)

from app.editor.widgets import labelled
from nodes.files.file_format import dialog_filter
from nodes.files.formats import PICTURES

ROLE = QMessageBox.ButtonRole


class _Icons(QFileIconProvider):
    """Icons without a look into the files: the window waited for ever on one in /proc."""

    def icon(self, of: QFileInfo | QFileIconProvider.IconType) -> QIcon:
        kinds = QFileIconProvider.IconType
        if isinstance(of, QFileInfo):
            of = kinds.Folder if of.isDir() else kinds.File
        return super().icon(of)

    def type(self, info: QFileInfo) -> str:
        return "Folder" if info.isDir() else f"{info.suffix()} file".lstrip()


class FileDialog(QFileDialog):
    """Asks for files to read; Qt's own dialog, which looks alike on all systems."""

    def __init__(self, parent: QWidget, title: str, folder: str = "", kinds: str = "") -> None:
        super().__init__(parent, title, folder, kinds)
        self.setOption(QFileDialog.Option.DontUseNativeDialog)
        self._icons = _Icons()  # the dialog does not own it
        self.setIconProvider(self._icons)


def show_beside(window: QWidget, dialog: QDialog) -> None:
    drop_dialogs(window, dialog.objectName(), but=dialog)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.setModal(False)  # as a message box begins
    dialog.show()
    dialog.activateWindow()


def drop_dialogs(window: QWidget, name: str, but: QDialog | None = None) -> None:
    for dialog in window.findChildren(QDialog, name):
        if dialog is not but:
            dialog.reject()


def choose_pictures(
    window: QWidget, title: str, *, name: str, chosen: Callable[[tuple[Path, ...]], object]
) -> None:
    """Ask the person for files with pictures or frames; `name` is that of the dialog."""
    formats = [one for one in PICTURES if one.suffixes]
    kinds = ";;".join((dialog_filter("Pictures and frames", *formats), "All files (*)"))
    dialog = labelled(FileDialog(window, title, str(Path.cwd()), kinds), name)
    dialog.setFileMode(QFileDialog.FileMode.ExistingFiles)
    dialog.filesSelected.connect(lambda texts: chosen(tuple(map(Path, texts))))
    show_beside(window, dialog)


class Question(QMessageBox):
    """A question whose answers have names; Esc, or closing it, is to cancel."""

    def __init__(self, parent: QWidget, name: str, title: str) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self.setIcon(QMessageBox.Icon.Question)
        self.setWindowTitle(title)
        self.finished.connect(self.deleteLater)

    def offer(self, answer: str, text: str, role: QMessageBox.ButtonRole) -> QPushButton:
        """Offer an answer with a text of its own; Enter takes the first one. Its button."""
        button = labelled(self.addButton(text, role), answer)
        if len(self.buttons()) == 1:
            self.setDefaultButton(button)
        if role == ROLE.RejectRole:
            self.setEscapeButton(button)
        return button

    @property
    def answer(self) -> str:
        button = self.clickedButton()
        return button.objectName() if button is not None else "cancel"


class SaveDialog(FileDialog):
    """Asks for the name of a file to be written, and whether one that is there is to be replaced.

    Qt's own question would stop the window until it is answered, and swallow the close that the
    window's manager sends meanwhile.
    """

    def __init__(
        self,
        parent: QWidget,
        name: str,
        title: str,
        kinds: str,
        taken: Callable[[Path], object],
        *,
        suffix: str = "png",
        folder: Path | None = None,
    ) -> None:
        super().__init__(parent, title, str((folder or Path.cwd()).absolute()), kinds)
        self.setObjectName(name)
        self.setDefaultSuffix(suffix)
        self.fileSelected.connect(lambda text: taken(Path(text)))
        self.setOption(QFileDialog.Option.DontConfirmOverwrite)
        self.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        self._agreed: str | None = None

    def accept(self) -> None:
        files = self.selectedFiles()
        if files and Path(files[0]).is_file() and files[0] != self._agreed:
            self._ask(files[0])
        else:
            super().accept()

    def done(self, result: int) -> None:
        drop_dialogs(self, "replace_file")
        super().done(result)

    def _ask(self, file: str) -> None:
        box = Question(self, "replace_file", "Replace file?")
        box.setText(f"{Path(file).name} already exists. Replace it?")
        box.offer("cancel", "Cancel", ROLE.RejectRole)
        replace = box.offer("replace", "&Replace", ROLE.AcceptRole)
        replace.clicked.connect(lambda: self._agree(file))
        show_beside(self, box)

    def _agree(self, file: str) -> None:
        self._agreed = file
        self.accept()
