"""The editor killed at random moments: its file whole, its unsaved work offered at the next start.

    python tests/fuzz/editor_kills.py --count 500 --seed 1

It draws offscreen unless QT_QPA_PLATFORM says otherwise. Each case kills one to three editors in a
row, with snapshots, full screen or a report under way, and then starts one that must offer what
was not saved, take it over and leave nothing behind.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from random import Random
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from cases import Case, FindingError, command
from edited_window import REPORT

from app.run.shipped import shipped_networks
from core.errors import ImagechainError
from core.network.parsing import parse_network
from nodes.library import standard_library

Entry = dict[str, Any]
PROGRAM = Path(__file__).resolve().with_name("edited_window.py")
NAME = "net.json"
WAIT_S = 90.0
# Work is kept a second after an edit, and writing it takes less; more than this is never lost,
# however busy the machine.
MOST_LOST_S = 20.0
MARKS = ("saving", "autosave begins", "step begins", "recovering", "report begins")
ENDING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


def attempt(case: Case) -> None:
    """Kill editors, then look what is left."""
    random = case.random
    original = _network(random)
    Path(NAME).write_text(original)
    given = random.choice((NAME, NAME, NAME, "first_steps"))
    texts = {original}  # what the file may hold
    owed: list[set[str]] = []  # of each piece of unsaved work, the states one of which is offered
    for number in range(random.choice((1, 1, 2, 3))):
        editor = _Editor(case, "edit", number, given)
        try:
            moment = _wait_and_kill(editor, random)
        finally:
            editor.end()
        _expect_no_run(case, editor)
        entries = editor.entries()
        said = editor.stderr()
        case.expect(not said, f"the editor says {said[:500]!r}")
        texts = _texts_of_file(entries, texts)
        _expect_whole_file(case, texts, torn=_is_torn(entries))
        texts = {Path(NAME).read_text()}
        owed = _expect_offered(case, entries, owed)
        owed += _owed(entries)
        case.counts[f"killed: {moment}"] += 1
    _verify(case, owed)


class _Editor:
    """An editor in a process of its own, with a home of its own."""

    def __init__(self, case: Case, mode: str, number: int, network: str) -> None:
        home = case.folder / "home"
        home.mkdir(exist_ok=True)
        self.journal = case.folder / f"journal {number}"
        self._said = case.folder / f"stderr {number}"
        environment = {
            "QT_QPA_PLATFORM": "offscreen",
            **os.environ,
            "HOME": str(home),
            "XDG_CONFIG_HOME": str(home / "config"),
            "XDG_DATA_HOME": str(home / "data"),
        }
        with self._said.open("wb") as said:
            self.process = subprocess.Popen(
                [
                    sys.executable, "-X", "faulthandler", str(PROGRAM), mode, str(self.journal),
                    f"{case.seed}/{case.number}/{number}", network,
                ],
                cwd=case.folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=said,
                start_new_session=True,
            )  # fmt: skip

    def entries(self) -> list[Entry]:
        """The journal so far; a line that was cut off by the kill is one of kind "torn"."""
        if not self.journal.exists():
            return []
        found = []
        for line in self.journal.read_text().splitlines(keepends=True):
            found.append(json.loads(line) if line.endswith("\n") else {"kind": "torn"})
        return found

    def stderr(self) -> str:
        return self._said.read_text(errors="replace")

    def wait_for(self, good: Callable[[list[Entry]], object]) -> bool:
        """Wait until the journal is so; False if the process has ended before."""
        end = time.monotonic() + WAIT_S
        while time.monotonic() < end:
            if good(self.entries()):
                return True
            if self.process.poll() is not None:
                return bool(good(self.entries()))
            time.sleep(0.01)
        self.process.send_signal(signal.SIGABRT)
        self.process.wait(10)
        kinds = [entry["kind"] for entry in self.entries()][-5:]
        raise FindingError(
            f"nothing happens for {WAIT_S:g} s after {kinds}: {self.stderr()[:1500]}"
        )

    def end(self) -> None:
        self.process.kill()
        self.process.wait(10)


def _wait_and_kill(editor: _Editor, random: Random) -> str:
    """Kill it while it starts, works, or a moment after something has begun; or as it closes."""
    moment = "while it starts"
    way = random.random()
    if way < 0.15:
        time.sleep(random.uniform(0, 3))
    else:
        editor.wait_for(lambda entries: _kinds(entries, "ready"))
        if way < 0.45:
            moment = "at work"
            time.sleep(random.uniform(0, 4))
        elif way < 0.85:
            mark, times = random.choice(MARKS), random.randint(1, 4)
            moment = f"after: {mark}"
            end = time.monotonic() + random.uniform(2, 5)  # it may not come that often
            editor.wait_for(
                lambda entries: len(_kinds(entries, mark)) >= times or time.monotonic() > end
            )
            time.sleep(random.choice((0, 0.001, 0.003, 0.01, 0.03)))
        else:
            moment = "as it closes"
            time.sleep(random.uniform(0, 2))
            editor.process.send_signal(random.choice(ENDING))
            time.sleep(random.uniform(0, 0.5))
    if editor.process.poll() is not None:
        # It has closed when it was told to; anything else is a crash.
        code, closed = editor.process.returncode, _kinds(editor.entries(), "ends")
        if code or not closed:
            raise FindingError(f"the editor ended by itself with {code}: {editor.stderr()[:1500]}")
        moment = "closed in time"
    editor.process.kill()
    editor.process.wait(10)
    return moment


def _expect_no_run(case: Case, editor: _Editor) -> None:
    """The reports under way end with the editor, and one that was written is whole."""
    end = time.monotonic() + WAIT_S
    while left := _processes_of_session(editor.process.pid):
        case.expect(time.monotonic() < end, f"the editor is gone, its processes are not: {left}")
        time.sleep(0.05)
    if _kinds(editor.entries(), "report begins"):
        case.counts["reports under way or written"] += 1
        if REPORT.exists():
            whole = REPORT.read_text().rstrip().endswith("</html>")
            case.expect(whole, "the report is cut off")


def _processes_of_session(number: int) -> list[int]:
    """The processes, zombies left out, that the editor of this number started."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:  # it has ended meanwhile
            continue
        if int(fields[3]) == number and fields[0] != "Z":
            found.append(int(path.parent.name))
    return found


def _kinds(entries: Iterable[Entry], *kinds: str) -> list[Entry]:
    return [entry for entry in entries if entry["kind"] in kinds]


def _is_torn(entries: list[Entry]) -> bool:
    """Whether it was killed within a step: its outcome may be on the disk, and not written down."""
    return bool(entries) and entries[-1]["kind"] not in ("step ends", "ready", "begins", "ends")


def _texts_of_file(entries: list[Entry], before: set[str]) -> set[str]:
    """What the file may hold: what was saved last, or what was being saved."""
    texts = set(before)
    state = ""
    saving = False
    for entry in entries:
        if entry["kind"] == "state":
            state = entry["text"]
            if saving:  # what was typed is entered before it is saved
                texts.add(state)
        elif entry["kind"] == "saving":
            saving = True
            texts.add(state)
        elif entry["kind"] == "saved":
            saving = False
            texts = {entry["text"]}
        elif entry["kind"] == "step ends":
            saving = False
    return texts


def _expect_whole_file(case: Case, texts: set[str], torn: bool) -> None:
    text = Path(NAME).read_text()
    case.expect(
        text in texts, f"the file is none of {len(texts)} states it may have (torn: {torn})"
    )


def _expect_offered(case: Case, entries: list[Entry], owed: list[set[str]]) -> list[set[str]]:
    """What was owed is offered by an editor that came to its first window; what it did not take."""
    ready = _kinds(entries, "ready")
    if not ready:
        return owed
    offered = [work["text"] for work in ready[0]["recoverable"]]
    problems = [work["problem"] for work in ready[0]["recoverable"] if work["problem"]]
    case.expect(not problems, f"damaged work is offered: {problems}")
    for text in offered:
        try:
            parse_network(text, library=standard_library())
        except ImagechainError as error:
            raise FindingError(f"what is offered is no network: {error}") from error
    for states in owed:
        case.expect(
            bool(states.intersection(offered)),
            f"unsaved work is not offered: {len(states)} states, {len(offered)} offered",
        )
        case.counts["unsaved work offered"] += 1
    taken = {entry["offered"] for entry in _kinds(entries, "recovered")}
    # Taken over, it is a state of this editor; until that is kept, the old file stays.
    return [states for states in owed if not states & taken]


def _owed(entries: list[Entry]) -> list[set[str]]:
    """The states one of which must be offered: those since the one that was surely kept."""
    kept = _surely_kept(entries)
    begun = [n for n, entry in enumerate(entries) if entry["kind"] == "recovered"]
    states = [(n, entry) for n, entry in enumerate(entries) if entry["kind"] == "state"]
    saved = [n for n, entry in enumerate(entries) if entry["kind"] in ("saved", "saving")]
    if not states or not states[-1][1]["modified"]:
        return []
    last = max([*saved, -1])
    if last > states[-1][0] and _kinds(entries[states[-1][0] :], "saved"):
        return []  # nothing is unsaved since the last state was saved
    if kept is None and begun:
        kept = entries[begun[-1]]["state"]
    if entries[-1]["kind"] == "ends":  # told to end it keeps everything
        return [{states[-1][1]["text"]}]
    if kept is None:
        return []
    since = [(n, entry) for n, entry in states if entry["state"] >= kept]
    # A save after it, or a state as saved in between, may have removed it again.
    if any(n > since[0][0] and not entry["modified"] for n, entry in since) or last > since[0][0]:
        return []
    texts = {entry["text"] for _, entry in since}
    if begun:
        texts.add(entries[begun[-1]]["offered"])
    return [texts]


def _surely_kept(entries: list[Entry]) -> int | None:
    """The state that an autosave which has ended began with, or that is long past."""
    kept, begun = None, None
    for entry in entries:
        if entry["kind"] == "autosave begins":
            begun = entry["state"]
        elif entry["kind"] == "autosave ends" and begun is not None:
            if entry["error"]:
                raise FindingError(f"autosave failed: {entry['error']}")
            kept = begun
    ended = entries[-1].get("time", 0.0) if entries else 0.0
    for entry in _kinds(entries, "state"):
        if entry["modified"] and entry["time"] < ended - MOST_LOST_S:
            kept = max(kept or 0, entry["state"])
    return kept


def _verify(case: Case, owed: list[set[str]]) -> None:
    """The next start: offers what is owed, takes it over, saves it, and ends clean."""
    editor = _Editor(case, "verify", 9, "")
    try:
        editor.wait_for(lambda entries: _kinds(entries, "verified"))
        editor.process.send_signal(signal.SIGTERM)
        code = editor.process.wait(WAIT_S)
    finally:
        editor.end()
    entries, said = editor.entries(), editor.stderr()
    case.expect(code == 0 and not said, f"the next editor ends with {code}: {said[:1500]!r}")
    _expect_offered(case, entries, owed)
    for entry in _kinds(entries, "verifying"):
        case.expect(entry["saved"], "recovered work cannot be saved")
        case.expect(entry["text"] == entry["offered"], "recovered work is not what was offered")
        case.counts["works recovered and saved"] += 1
    _expect_nothing_left(case)


def _expect_nothing_left(case: Case) -> None:
    """Once all work is saved, settings and the list of modules stay; no lock, nothing half done."""
    left = sorted(path.name for path in (case.folder / "home").rglob("*") if path.is_file())
    left = [name for name in left if name not in ("editor.ini", "declarations.pickle")]
    case.expect(not left, f"left behind at home: {left}")
    hidden = sorted(path.name for path in case.folder.glob(".*"))
    case.expect(not hidden, f"left behind beside the network: {hidden}")


def _network(random: Random) -> str:
    """A shipped network of a size that takes a moment, or none at all, to compute."""
    path = random.choice(list(shipped_networks().values()))
    document = json.loads(path.read_text())
    for node in document["nodes"].values():
        if node["module"] == "test_scene":
            node["params"] = {**node.get("params", {}), "width": 64, "height": 64}
            if random.random() < 0.4:
                node["params"] |= {"width": 700, "height": 600}
    return json.dumps(document, indent=2) + "\n"


if __name__ == "__main__":
    sys.exit(command(__file__, __doc__.split("\n")[0], attempt, count=50))
