"""A dialog for the name of a file to be written, with a question before one is replaced."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

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
