"""The real editor, edited by itself and writing down what it does, until it is killed.

    python edited_window.py edit|verify JOURNAL SEED NETWORK

Each line of the journal is written before the thing it names can be seen on the disk, or after it
is finished there, and says which. A process that is killed loses nothing it has written.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from random import Random
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from cases import default_signals
from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtTest import QTest

import app.command.cli
from app.editor.recovery_files import recoverable
from app.editor.window.main_window import MainWindow
from app.editor.window.start import application
from edited_networks import DRAGS, MAKERS, Editor

CTRL = Qt.KeyboardModifier.ControlModifier
SHIFT = Qt.KeyboardModifier.ShiftModifier
# What shows or keeps something beside the canvas, and is open when the editor is killed.
BESIDE = (
    "keep_snapshot", "flip", "wipe", "snapshots", "history", "runs", "full_screen", "trade_off",
)  # fmt: skip
REPORT = Path("reports/report.html")


class Journal:
    """What happened, one JSON object a line, each written at once."""

    def __init__(self, path: str) -> None:
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)

    def write(self, kind: str, **facts: Any) -> None:
        line = json.dumps({"kind": kind, "time": time.monotonic(), **facts}) + "\n"
        os.write(self._file, line.encode())


class Person(QObject):
    """Works at the window: a step each time the timer rings."""

    def __init__(self, journal: Journal, random: Random, mode: str) -> None:
        super().__init__()
        self.journal, self.random, self.mode = journal, random, mode
        self.window: MainWindow | None = None
        self.gesture: object = None
        self.states = -1
        self.to_recover: list[Any] = []
        self.timer = QTimer(self)
        self.timer.setSingleShot(True)
        self.timer.timeout.connect(self._ring)
        self.timer.start(0)

    def _ring(self) -> None:
        if self.window is None:
            found = [w for w in application().topLevelWidgets() if isinstance(w, MainWindow)]
            if found and found[0].isVisible():
                self._begin(found[0])
        elif self.mode == "done" or not self.window.isVisible():
            return
        elif self.mode == "edit":
            self._step(self.window)
        else:
            self._verify(self.window)
        self.timer.start(self.random.choice((0, 5, 20, 20, 60, 200)))

    def _begin(self, window: MainWindow) -> None:
        self.window = window
        window.session.changed.connect(self._state)
        window.session.opened.connect(self._state)
        window.autosaver._timer.timeout.connect(
            lambda: self.journal.write("autosave begins", state=self.states)
        )
        window.autosaver._written.connect(
            lambda error: self.journal.write("autosave ends", error=str(error or ""))
        )
        self._state()
        self.to_recover = [work for work in recoverable(window._recovery) if not work.problem]
        found = [
            {"text": work.text, "problem": work.problem, "original": str(work.original)}
            for work in recoverable(window._recovery)
        ]
        self.journal.write("ready", recoverable=found)

    def _state(self, *_: object) -> None:
        assert self.window is not None
        document = self.window.session.document
        self.states += 1
        modified, text = document.modified, document.text()
        self.journal.write("state", state=self.states, modified=modified, text=text)

    def _step(self, window: MainWindow) -> None:
        chosen = self.random.random()
        self.journal.write("step begins")
        if self.to_recover and chosen < 0.3:
            self._recover(window)
        elif chosen < 0.55:
            self._edit(window)
        elif chosen < 0.65:
            key, more = self.random.choice(((Qt.Key.Key_Z, CTRL), (Qt.Key.Key_Z, CTRL | SHIFT)))
            QTest.keyClick(window, key, more)
        elif chosen < 0.72:
            self._save(window)
        elif chosen < 0.77:
            window.generate()
        elif chosen < 0.82:
            window.canvas.view.setFocus()
            QTest.keyClick(window.canvas.view, self.random.choice((Qt.Key.Key_D, Qt.Key.Key_1)))
        elif chosen < 0.9 and window.session.network.nodes:
            window.session.select([self.random.choice(list(window.session.network.nodes))])
        elif chosen < 0.93:
            self.gesture = self.random.choice((None, object()))
            window.session.end_gesture()
        elif chosen < 0.98:
            window.actions_by_name[self.random.choice(BESIDE)].trigger()
        elif not window.runs.queue.unfinished:
            REPORT.parent.mkdir(exist_ok=True)
            self.journal.write("report begins")
            window.runs.report_to(REPORT.absolute())
        self.journal.write("step ends", state=self.states)

    def _edit(self, window: MainWindow) -> None:
        session = window.session
        maker = self.random.choice(DRAGS if self.gesture is not None else MAKERS)
        operation = maker(Editor(self.random, session.network, session.library))
        if operation is not None and len(session.network.nodes) < 30:
            session.do(operation, self.gesture)

    def _save(self, window: MainWindow) -> None:
        if window.session.document.path is None:
            return
        self.journal.write("saving", state=self.states)
        window.files.save()
        if not window.session.document.modified:
            text = window.session.document.text()
            self.journal.write("saved", state=self.states, text=text)

    def _recover(self, window: MainWindow) -> None:
        """The latest work; what follows is a state that is unsaved from the beginning."""
        if window.session.document.modified:
            return  # the window would ask
        work = self.to_recover.pop(0)
        self.journal.write("recovering")
        window.welcome.recovered.emit(work)
        self.journal.write("recovered", state=self.states, offered=work.text)

    def _verify(self, window: MainWindow) -> None:
        """Open each work that is offered, save it to a file of its own, throw away the rest."""
        if not self.to_recover:
            for work in recoverable(window._recovery):
                work.discard()
            window.show_welcome()
            # What a save cut short has left beside the network goes at the next one there.
            window.session.save(Path("after.json"))
            self.mode = "done"
            self.journal.write("verified")
        elif not window.session.document.modified:
            offered = self.to_recover[0].text
            self._recover(window)
            text = window.session.document.text()
            saved = window.session.save(Path(f"recovered {len(self.to_recover)}.json"))
            self.journal.write("verifying", offered=offered, text=text, saved=saved)


def main() -> int:
    mode, journal_path, seed, network = sys.argv[1:]
    default_signals()
    journal = Journal(journal_path)
    journal.write("begins")
    application()
    person = Person(journal, Random(seed), mode)
    code = app.command.cli.main(["edit", *([network] if network else [])])
    journal.write("ends", state=person.states)
    return code


if __name__ == "__main__":
    sys.exit(main())
