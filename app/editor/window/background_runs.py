"""Runs beside the window: what lists and reports them, and the dialog that adds one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QMainWindow,
    QVBoxLayout,
    QWidget,
)

from app.editor.declared_text import label_of, shown_number, typed_number
from app.editor.dialogs import ROLE, FileDialog, Question, SaveDialog, drop_dialogs, show_beside
from app.editor.docks.run_queue import RunQueue, job_of, proposed_folder
from app.editor.docks.runs_view import ReportStatus, RunsView, failures_text
from app.editor.docks.tradeoff_plots import ParameterChoice, Varied, usual_span
from app.editor.session import Session
from app.editor.theme import ERROR
from app.editor.widgets import Check, filled, labelled, tool_button
from app.editor.window.viewer_docks import add_dock, bring_forward
from app.run.job import Kind
from app.run.option_values import REPORTS
from app.run.saving import MOST_FRAMES
from app.run.staging import check_folder
from app.tradeoff.values import MOST, is_number, spaced
from core.errors import ImagechainError, ParameterError, UsageError
from core.modules.parameters import Parameter, plain
from core.names import shown
from core.network.network import MACRO
from nodes.files.common.file_format import HTML, dialog_filter, suffixes
from nodes.files.formats import WRITTEN

Next = Callable[[], object]


class BackgroundRuns(QObject):
    """What goes on beside the window. `finish_typing` takes what is being typed."""

    def __init__(self, session: Session, window: QMainWindow, finish_typing: Next) -> None:
        super().__init__(window)
        self._session = session
        self._window = window
        self._finish_typing = finish_typing
        self._question: Question | None = None
        self._next: Next | None = None
        self.queue = RunQueue(self)
        self.view = RunsView(self.queue)
        area = Qt.DockWidgetArea.BottomDockWidgetArea
        self.dock = add_dock(window, "Runs", "dock.runs", self.view, area)
        self.dock.hide()
        self.status = ReportStatus(self.queue, window)
        self.status.message.connect(session.message)
        self.view.add_wanted.connect(self.add)
        self.queue.changed.connect(self._say_end)
        session.opened.connect(self._drop_dialogs)

    def report(self) -> None:
        path = self._session.document.path
        kinds, title = dialog_filter("Reports", HTML), "Write the report"
        folder = path.parent if path is not None else None
        taken = self.report_to
        dialog = SaveDialog(
            self._window, "report_dialog", title, kinds, taken, suffix="html", folder=folder
        )
        dialog.selectFile(f"{self._session.stem}.html")
        show_beside(self._window, dialog)

    def report_to(self, file: Path) -> None:
        self._finish_typing()
        if not any(form.matches(file) for form in REPORTS):
            ends = " or ".join(suffixes(*REPORTS))
            self._say("error", f"no report {shown(file.name)}: its name must end in {ends}")
        elif file.absolute() in self._taken():
            self._say("note", f"{shown(file.name)} is already being written")
        else:
            try:
                job = job_of(self._session, "report", file)
            except ImagechainError as error:
                self._say("error", f"no report: {error}")
            else:
                self.status.follow(self.queue.add(f"Report {file.name}", job))

    def add(self) -> None:
        dialog = AddRun(self._session, self._taken, self._window)
        dialog.about_to_add.connect(self._finish_typing)
        dialog.added.connect(self._added)
        show_beside(self._window, dialog)
        dialog.kinds.setFocus(Qt.FocusReason.OtherFocusReason)

    def go_on(self, following: Next) -> bool:
        """Ask whether to end what runs, then go on; False where nothing runs."""
        unfinished = self.queue.unfinished
        if not unfinished:
            return False
        self._next = following
        if self._question is None:
            self._question = runs_go_on(self._window, [entry.title for entry in unfinished])
            self._question.finished.connect(self._answered)
            self._question.open()
        else:
            self._question.raise_()
            self._question.activateWindow()
        return True

    def _answered(self) -> None:
        question, self._question = self._question, None
        following, self._next = self._next, None
        if question is not None and question.answer == "stop" and following is not None:
            following()

    def _added(self, title: str, job: Any) -> None:
        number = self.queue.add(title, job)
        self._window.activateWindow()
        bring_forward(self.dock, self.view)
        self.view.mark(number)

    def _say_end(self, number: int) -> None:
        entry = self.queue.entry(number)
        if entry is None or entry.job.kind == "report" or self.view.isVisible():
            return
        if entry.state == "failed":
            self._say("error", f"{entry.title}: failed: {entry.text}")
        elif entry.state == "done":
            failures = failures_text(entry)
            self._say("warning" if failures else "note", f"{entry.title}: {failures or 'done'}")

    def _taken(self) -> set[Path]:
        return {entry.job.output for entry in self.queue.unfinished}

    def _say(self, kind: str, text: str) -> None:
        self._session.message.emit(kind, text)

    def _drop_dialogs(self) -> None:
        for name in ("add_run", "report_dialog"):
            drop_dialogs(self._window, name)


def runs_go_on(parent: QWidget, runs: Sequence[str]) -> Question:
    box = Question(parent, "runs_go_on", "Stop the runs?")
    number = f"{len(runs)} runs are" if len(runs) > 1 else "A run is"
    box.setText(f"{number} not done yet: {runs[0]}{' …' if len(runs) > 1 else ''}")
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setInformativeText("Results that are not written yet are lost.")
    box.offer("cancel", "&Keep Running", ROLE.RejectRole)
    box.offer("stop", "&Stop and Quit", ROLE.DestructiveRole)
    return box


KINDS: tuple[tuple[Kind, str], ...] = (
    ("sweep", "Sweep: a parameter over values"),
    ("frames", "Frames, each with its own noise"),
    ("files", "Pictures, one after the other"),
    ("run", "One run that also writes the network's files"),
)
_USUAL_COUNT, _USUAL_FRAMES = 5, 16


class AddRun(QDialog):
    """What to run, over what, and where to; a fault is said beside its field."""

    about_to_add = Signal()  # what is being typed elsewhere is to be taken now
    added = Signal(str, object)  # (title, job): the person has added a run

    def __init__(self, session: Session, taken: Callable[[], set[Path]], parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("add_run")
        self.setWindowTitle("Add a run")
        self._session = session
        self._taken = taken
        self._varied = Varied(session, lambda _why: None)
        self._proposed = ""
        self.errors: dict[str, QLabel] = {}
        self._build()
        self._choose_kind()

    @property
    def kind(self) -> Kind:
        return KINDS[self.kinds.currentIndex()][0]

    def vary(self, node: str, name: str) -> None:
        self.parameter.choose(node, name)
        self._chosen(node, name)

    def _build(self) -> None:
        self.kinds = QComboBox(self)
        self.kinds.addItems([text for _, text in KINDS])
        self.parameter = ParameterChoice(self._session, self)
        self.values = self._line(FORM)
        self.pictures = Check("also write a picture for each value", self)
        self.pictures.setChecked(True)
        self.frames = self._line("a whole number")
        self.frames.setText(str(_USUAL_FRAMES))
        self.reader = QComboBox(self)
        self.files = QListWidget(self)
        self.files.setMaximumHeight(7 * self.fontMetrics().height())
        self.files.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.choose = tool_button("add_run.choose", "Choose…", "Choose pictures", self)
        self.drop = tool_button(
            "add_run.drop", "Remove", "Remove the selected files from the list", self
        )
        self.folder = self._line("a folder; it is created if it does not exist")
        self.browse = tool_button("add_run.browse", "Browse…", "Choose the folder", self)
        self.report = Check("a report (HTML) for each run", self)
        self._form = QFormLayout()
        self._form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        self._rows: dict[QWidget, tuple[Kind, ...]] = {}
        every = tuple(kind for kind, _ in KINDS)
        self._row("kind", "&Run", self.kinds, every)
        self._row("parameter", "&Parameter", self.parameter, ("sweep",))
        self._row("values", "&Values", self.values, ("sweep",))
        self._row("pictures", "", self.pictures, ("sweep",))
        self._row("frames", "&Number of frames", self.frames, ("frames",))
        self._row("reader", "Read &by", self.reader, ("files",))
        self._row(
            "files", "Pictur&es", self._beside(self.files, self.choose, self.drop), ("files",)
        )
        self._row("folder", "&Output folder", self._beside(self.folder, self.browse), every)
        self._row("report", "", self.report, every)
        self.buttons = QDialogButtonBox(self)
        add = self.buttons.addButton("&Add to Queue", QDialogButtonBox.ButtonRole.AcceptRole)
        add.setObjectName("add_run.add")
        add.setDefault(True)
        self.buttons.addButton(QDialogButtonBox.StandardButton.Cancel).setObjectName(
            "add_run.cancel"
        )
        filled(QVBoxLayout(self), self._form, None, self.buttons, margins=None)
        self.setMinimumWidth(92 * self.fontMetrics().averageCharWidth())
        self.kinds.currentIndexChanged.connect(self._choose_kind)
        self.parameter.chosen.connect(self._chosen)
        self.choose.clicked.connect(self._choose_files)
        self.drop.clicked.connect(self._drop_files)
        self.browse.clicked.connect(self._choose_folder)
        self.buttons.accepted.connect(self._add)
        self.buttons.rejected.connect(self.reject)
        self._fill_readers()

    def _line(self, placeholder: str) -> QLineEdit:
        line = QLineEdit(self, placeholderText=placeholder)
        line.setToolTip(placeholder)
        return line

    def _beside(self, field: QWidget, *buttons: QWidget) -> QWidget:
        box = QWidget(self)
        row = filled(QHBoxLayout(box), (field, 1))
        for button in buttons:
            row.addWidget(button, 0, Qt.AlignmentFlag.AlignTop)
        box.setFocusProxy(field)
        return box

    def _row(self, name: str, label: str, field: QWidget, kinds: tuple[Kind, ...]) -> None:
        inner = field.focusProxy() or field
        inner.setObjectName(f"add_run.{name}")
        if not isinstance(field, Check):
            inner.setAccessibleName(label.replace("&", ""))
        error = labelled(QLabel(self, wordWrap=True), f"add_run.{name}.error")
        error.setForegroundRole(ERROR)
        error.hide()
        self.errors[name] = error
        box = QWidget(self)
        filled(QVBoxLayout(box), field, error, spacing=1)
        box.setFocusProxy(field)
        self._rows[box] = kinds
        if label:
            text = QLabel(label, self)
            text.setBuddy(inner)
            self._form.addRow(text, box)
        else:
            self._form.addRow("", box)

    def _choose_kind(self, *_: object) -> None:
        kind = self.kind
        for box, kinds in self._rows.items():
            self._form.setRowVisible(box, kind in kinds)
        self._forget_errors()
        if self.folder.text() in ("", self._proposed):
            self._propose()
        self.adjustSize()

    def _propose(self) -> None:
        self._proposed = str(proposed_folder(self._session, self.kind, self._taken()))
        self.folder.setText(self._proposed)
        self.folder.setCursorPosition(len(self._proposed))

    def _fill_readers(self) -> None:
        network = self._session.network
        for name in network.nodes:
            declared = self._session.declared(name)
            if declared is None or declared.sink or declared.key == MACRO:  # its inside is there
                continue
            for parameter in declared.parameters:
                if parameter.kind == "path":
                    text = f"{label_of(parameter.name)} of {name}"
                    self.reader.addItem(text, f"{name}.{parameter.name}")
                    if declared.key == "read_image":
                        self.reader.setCurrentIndex(self.reader.count() - 1)

    def _chosen(self, node: str, name: str) -> None:
        self._varied.choose(node, name)
        parameter = self._varied.parameter
        if parameter is not None:
            span = usual_span(parameter, self._varied.present)
            ends = f"{shown_number(span.low)}:{shown_number(span.high)}"
            self.values.setText(f"{ends}:{_USUAL_COUNT}{':log' if span.log else ''}")
            unit = parameter.param.unit
            self.values.setToolTip(f"{FORM}{unit and f'; in {unit} if you type no unit'}")
            self._say("parameter", "")

    # --- files and folders ------------------------------------------------------------------

    def _choose_files(self) -> None:
        dialog = self._dialog("Choose pictures", QFileDialog.FileMode.ExistingFiles)
        pictures = dialog_filter("Pictures", *WRITTEN)
        dialog.setNameFilters([*pictures.split(";;"), "All files (*)"])
        dialog.filesSelected.connect(self._take_files)
        show_beside(self, dialog)

    def _choose_folder(self) -> None:
        dialog = self._dialog("Choose the output folder", QFileDialog.FileMode.Directory)
        dialog.setOption(QFileDialog.Option.ShowDirsOnly)
        dialog.fileSelected.connect(self.folder.setText)
        show_beside(self, dialog)

    def _dialog(self, title: str, mode: QFileDialog.FileMode) -> QFileDialog:
        dialog = FileDialog(self, title, str(self._session.folder.absolute()))
        dialog.setObjectName("add_run.dialog")
        dialog.setFileMode(mode)
        return dialog

    def _take_files(self, names: list[str]) -> None:
        known = {self.files.item(row).text() for row in range(self.files.count())}
        self.files.addItems([name for name in names if name not in known])
        self._say("files", "")

    def _drop_files(self) -> None:
        for item in self.files.selectedItems():
            self.files.takeItem(self.files.row(item))

    # --- adding ------------------------------------------------------------------------------

    def _add(self) -> None:
        self.about_to_add.emit()
        self._forget_errors()
        choices: dict[str, Any] = {"report": self.report.isChecked()}
        what = ""
        if self.kind == "sweep":
            what = self._sweep(choices)
        elif self.kind == "frames":
            what = self._frames(choices)
        elif self.kind == "files":
            what = self._files(choices)
        else:
            what = "one run"
        folder = self._output()
        if not what or folder is None or any(error.text() for error in self.errors.values()):
            return
        try:
            job = job_of(self._session, self.kind, folder, **choices)
        except ImagechainError as error:
            self._say("kind", str(error))
            return
        name = self._session.document.path.stem if self._session.document.path else ""
        name = name or self._session.network.name or "untitled"
        self.accept()
        self.added.emit(f"{name}: {what}", job)

    def _sweep(self, choices: dict[str, Any]) -> str:
        parameter = self._varied.parameter
        if parameter is None:
            self._say("parameter", "choose the parameter to sweep")
            return ""
        try:
            values, log = typed_values(self.values.text(), parameter)
        except ImagechainError as error:
            self._say("values", error.message)
            return ""
        target = f"{self._varied.node}.{self._varied.name}"
        pictures = self.pictures.isChecked()
        choices |= {"target": target, "values": values, "log": log, "pictures": pictures}
        choices["report"] = choices["report"] and pictures
        count = f"{len(values)} value{'' if len(values) == 1 else 's'}"
        return f"{label_of(self._varied.name)} of {self._varied.node}, {count}"

    def _frames(self, choices: dict[str, Any]) -> str:
        text = self.frames.text().strip()
        whole = text.isascii() and text.isdigit() and len(text) < 10
        if not whole or not 1 <= int(text) <= MOST_FRAMES:
            allowed = f"a whole number from 1 to {MOST_FRAMES}"
            self._say("frames", f"{text or 'nothing'!s:.40} is not allowed: {allowed}")
            return ""
        choices["frames"] = int(text)
        return f"{int(text)} frame{'' if int(text) == 1 else 's'}"

    def _files(self, choices: dict[str, Any]) -> str:
        if self.reader.count() == 0:
            self._say("reader", "the network reads no picture: add a Read Image")
            return ""
        files = tuple(self.files.item(row).text() for row in range(self.files.count()))
        if not files:
            self._say("files", "choose the pictures")
            return ""
        choices |= {"target": self.reader.currentData(), "values": files}
        return f"{len(files)} picture{'' if len(files) == 1 else 's'}"

    def _output(self) -> Path | None:
        text = self.folder.text().strip()
        try:
            if not text or "\0" in text:
                raise UsageError("give a folder")
            folder = (self._session.folder.absolute() / Path(text).expanduser()).absolute()
            if folder in self._taken():
                raise UsageError("a queued run writes to this folder: choose another one")
            check_folder(folder)
        except (ImagechainError, RuntimeError) as error:  # of a home that nobody has
            self._say("folder", str(error))
            return None
        return folder

    def _say(self, name: str, text: str) -> None:
        label = self.errors[name]
        first = bool(text) and not any(error.text() for error in self.errors.values())
        label.setText(text)
        label.setVisible(bool(text))
        field = self.findChild(QWidget, f"add_run.{name}")
        if first and isinstance(field, QWidget):
            field.setAccessibleDescription(text)
            field.setFocus(Qt.FocusReason.OtherFocusReason)
        if self.isVisible():
            self.adjustSize()  # to the lines that are there now

    def _forget_errors(self) -> None:
        for name in self.errors:
            self._say(name, "")


# The values a parameter is to take as a person types them: a range, or a list.

FORM = "FROM:TO:COUNT, FROM:TO:COUNT:log, or a list a, b, c"
_EQUAL_STEPS, _EQUAL_FACTORS = 3, 4


def typed_values(text: str, parameter: Parameter) -> tuple[tuple[Any, ...], bool]:
    """The values, and whether they are equal factors apart.

    Each number is typed as in the parameter's field, in any unit. Between the numbers of a list
    are commas; with semicolons, commas are decimal points.
    """
    if not text.strip():
        raise UsageError(f"no values: {FORM}")
    if ":" in text:
        values, log = _range(text, parameter)
    else:
        parts = text.split(";" if ";" in text else ",")
        values, log = [_number(part, parameter) for part in parts], False
    allowed = dict.fromkeys(_allowed(value, parameter) for value in values)
    if len(allowed) > MOST:
        raise UsageError(f"{len(allowed)} values, at most {MOST} are allowed")
    return tuple(allowed), log


def _range(text: str, parameter: Parameter) -> tuple[list[Any], bool]:
    parts = [part.strip() for part in text.split(":")]
    log = len(parts) == _EQUAL_FACTORS and parts[-1] == "log"
    if len(parts) != _EQUAL_STEPS and not log:
        raise UsageError(f"{text.strip()!r:.60} is no range: {FORM}")
    low, high = (_number(part, parameter) for part in parts[:2])
    count = parts[2]
    if not (count.isascii() and count.isdigit() and len(count) < 10 and 2 <= int(count) <= MOST):
        raise UsageError(f"COUNT = {count or 'nothing'!s:.20} is not allowed: from 2 to {MOST}")
    if low == high:
        raise UsageError(f"FROM and TO are both {low:g}: a range needs two different numbers")
    if log and (low <= 0 or high <= 0):
        raise UsageError("log needs FROM and TO above 0")
    whole = parameter.kind == "integer"
    return list(spaced(low, high, int(count), log=log, whole=whole)), log


def _number(text: str, parameter: Parameter) -> Any:
    number = typed_number(text, parameter)
    if number is None:
        raise UsageError(f"a number is missing: {FORM}")
    if not is_number(number):
        raise UsageError(f"{text.strip()!r:.40} is no number: {FORM}")
    return number


def _allowed(value: Any, parameter: Parameter) -> Any:
    coerced = parameter.coerce(value)
    if coerced is None:
        allowed = "this value means an empty parameter"
        raise ParameterError(parameter.name, value, allowed, unit=parameter.param.unit)
    return plain(coerced)
