"""A field for a file name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QFontMetrics, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QFileDialog, QStyle, QStyleOptionFrame, QToolButton, QWidget

from app.editor.declared_text import about, tip
from app.editor.dialogs import FileDialog
from app.editor.panels.fields.field import TypedField
from app.editor.panels.fields.panel_node import PanelNode
from app.editor.panels.fields.type_in import TypeIn
from app.editor.widgets import LEFT, filled, labelled
from core.modules.parameters import Parameter

# A line for a file name: its folder is cut in the middle, the file's own name is always seen.

_DOTS = "…"
_MARGIN = 2  # dots that QLineEdit leaves beside its text


class PathLine(TypeIn):
    """Draws as much of a name as there is room for; while it has the focus, all of it."""

    def shown_text(self) -> str:
        if self.hasFocus():
            return self.text()
        return elided_path(self.text(), self.fontMetrics(), self._room().width())

    def draw_line(self, event: QPaintEvent) -> None:
        text = self.shown_text()
        if text == self.text():
            super().draw_line(event)
            return
        painter, option = QPainter(self), QStyleOptionFrame()
        self.initStyleOption(option)
        style = self.style()
        style.drawPrimitive(QStyle.PrimitiveElement.PE_PanelLineEdit, option, painter, self)
        role = QPalette.ColorRole.Text
        style.drawItemText(
            painter, self._room(), int(LEFT), self.palette(), self.isEnabled(), text, role
        )
        painter.end()

    def _room(self) -> QRect:
        option = QStyleOptionFrame()
        self.initStyleOption(option)
        part = QStyle.SubElement.SE_LineEditContents
        room = self.style().subElementRect(part, option, self).marginsRemoved(self.textMargins())
        return room.adjusted(_MARGIN, 0, -_MARGIN, 0)


def elided_path(path: str, metrics: QFontMetrics, width: int) -> str:
    """A path that fits the width: without the middle of its folder, and only then of its name."""
    if metrics.horizontalAdvance(path) <= width:
        return path
    folder, slash, name = path.rpartition("/")
    end = slash + name
    room = width - metrics.horizontalAdvance(end)
    if room >= metrics.horizontalAdvance(_DOTS):
        return metrics.elidedText(folder, Qt.TextElideMode.ElideMiddle, room) + end
    return metrics.elidedText(name, Qt.TextElideMode.ElideMiddle, width)


class PathField(TypedField):
    """A line, and a button that opens a dialog; the line's tooltip is the whole name."""

    line = PathLine

    def __init__(
        self,
        parameter: Parameter,
        node: PanelNode,
        parent: QWidget | None = None,
        *,
        writes: bool,
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
        whole = "" if value is None else (self._session.folder.absolute() / value).as_posix()
        self.edit.setToolTip(tip(f"{whole}\n{about(self.parameter)}") if whole else "")

    def open_dialog(self) -> None:
        for other in self.findChildren(QFileDialog, "field.dialog"):
            other.reject()
        dialog = labelled(FileDialog(self, self._dialog_title()), "field.dialog")
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

    def _dialog_title(self) -> str:
        verb = "Write file" if self._writes else "Open file"
        return f"{verb}: {self.node.name} · {self.title}"

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
