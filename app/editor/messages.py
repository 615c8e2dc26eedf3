"""Messages and questions; none stops the window in a loop of its own."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, Literal, get_args

from PySide6.QtCore import QEvent, QFileInfo, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import (
    QDialog,
    QFileDialog,
    QFileIconProvider,
    QHBoxLayout,
    QLabel,
    QMenuBar,
    QMessageBox,
    QProgressBar,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.editor.theme import CHANGED, ERROR, FAINT
from app.editor.widgets import ElidedLabel, filled, labelled, plain_label, tool_button
from core.errors import ImagechainError
from nodes.files.file_format import dialog_filter
from nodes.files.formats import PICTURES

Severity = Literal["information", "warning", "error"]
ROLES = {"information": FAINT, "warning": CHANGED, "error": ERROR}
_GRAVEST_FIRST = tuple(reversed(get_args(Severity)))
_MOST = 2  # notices in sight

_SIGNS = {"information": "●", "warning": "▲", "error": "■"}  # told apart without colours


@contextmanager
def told(report: Callable[[str, str], object], before: str = "") -> Iterator[None]:
    """Report an error of what is done inside, after these words, and go on behind it."""
    try:
        yield
    except ImagechainError as error:
        report("error", f"{before}{error}")


def sentence(line: str) -> str:
    """A remark, which begins small and ends without a stop."""
    return f"{line[:1].upper()}{line[1:]}."


class Mark(QLabel):
    severity: Severity = "information"

    def show_severity(self, severity: Severity) -> None:
        self.severity = severity
        self.setText(_SIGNS[severity])
        self.setForegroundRole(ROLES[severity])
        self.setAccessibleName(severity)


def close_button(name: str, parent: QWidget) -> QToolButton:
    """A cross that closes a message, no higher than a line of text."""
    button = tool_button(name, "×", "Close this message", parent)
    button.setAutoRaise(True)
    button.setMaximumHeight(parent.fontMetrics().height() + 2)
    return button


class Notice(QWidget):
    """A mark, a text in its colour, elided if `one_line`, and a button; hidden without a text."""

    closed = Signal()  # the person has closed it

    def __init__(self, name: str, parent: QWidget, *, one_line: bool = False) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self.text = ""
        self.mark = Mark(self)
        self.label: QLabel = (
            ElidedLabel(f"{name}.text", "Message", self)
            if one_line
            else plain_label(f"{name}.text", self)
        )
        self.away = close_button(f"{name}.close", self)
        self.away.clicked.connect(self._close)
        row = filled(QHBoxLayout(self), spacing=5)
        top = Qt.AlignmentFlag.AlignVCenter if one_line else Qt.AlignmentFlag.AlignTop
        row.addWidget(self.mark, 0, top)
        row.addWidget(self.label, 1)
        row.addWidget(self.away, 0, top)
        self.hide()

    def show_text(self, text: str, severity: Severity = "information") -> None:
        self.text = text
        self.mark.show_severity(severity)
        self.label.setForegroundRole(ROLES[severity])
        if isinstance(self.label, ElidedLabel):
            self.label.show_text(text)
        else:
            self.label.setText(text)
        self.setVisible(bool(text))

    def _close(self) -> None:
        self.show_text("", self.mark.severity)
        self.closed.emit()


class NoticeList(QWidget):
    """Notices below one another, the gravest first; of many, the others by a button."""

    def __init__(self, name: str, words: str, parent: QWidget) -> None:
        super().__init__(parent)
        labelled(self, name, words)
        self.left: list[tuple[Severity, str]] = []  # those that have not been closed
        self._notices: list[Notice] = []
        self.more = tool_button(
            f"{name}.more", "", "Show all messages, or only the most serious", self
        )
        self.more.setCheckable(True)
        self.more.toggled.connect(self._show)
        self._rows = filled(QVBoxLayout(self), self.more, margins=(6, 2, 6, 2), spacing=2)
        self.hide()

    def show_notices(self, said: Iterable[tuple[Severity, str]]) -> None:
        """Show these in place of those before, the ones that were closed among them."""
        self.left = sorted(said, key=lambda one: _GRAVEST_FIRST.index(one[0]))
        for row in range(len(self._notices), len(self.left)):
            notice = Notice(f"{self.objectName()}.{row}", self)
            notice.closed.connect(partial(self._close, row))
            self._notices.append(notice)
            self._rows.insertWidget(row, notice)
        self._show()

    def _show(self, *_: object) -> None:
        shown = self.left if self.more.isChecked() else self.left[:_MOST]
        for row, notice in enumerate(self._notices):
            severity, text = shown[row] if row < len(shown) else ("information", "")
            notice.show_text(text, severity)
        more = len(self.left) - _MOST
        self.more.setText("Fewer" if self.more.isChecked() else f"{more} More")
        self.more.setVisible(more > 0)
        self.setVisible(bool(self.left))

    def _close(self, row: int) -> None:
        self.show_notices([*self.left[:row], *self.left[row + 1 :]])


NOTE_MS = 8000
_BEHIND = "stopped: showing the earlier result; press Ctrl+Enter to compute again"


class StatusBar(QWidget):
    """Shows notes for a while, errors until they no longer hold, warnings until closed."""

    cancel_wanted = Signal()  # stop the computation

    def __init__(self, menus: QMenuBar) -> None:
        super().__init__(menus)
        self._menus = menus
        menus.setNativeMenuBar(False)  # a desktop's own bar of menus has no place for messages
        menus.installEventFilter(self)
        self._said: list[tuple[Severity, str]] = []  # the latest at the end
        self._notice = Notice("status.message", self, one_line=True)
        self._notice.closed.connect(self._close)
        self._behind = Notice("status.behind", self, one_line=True)
        self._where = QLabel(self)
        bar = QProgressBar(self, textVisible=False)
        self._progress = labelled(bar, "status.progress", "Progress of the computation")
        self._progress.setFixedWidth(self.fontMetrics().averageCharWidth() * 14)
        about = "Stop the computation (Esc)"
        self._cancel = labelled(QPushButton("Cancel", self, toolTip=about), "status.cancel")
        self._cancel.clicked.connect(self.cancel_wanted)
        self._over = QTimer(self, singleShot=True, interval=NOTE_MS)
        self._over.timeout.connect(lambda: self._drop("information"))
        parts = (self._notice, self._behind, self._where, self._progress, self._cancel)
        filled(QHBoxLayout(self), None, *parts, margins=(8, 0, 4, 0))
        self.show_busy(None)

    def said(self, severity: Severity) -> str:
        return dict(self._said).get(severity, "")

    def report(self, kind: str, text: str) -> None:
        """Show a "note", "warning" or "error"; an empty one takes the last of its kind away."""
        severity: Severity = kind if kind in ("error", "warning") else "information"  # type: ignore[assignment]
        if not text:
            self._drop(severity)
            return
        self._drop("information", severity if severity == "warning" else "error")
        self._said.append((severity, text))
        if severity == "information":
            self._over.start()
        self._show()

    def forget(self, *, closed: bool = False) -> None:
        """Clear what was about the network as it was; warnings too where it is closed."""
        self._drop("information", "error", *(["warning"] if closed else []))

    def show_busy(self, busy: Any) -> None:
        for widget in (self._where, self._progress, self._cancel):
            widget.setVisible(busy is not None)
        if busy is not None:
            self._where.setText(f"{busy.node or 'computing'} · {busy.seconds:.1f} s")
            self._progress.setRange(0, max(busy.wanted, 1))
            self._progress.setValue(busy.done)

    def show_behind(self, behind: bool) -> None:
        self._behind.show_text(_BEHIND if behind else "", "warning")

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep to the room that the menus leave."""
        if watched is self._menus and event.type() in (
            QEvent.Type.Resize, QEvent.Type.ActionAdded, QEvent.Type.Show, QEvent.Type.FontChange,
        ):  # fmt: skip
            QTimer.singleShot(0, self, self._place)
        return False

    def _place(self) -> None:
        actions = self._menus.actions()
        left = self._menus.actionGeometry(actions[-1]).right() + 1 if actions else 0
        self.setGeometry(left, 0, max(0, self._menus.width() - left), self._menus.height())

    def _drop(self, *severities: str) -> None:
        kept = [one for one in self._said if one[0] not in severities]
        if kept != self._said:  # not so with nearly every edit
            self._said = kept
            self._show()

    def _show(self) -> None:
        severity, text = self._said[-1] if self._said else ("information", "")
        self._notice.show_text(text, severity)

    def _close(self) -> None:
        """The message that is seen is closed; the one below it comes into sight."""
        self._drop(self._notice.mark.severity)


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

    def __init__(self, parent: QWidget, name: str, title: str, text: str, more: str = "") -> None:
        super().__init__(QMessageBox.Icon.Question, title, text, parent=parent)
        self.setObjectName(name)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setInformativeText(more)
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
        text = f"{Path(file).name} already exists. Replace it?"
        box = Question(self, "replace_file", "Replace file?", text)
        box.offer("cancel", "Cancel", ROLE.RejectRole)
        replace = box.offer("replace", "&Replace", ROLE.AcceptRole)
        replace.clicked.connect(lambda: self._agree(file))
        show_beside(self, box)

    def _agree(self, file: str) -> None:
        self._agreed = file
        self.accept()
