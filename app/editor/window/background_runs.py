"""Runs beside the window: what lists and reports them, and the dialog that adds one."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from PySide6 import QtWidgets
from PySide6.QtCore import QObject, Qt, Signal

from app.editor import messages, theme
from app.editor.declared_text import label_of
from app.editor.docks.runs import RunQueue, RunsView, failures_text, job_of, proposed_folder
from app.editor.docks.tradeoff_plots import ParameterChoice, Varied, typed_values, usual_span
from app.editor.session import Session
from app.editor.widgets import Check, filled, labelled, plain_label, show_or_hide, tool_button
from app.editor.window.viewer_docks import add_dock, bring_forward
from app.run.job import Kind
from app.run.option_values import REPORTS
from app.run.overrides import taken_value
from app.run.saving import MOST_FRAMES
from app.run.staging import check_folder
from core.errors import ImagechainError, UsageError, shown
from core.network.network import MACRO
from core.records import replace
from nodes.files.file_format import HTML, dialog_filter, suffixes

Next = Callable[[], object]


class BackgroundRuns(QObject):
    """What goes on beside the window. `finish_typing` takes what is being typed."""

    def __init__(
        self, session: Session, window: QtWidgets.QMainWindow, finish_typing: Next
    ) -> None:
        super().__init__(window)
        self._session = session
        self._window = window
        self._finish_typing = finish_typing
        self._question: messages.Question | None = None
        self.queue = RunQueue(self)
        self.view = RunsView(self.queue)
        self.dock = add_dock(window, "Runs", "runs", self.view, hidden=True)
        self.view.add_wanted.connect(self.add)
        self.queue.changed.connect(self._say_end)
        for name in ("add_run", "report_dialog"):
            session.opened.connect(partial(messages.drop_dialogs, window, name))

    def report(self) -> None:
        path = self._session.document.path
        kinds, title = dialog_filter("Reports", HTML), "Write the report"
        folder = path.parent if path is not None else None
        taken = self.report_to
        dialog = messages.SaveDialog(
            self._window, "report_dialog", title, kinds, taken, suffix="html", folder=folder
        )
        dialog.selectFile(f"{self._session.stem}.html")
        messages.show_beside(self._window, dialog)

    def report_to(self, file: Path) -> None:
        self._finish_typing()
        if not any(form.matches(file) for form in REPORTS):
            ends = " or ".join(suffixes(*REPORTS))
            self._say(
                "error", f"cannot write a report to {shown(file.name)}: the name must end in {ends}"
            )
        elif file.absolute() in self._taken():
            self._say("note", f"{shown(file.name)} is already being written")
        else:
            with messages.told(self._say, "no report: "):
                self._add(f"Report {file.name}", job_of(self._session, "report", file))

    def add(self) -> None:
        dialog = AddRun(self._session, self._taken, self._window)
        dialog.about_to_add.connect(self._finish_typing)
        dialog.added.connect(self._add)
        messages.show_beside(self._window, dialog)
        dialog.kinds.setFocus(Qt.FocusReason.OtherFocusReason)

    def go_on(self, following: Next) -> bool:
        """Ask whether to end what runs, then go on; False where nothing runs."""
        unfinished = self.queue.unfinished
        if unfinished and self._question is None:
            text = f"Unfinished runs: {', '.join(run.title for run in unfinished)}"
            more = "Results not yet written will be lost."
            box = messages.Question(self._window, "runs_go_on", "Stop the runs?", text, more)
            self._question = box
            box.offer("cancel", "&Keep Running", messages.ROLE.RejectRole)
            box.offer("stop", "&Stop and Quit", messages.ROLE.DestructiveRole)
            box.finished.connect(lambda _: self._answered(following))
            box.open()
        elif self._question is not None:
            self._question.raise_()
            self._question.activateWindow()
        return bool(unfinished)

    def _answered(self, following: Next) -> None:
        question, self._question = self._question, None
        if question is not None and question.answer == "stop":
            following()

    def _add(self, title: str, job: Any) -> None:
        self.queue.add(title, job)  # the list marks it
        self._window.activateWindow()
        bring_forward(self.dock, self.view)

    def _say_end(self, run: Any) -> None:
        if self.view.isVisible():
            return
        if run.state == "failed":
            self._say("error", f"{run.title}: failed: {run.text}")
        elif run.state == "done":
            failures = failures_text(run)
            self._say("warning" if failures else "note", f"{run.title}: {failures or 'done'}")

    def _taken(self) -> set[Path]:
        return {run.job.output for run in self.queue.unfinished}

    def _say(self, kind: str, text: str) -> None:
        self._session.message.emit(kind, text)


KINDS: tuple[tuple[Kind, str], ...] = (
    ("sweep", "Sweep: one parameter over several values"),
    ("frames", "Frames, each with its own noise"),
    ("files", "Pictures, one after the other"),
    ("run", "One run that also writes the network's files"),
)
FORM = "FROM:TO:COUNT, FROM:TO:COUNT:log (logarithmic), or a list a,b,c"
_USUAL_COUNT, _USUAL_FRAMES = 5, 16


class AddRun(QtWidgets.QDialog):
    """What to run, over what, and where to; a fault is said below, with its field in focus."""

    about_to_add = Signal()  # what is being typed elsewhere is to be taken now
    added = Signal(str, object)  # (title, job): the person has added a run

    def __init__(
        self, session: Session, taken: Callable[[], set[Path]], parent: QtWidgets.QWidget
    ) -> None:
        super().__init__(parent, objectName="add_run", windowTitle="Add a run")
        self._session = session
        self._taken = taken
        self._varied = Varied(session, lambda _why: None)
        self._proposed = ""
        self._files: tuple[str, ...] = ()
        self._rows: dict[QtWidgets.QWidget, Kind | None] = {}
        self._form = QtWidgets.QFormLayout()
        self._form.setFieldGrowthPolicy(
            QtWidgets.QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow
        )
        self._build()
        self._choose_kind()

    @property
    def kind(self) -> Kind:
        return KINDS[self.kinds.currentIndex()][0]

    def _build(self) -> None:
        self.kinds: QtWidgets.QComboBox = self._row("kind", "&Run", QtWidgets.QComboBox(self))
        self.kinds.addItems([text for _, text in KINDS])
        choice = ParameterChoice(self._session, self)
        self.parameter = self._row("parameter", "&Parameter", choice, "sweep")
        line = QtWidgets.QLineEdit(self, placeholderText=FORM)
        self.values: QtWidgets.QLineEdit = self._row("values", "&Values", line, "sweep")
        self.pictures = Check("also write a picture for each value", self)
        self._row("pictures", "", self.pictures, "sweep").setChecked(True)
        frames = QtWidgets.QSpinBox(self, minimum=1, maximum=MOST_FRAMES, value=_USUAL_FRAMES)
        self.frames = self._row("frames", "&Number of frames", frames, "frames")
        self.reader = self._row("reader", "Read &by", QtWidgets.QComboBox(self), "files")
        self._fill_readers()
        self.files, choose = self._browsed("files", "Pictur&es", "Choose pictures", "files")
        self.files.setReadOnly(True)
        self.folder, browse = self._browsed("folder", "&Output folder", "Choose the folder")
        self.report = self._row(
            "report", "", Check("also write a report (HTML) for each run", self)
        )
        self.error = plain_label("add_run.error", self, role=theme.ERROR)
        buttons = QtWidgets.QDialogButtonBox(self)
        add = buttons.addButton("&Add to Queue", QtWidgets.QDialogButtonBox.ButtonRole.AcceptRole)
        add.setObjectName("add_run.add")
        add.setDefault(True)
        buttons.addButton(QtWidgets.QDialogButtonBox.StandardButton.Cancel).setObjectName(
            "add_run.cancel"
        )
        filled(QtWidgets.QVBoxLayout(self), self._form, self.error, None, buttons, margins=None)
        self.setMinimumWidth(92 * self.fontMetrics().averageCharWidth())
        self.kinds.currentIndexChanged.connect(self._choose_kind)
        self.parameter.chosen.connect(self._chosen)
        choose.clicked.connect(self._choose_files)
        browse.clicked.connect(self._choose_folder)
        buttons.accepted.connect(self._add)
        buttons.rejected.connect(self.reject)

    def _row(self, name: str, label: str, field: Any, kind: Kind | None = None) -> Any:
        """A row of the form, for all kinds of runs or for one; its field."""
        labelled(field, f"add_run.{name}", label.replace("&", ""))
        self._form.addRow(label, field)
        self._rows[field] = kind
        return field

    def _browsed(self, name: str, label: str, about: str, kind: Kind | None = None) -> Any:
        """A row whose field has a button beside it that opens a dialog; both of them."""
        line, box = QtWidgets.QLineEdit(self), QtWidgets.QWidget(self)
        button = tool_button(f"add_run.{name}.browse", "Browse…", about, self)
        filled(QtWidgets.QHBoxLayout(box), (line, 1), button)
        box.setFocusProxy(line)
        self._row(f"{name}.box", label, box, kind)
        return labelled(line, f"add_run.{name}", label.replace("&", "")), button

    def _choose_kind(self, *_: object) -> None:
        for field, kind in self._rows.items():
            self._form.setRowVisible(field, kind in (None, self.kind))
        self._say("")
        if self.folder.text() in ("", self._proposed):
            self._proposed = str(proposed_folder(self._session, self.kind, self._taken()))
            self.folder.setText(self._proposed)
        self.adjustSize()

    def _fill_readers(self) -> None:
        for name in self._session.network.nodes:
            declared = self._session.declared(name)
            if declared is None or declared.sink or declared.key == MACRO:  # its inside is there
                continue
            for path in declared.path_names:
                self.reader.addItem(f"{label_of(path)} of {name}", f"{name}.{path}")
                if declared.key == "read_image":
                    self.reader.setCurrentIndex(self.reader.count() - 1)

    def _chosen(self, node: str, name: str) -> None:
        self._varied.choose(node, name)
        parameter = self._varied.parameter
        if parameter is not None:
            span = usual_span(parameter, self._varied.present)
            self.values.setText(replace(span, count=_USUAL_COUNT).text)
            unit = parameter.param.unit
            self.values.setToolTip(f"{FORM}{unit and f'; in {unit}'}")
            self._say("")

    def _choose_files(self) -> None:
        messages.choose_pictures(
            self, "Choose pictures", name="add_run.dialog", chosen=self._take_files
        )

    def _choose_folder(self) -> None:
        folder = str(self._session.folder.absolute())
        dialog = labelled(
            messages.FileDialog(self, "Choose the output folder", folder), "add_run.dialog"
        )
        dialog.setFileMode(QtWidgets.QFileDialog.FileMode.Directory)
        dialog.setOption(QtWidgets.QFileDialog.Option.ShowDirsOnly)
        dialog.fileSelected.connect(self.folder.setText)
        messages.show_beside(self, dialog)

    def _take_files(self, paths: tuple[Path, ...]) -> None:
        self._files = tuple(map(str, paths))
        self.files.setText(", ".join(path.name for path in paths))
        self.files.setToolTip("\n".join(self._files))
        self._say("")

    # --- adding ------------------------------------------------------------------------------

    def _add(self) -> None:
        self.about_to_add.emit()
        self._say("")
        field: QtWidgets.QWidget = self.folder
        try:
            output = self._output()
            fields = {"sweep": self.values, "frames": self.frames, "files": self.files}
            field = fields.get(self.kind, self.kinds)  # which says most of a kind of run
            what, choices = self._choices()
            choices.setdefault("report", self.report.isChecked())
            job = job_of(self._session, self.kind, output, **choices)
        except (ImagechainError, RuntimeError) as error:  # of a home that nobody has
            text = error.message if isinstance(error, ImagechainError) else str(error)
            self._say(text, field)
            return
        path = self._session.document.path
        name = path.stem if path else self._session.network.name or "untitled"
        self.accept()
        self.added.emit(f"{name}: {what}", job)

    def _choices(self) -> tuple[str, dict[str, Any]]:
        """What is run, in words, and as a job has it."""
        if self.kind == "sweep":
            return self._sweep()
        if self.kind == "frames":
            frames = self.frames.value()
            return f"{frames} frame{'s' * (frames > 1)}", {"frames": frames}
        if self.kind == "files":
            if self.reader.count() == 0:
                raise UsageError("the network reads no picture: add a Read Image node")
            if not self._files:
                raise UsageError("choose the pictures")
            choices = {"target": self.reader.currentData(), "values": self._files}
            return f"{len(self._files)} picture{'s' * (len(self._files) > 1)}", choices
        return "one run", {}

    def _sweep(self) -> tuple[str, dict[str, Any]]:
        varied, text = self._varied, self.values.text().strip()
        if varied.parameter is None:
            raise UsageError("choose the parameter to sweep")
        if not text:
            raise UsageError(f"no values: {FORM}")
        target = f"{varied.node}.{varied.name}"
        swept = typed_values(self._session, target, text)
        values = tuple(taken_value(swept.parameter, value) for value in swept.values)
        pictures = self.pictures.isChecked()
        choices = {"target": target, "values": values, "log": swept.log, "pictures": pictures}
        if not pictures:
            choices["report"] = False
        count = f"{len(values)} value{'s' * (len(values) > 1)}"
        return f"{label_of(varied.name)} of {varied.node}, {count}", choices

    def _output(self) -> Path:
        text = self.folder.text().strip()
        if not text or "\0" in text:
            raise UsageError("give a folder")
        folder = (self._session.folder.absolute() / Path(text).expanduser()).absolute()
        if folder in self._taken():
            raise UsageError("a queued run already writes to this folder: choose another folder")
        check_folder(folder)
        return folder

    def _say(self, text: str, field: QtWidgets.QWidget | None = None) -> None:
        show_or_hide(self.error, text)
        if field is not None:
            field.setAccessibleDescription(text)
            field.setFocus(Qt.FocusReason.OtherFocusReason)
        if self.isVisible():
            self.adjustSize()  # to the lines that are there now
