"""The questions before work is lost. Each blocks the window until it is answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMessageBox, QWidget

Answer = Literal["save", "discard", "reload", "overwrite", "save_as", "stop", "cancel"]
_ROLE = QMessageBox.ButtonRole


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
