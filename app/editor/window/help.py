"""Shortcuts, modules' texts, about, and writing what a viewer shows."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from PySide6.QtCore import QByteArray, QEvent, QObject, QProcess, QTimer, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QHideEvent, QTextDocument
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QDialogButtonBox,
    QMessageBox,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import flowing, label_of
from app.editor.dialogs import SaveDialog, show_beside
from app.editor.docks.measure_worker import MeasureWorker
from app.editor.docks.run_queue import python_environment
from app.editor.docks.tradeoff_view import TradeOffView
from app.editor.session import Session
from app.editor.theme import TEXT
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot import plot_export
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.widgets import filled, named
from app.editor.window.actions import Actions
from app.editor.window.shortcut_list import ShortcutList
from app.editor.window.viewer_docks import ViewerDocks
from app.options.command_options import version
from app.run.shipped import command
from core.errors import ImagechainError
from core.modules.declaration import Declaration
from core.names import in_line
from nodes.files.common.file_format import CSV, dialog_filter
from nodes.files.formats import WRITTEN

Exported = ImageViewer | PlotViewer | TradeOffView
_MACROS = "network_files"  # the handbook's page on them
_PICTURES = ";;".join(
    (
        dialog_filter("Pictures", *(one for one in WRITTEN if not one.plain)),
        dialog_filter("Samples", *(one for one in WRITTEN if one.plain), CSV),
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
        self.handbook = HandbookOpening(session, self)

    def shortcuts(self) -> None:
        show_beside(self._window, ShortcutList(self._actions(), self._window))

    def module(self) -> None:
        name = self._session.selection[-1] if self._session.selection else ""
        declared = self._session.declared(name)
        if declared is None:
            self._session.message.emit("advice", "select a node to read what its module does")
        else:
            text = ModuleText(declared, self._window)
            text.more_wanted.connect(self._open_page)
            show_beside(self._window, text)

    def handbook_of(self, name: str) -> None:
        declared = self._session.declared(name)
        if declared is not None:
            self._open_page(declared.key)

    def _open_page(self, key: str) -> None:
        self.handbook.open(key if key in self._session.library else _MACROS)

    def about(self) -> None:
        box = named(QMessageBox(self._window), "message")
        box.setWindowTitle("Imagechain")
        box.setText(
            f"Version {version()}\n\nSimulates electro-optical and infrared sensors as a chain of "
            "transfer functions and noise.\n\nAfter D. C. Tantalo, Modeling the MTF and noise "
            "characteristics of an image chain for a synthetic image generation system, RIT 1996."
        )
        show_beside(self._window, box)

    def export(self) -> None:
        self._export_of(self._viewer())

    def _export_of(self, viewer: Exported) -> None:
        kinds = _PICTURES if isinstance(viewer, ImageViewer) else plot_export.KINDS
        dialog = named(SaveDialog(self._window, "Export", str(Path.cwd()), kinds), "export_dialog")
        dialog.setDefaultSuffix("png")
        dialog.fileSelected.connect(lambda text: self._export_to(viewer, Path(text)))
        show_beside(self._window, dialog)

    def _export_to(self, viewer: Exported, path: Path) -> None:
        try:
            if isinstance(viewer, ImageViewer):
                viewer.save_as(path)
            else:
                viewer.export(path)
        except ImagechainError as error:
            self._session.message.emit("error", f"not exported: {error}")
        else:
            self._session.message.emit("note", f"wrote {path}")

    def _viewer(self) -> Exported:
        """The viewer that has the focus, else the first."""
        focus = QApplication.focusWidget()
        viewers = self._viewers
        others: list[Exported] = [viewers.plot, viewers.tradeoff]
        for viewer in (*others, *viewers.images.values()):
            if focus is not None and viewer.isAncestorOf(focus):
                return viewer
        return viewers.images[1]


# Opening a page of the handbook in the browser; its pages are made where there are none yet.

_PATIENCE_MS = 2_500  # pages that are there already take less
_CLOSING_MS = 3_000


class HandbookOpening(QObject):
    """Has a process of its own find a page, and write the pages first if need be."""

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._process = QProcess(self)
        self._process.finished.connect(self._finished)
        self._process.errorOccurred.connect(self._failed_to_start)
        self._long = QTimer(self)
        self._long.setSingleShot(True)
        self._long.timeout.connect(self._say_that_it_takes_long)
        self._closed = False

    def open(self, word: str = "") -> None:
        """Open the page of a module, or the first; at once the one that was wanted last."""
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._session.message.emit("note", "opening the handbook")
            return
        self._process.setProcessEnvironment(python_environment())
        program, *words = command("app.command.cli", "handbook", "--path", *filter(None, [word]))
        self._process.start(program, words)
        self._long.start(_PATIENCE_MS)

    def close(self) -> None:
        self._closed = True
        self._long.stop()
        if self._process.state() != QProcess.ProcessState.NotRunning:
            self._process.terminate()
            if not self._process.waitForFinished(_CLOSING_MS):
                self._process.kill()
                self._process.waitForFinished(_CLOSING_MS)

    def _say_that_it_takes_long(self) -> None:
        self._session.message.emit("note", "preparing the handbook's pages, once")

    def _finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._long.stop()
        printed = bytes(self._process.readAllStandardOutput().data()).decode().strip()
        errors = bytes(self._process.readAllStandardError().data()).decode("utf-8", "replace")
        if self._closed:
            return
        if code or status == QProcess.ExitStatus.CrashExit or not printed:
            reason = (
                in_line(errors.strip().removeprefix("imagechain: ")).partition("; --")[0]
                or "its process was stopped"
            )
            self._session.message.emit("error", f"the handbook is not opened: {reason}")
        elif QDesktopServices.openUrl(QUrl.fromLocalFile(str(Path(printed)))):
            self._session.message.emit("note", f"the handbook is in the browser: {printed}")
        else:
            self._session.message.emit("error", f"no browser opens {printed}")

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._long.stop()
            reason = self._process.errorString()
            self._session.message.emit("error", f"Python cannot be started: {reason}")


# The text of a module, to be read at leisure.

_WIDE, _HIGH = 120, 36  # letters, lines
_IMAGE = int(QTextDocument.ResourceType.ImageResource.value)


class ModuleText(QDialog):
    """A window with a module's text, typeset formulas, and its parameters in a table."""

    more_wanted = Signal(str)  # (key): the module's page in the handbook is to be opened

    def __init__(self, declared: Declaration, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("module_help")
        self.setWindowTitle(declared.title)
        self.text = QTextBrowser(self)
        self.text.setPlainText(flowing(declared.text))  # until the formulas are typeset
        self.text.setOpenLinks(False)
        named(self.text, "module_help.text", f"What {declared.title} does")
        self.text.setTabChangesFocus(True)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        self.more = buttons.addButton(
            "More in the &Handbook", QDialogButtonBox.ButtonRole.ActionRole
        )
        self.more.setObjectName("module_help.more")
        self.more.setToolTip("Curves and an example, in the browser (F1)")
        self.more.setShortcut("F1")
        self.more.clicked.connect(lambda *_: self.more_wanted.emit(declared.key))
        buttons.rejected.connect(self.reject)
        filled(QVBoxLayout(self), self.text, buttons, margins=None)
        metrics = self.fontMetrics()
        self.resize(metrics.averageCharWidth() * _WIDE, metrics.height() * _HIGH)
        self._declared = declared
        self._typesetting = MeasureWorker(self)
        self._typesetting.done.connect(self._show)
        self._typeset()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_typesetting"):
            self._typeset()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._typesetting.drop()

    def _typeset(self) -> None:
        ink, em = self.palette().color(TEXT).name(), float(self.fontMetrics().height())
        self._typesetting.start(
            # Imported where it is used: typesetting takes a second to load.
            lambda _check, _report: import_module("app.handbook.module_help").module_help(
                self._declared, label=label_of, em=em, ink=ink
            )
        )

    def _show(self, made: Any) -> None:
        for address, svg in made.drawings.items():
            self.text.document().addResource(_IMAGE, QUrl(address), QByteArray(svg))
        self.text.setHtml(made.text)
