"""A field for a file name."""

from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog, QToolButton, QWidget

from app.editor.declared_text import about, tip
from app.editor.messages import FileDialog
from app.editor.panels.fields.field import PanelNode, TypedField
from app.editor.widgets import filled, labelled
from core.modules.parameters import Parameter


class PathField(TypedField):
    """A line, and a button that opens a dialog; the line's tooltip is the whole name."""

    def __init__(
        self, parameter: Parameter, node: PanelNode, parent: QWidget | None = None, *, writes: bool
    ) -> None:
        self._session = node.session
        self._writes = writes
        super().__init__(parameter, node, parent)

    def build(self) -> None:
        edit = self.build_edit()
        edit.setPlaceholderText("no file")
        self.browse = QToolButton(self)
        self.browse.setText("Browse…")
        self.browse.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.named(self.browse, ": browse", "browse")
        self.browse.clicked.connect(self.open_dialog)
        filled(self.row, self.label, (edit, 1), self.browse)
        self.unit.hide()

    def show_value(self, value: Any) -> None:
        self.edit.show_text("" if value is None else Path(value).as_posix())
        self.edit.end(False)  # the file's own name is seen, however long its folder
        whole = "" if value is None else (self._session.folder.absolute() / value).as_posix()
        self.edit.setToolTip(tip(f"{whole}\n{about(self.parameter)}") if whole else "")

    def open_dialog(self) -> None:
        for other in self.findChildren(QFileDialog, "field.dialog"):
            other.reject()
        title = f"{'Write' if self._writes else 'Open'} file: {self.node.name} · {self.title}"
        dialog = labelled(FileDialog(self, title), "field.dialog")
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.setOption(QFileDialog.Option.DontConfirmOverwrite)  # nothing is written by choosing
        if self._writes:
            dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
            dialog.setFileMode(QFileDialog.FileMode.AnyFile)
        else:
            dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        folder = self._session.folder.absolute()
        if self.value is not None:
            folder = (folder / self.value).parent
        dialog.setDirectory(str(folder))
        dialog.fileSelected.connect(self._chosen)
        dialog.show()  # what is modal would keep the window from closing
        dialog.activateWindow()

    def _chosen(self, name: str) -> None:
        if name:
            if self._writes:
                self._session.choose_output(Path(name))
            self.offer(self.relative(Path(name)))

    def relative(self, path: Path) -> str:
        """The name from the network's folder where the file lies below it, else all of it."""
        if self._session.document.path is not None:
            folder = self._session.folder.resolve()
            if path.resolve().is_relative_to(folder):
                return path.resolve().relative_to(folder).as_posix()
        return path.as_posix()
