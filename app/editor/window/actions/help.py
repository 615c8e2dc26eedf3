"""Shortcuts, modules' texts, about, and writing what a viewer shows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QApplication, QDialog, QMessageBox, QWidget

from app.editor.session import Session
from app.editor.tradeoff.tradeoff_view import TradeOffView
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot import plot_export
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.window.actions.handbook_opening import HandbookOpening
from app.editor.window.actions.menu_actions import Actions
from app.editor.window.actions.module_text import ModuleText
from app.editor.window.actions.shortcut_list import ShortcutList
from app.editor.window.docks.viewer_docks import ViewerDocks
from app.editor.window.documents.save_dialog import SaveDialog
from app.options.command_options import version
from core.errors import ImagechainError
from nodes.files.common.file_format import CSV, dialog_filter
from nodes.files.formats import WRITTEN

Exported = ImageViewer | PlotViewer | TradeOffView
_MACROS = "network_files"  # the handbook's page on them
_PICTURES = ";;".join(
    (
        dialog_filter(
            "Pictures", *(file_format for file_format in WRITTEN if not file_format.plain)
        ),
        dialog_filter(
            "Samples", *(file_format for file_format in WRITTEN if file_format.plain), CSV
        ),
    )
)
_CURVES = ";;".join(
    (
        dialog_filter("Pictures", *plot_export.PICTURES),
        dialog_filter("Numbers", *plot_export.NUMBERS),
    )
)


class Help(QObject):
    """What the Help menu shows, and Export."""

    def __init__(
        self,
        session: Session,
        viewers: ViewerDocks,
        actions: Callable[[], Actions],
        window: QWidget,
    ) -> None:
        super().__init__(window)
        self._session = session
        self._viewers = viewers
        self._actions = actions
        self._window = window
        self._exported: Exported | None = None
        self.handbook = HandbookOpening(session, self)
        viewers.tradeoff.export_wanted.connect(self._export_trade_off)

    def shortcuts(self) -> None:
        """List every shortcut."""
        self._show(ShortcutList(self._actions(), self._window))

    def module(self) -> None:
        """Show what the selected node's module does."""
        name = self._session.selection[-1] if self._session.selection else ""
        declared = self._session.declared(name)
        if declared is None:
            self._session.message.emit("advice", "select a node to read what its module does")
        else:
            text = ModuleText(declared, self._window)
            text.more_wanted.connect(self._open_page)
            self._show(text)

    def handbook_of(self, name: str) -> None:
        """Open the handbook at the page of a node's module."""
        declared = self._session.declared(name)
        if declared is not None:
            self._open_page(declared.key)

    def _open_page(self, key: str) -> None:
        self.handbook.open(key if key in self._session.library else _MACROS)

    def about(self) -> None:
        """Version and sources."""
        self._message(
            "Imagechain",
            f"Version {version()}\n\nSimulates electro-optical and infrared sensors as a chain of "
            "transfer functions and noise.\n\nAfter D. C. Tantalo, Modeling the MTF and noise "
            "characteristics of an image chain for a synthetic image generation system, RIT 1996.",
        )

    def export(self) -> None:
        """Ask the person where to write what the viewer used last shows."""
        self.export_of(self._viewer())

    def export_of(self, viewer: Exported) -> None:
        """Ask the person where to write what it shows."""
        self._exported = viewer
        kinds = _PICTURES if isinstance(viewer, ImageViewer) else _CURVES
        dialog = SaveDialog(self._window, "Export", str(Path.cwd()), kinds)
        dialog.setObjectName("export_dialog")
        dialog.setDefaultSuffix("png")
        dialog.fileSelected.connect(self._export_to)
        self._show(dialog)

    def _export_trade_off(self) -> None:
        self.export_of(self._viewers.tradeoff)

    def _export_to(self, text: str) -> None:
        viewer = self._exported or self._viewer()  # the dialog has had the focus meanwhile
        try:
            if isinstance(viewer, ImageViewer):
                viewer.save_as(Path(text))
            else:
                viewer.export(Path(text))
        except ImagechainError as error:
            self._session.message.emit("error", f"not exported: {error}")
        else:
            self._session.message.emit("note", f"wrote {text}")

    def _viewer(self) -> Exported:
        """The viewer that has the focus, else the first."""
        focus = QApplication.focusWidget()
        viewers = self._viewers
        others: list[Exported] = [viewers.plot, viewers.tradeoff]
        for viewer in (*others, *viewers.images.values()):
            if focus is not None and viewer.isAncestorOf(focus):
                return viewer
        return viewers.images[1]

    def _message(self, title: str, text: str) -> None:
        box = QMessageBox(self._window)
        box.setObjectName("message")
        box.setWindowTitle(title)
        box.setText(text)
        self._show(box)

    def _show(self, dialog: QDialog) -> None:
        """Show it beside the work, in the place of another of its kind."""
        for other in self._window.findChildren(QDialog, dialog.objectName()):
            if other is not dialog:
                other.reject()
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.setModal(False)  # as a message box begins
        dialog.show()
        dialog.activateWindow()
