"""The dialog in which pictures to look at are chosen, beside the work."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QFileDialog, QMainWindow

from nodes.files.common.file_format import dialog_filter
from nodes.files.formats import PICTURES


def choose_pictures(
    window: QMainWindow, title: str, *, name: str, chosen: Callable[[tuple[Path, ...]], object]
) -> None:
    """Ask the person for files with pictures or frames; `name` is that of the dialog."""
    formats = [one for one in PICTURES if one.suffixes]
    kinds = ";;".join((dialog_filter("Pictures and frames", *formats), "All files (*)"))
    dialog = QFileDialog(window, title, str(Path.cwd()), kinds)
    dialog.setObjectName(name)
    dialog.setOption(QFileDialog.Option.DontUseNativeDialog)
    dialog.setFileMode(QFileDialog.FileMode.ExistingFiles)
    dialog.filesSelected.connect(lambda texts: chosen(tuple(map(Path, texts))))
    show_beside(window, dialog)


def show_beside(window: QMainWindow, dialog: QDialog) -> None:
    """Show a dialog beside the work, in the place of another of its name."""
    for other in window.findChildren(QDialog, dialog.objectName()):
        if other is not dialog:
            other.reject()
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.setModal(False)
    dialog.show()
    dialog.activateWindow()
