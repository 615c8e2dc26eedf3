"""Reports and queued runs as the window has them: dialogs, the dock, the question at its end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QMainWindow, QWidget

from app.editor.dialogs import ROLE, Question, SaveDialog, drop_dialogs, show_beside
from app.editor.docks.add_run import AddRun
from app.editor.docks.run_queue import RunQueue, job_of
from app.editor.docks.runs_view import ReportStatus, RunsView, failures_text
from app.editor.session import Session
from app.editor.window.viewer_docks import add_dock, bring_forward
from app.options.option_values import REPORTS
from core.errors import ImagechainError
from core.names import shown
from nodes.files.common.file_format import HTML, dialog_filter, suffixes

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
        folder = path.parent if path is not None else Path.cwd()
        kinds = dialog_filter("Reports", HTML)
        dialog = SaveDialog(self._window, "Write the report", str(folder.absolute()), kinds)
        dialog.setObjectName("report_dialog")
        dialog.setDefaultSuffix(HTML.suffixes[0].removeprefix("."))
        dialog.selectFile(f"{self._session.stem}.html")
        dialog.fileSelected.connect(self.report_to)
        show_beside(self._window, dialog)

    def report_to(self, text: str) -> None:
        self._finish_typing()
        file = Path(text)
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
        """Ask whether to end what runs, then go on with `following`; False where nothing runs.

        Of two calls the later one goes on.
        """
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
