"""A run that goes on in a process of its own: a network as it was, and what to make of it."""

import base64
import pickle
import re
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path, PurePath
from typing import Any, Literal

from app.run.terminal import number_text
from core.records import dataclass

Kind = Literal["report", "run", "frames", "sweep", "files"]
REPORT = "report.html"
FRAMES = "frames.npy"
_BARRED = re.compile(r'[<>:"/\\|?*\x00-\x1f]')  # in names of files, on one system or another
_LONGEST = 80


@dataclass(frozen=True)
class Job:
    # ``report``: only the report of the network; ``run``: all that ``imagechain run`` writes;
    # ``frames``: that, and frames of the delivered picture; ``sweep``: figures, and perhaps
    # pictures, at each value of a parameter; ``files``: a run for each of several files
    kind: Kind
    network: str  # the text of the network file
    folder: Path  # what file names in the network are relative to
    path: Path | None  # the network's file; None where it was never saved
    output: Path  # the folder to write in; the file of a ``report``
    chosen: tuple[Path, ...] = ()  # files that the person has chosen to be written
    target: str = ""  # ``NODE.PARAM`` that takes the values
    values: tuple[Any, ...] = ()  # its values, as a network file has them
    log: bool = False  # whether these are equal factors apart
    pictures: bool = True  # whether a sweep makes a run, with its picture, at each value
    report: bool = False  # whether each run writes a report
    frames: int = 0  # how many frames

    @property
    def variants(self) -> tuple[tuple[str, Any], ...]:
        """The runs: the name of a folder, and the target's value; a single one has neither."""
        if self.kind not in ("sweep", "files"):
            return (("", None),)
        if self.kind == "sweep" and not self.pictures:
            return ()
        return tuple(zip(_apart(list(map(self._name, self.values))), self.values, strict=True))

    def _name(self, value: Any) -> str:
        if self.kind == "files":
            return PurePath(value).stem
        return f"{self.target}={value if isinstance(value, str) else number_text(value)}"


def _apart(names: list[str]) -> list[str]:
    """Names that a folder can have, each one once: the same one again gets a number."""
    fit = [_BARRED.sub("_", name)[:_LONGEST].strip(" .") or "_" for name in names]
    known = Counter(name.casefold() for name in fit)  # some systems take A for a
    taken = {name for name, number in known.items() if number == 1}
    apart = []
    for name in fit:
        free, number = name, 1
        while known[name.casefold()] > 1 and (number == 1 or free.casefold() in taken):
            free, number = f"{name}-{number}", number + 1
        taken.add(free.casefold())
        apart.append(free)
    return apart


# What the process of a background run is given and reports: lines of text, read again over there.

_MARK = "imagechain-job "
_INTERVAL_S = 0.1


Step = tuple[float, str]
"""The share that is done, and what is being done."""


@dataclass(frozen=True)
class Result:
    runs: int = 1  # how many runs there were
    failures: tuple[tuple[str, str], ...] = ()  # runs that could not be made: their names, and why
    warnings: tuple[str, ...] = ()  # what the nodes warn of, in lines
    page: Path | None = None  # A page to look at first: the report, or the trade-off
    previews: tuple[tuple[str, bytes], ...] = ()  # names and small pictures (PNG) of the first runs


Message = Job | Step | Result


def message_line(message: Message) -> str:
    return _MARK + base64.b64encode(pickle.dumps(message)).decode()


def read_message(line: str) -> Message | None:
    """What a line says; None for a line of somebody else's, such as a library's, or a torn one."""
    if not line.startswith(_MARK):
        return None
    try:
        message: Message = pickle.loads(base64.b64decode(line.removeprefix(_MARK)))
    except (ValueError, EOFError, pickle.UnpicklingError):
        return None
    return message


class Steps:
    """Counts what is done of a run, in parts of some weight; may be called from any thread."""

    def __init__(self, write: Callable[[Step], object]) -> None:
        self._write = write
        self._lock = threading.Lock()
        self._all, self._done, self._weight = 1.0, 0.0, 0.0
        self._nodes = 0
        self._seen: set[str] = set()
        self._name = ""
        self._last = -_INTERVAL_S

    def expect(self, weight: float) -> None:
        self._all = max(weight, 1e-9)

    def part(self, name: str, *, nodes: int = 0, weight: float = 1.0) -> None:
        """A part begins; its share is counted by nodes that have begun, or by `piece`."""
        with self._lock:
            self._done += self._weight
            self._weight, self._name, self._nodes, self._seen = weight, name, nodes, set()
        self._report(0.0, "")

    def node(self, name: str | None) -> None:
        with self._lock:
            counts = bool(name) and self._nodes > 0
            if name and counts:
                self._seen.add(name)
            share = len(self._seen) / (self._nodes + 1)
        if counts:
            self._report(share, name or "")

    def piece(self, number: int, of: int) -> None:
        self._report(number / of, f"{number} of {of}")

    def _report(self, share: float, doing: str) -> None:
        with self._lock:
            now = time.monotonic()
            if now - self._last < _INTERVAL_S:
                return
            self._last = now
            whole = min(1.0, (self._done + min(share, 1.0) * self._weight) / self._all)
            name = self._name
        self._write((whole, " · ".join(filter(None, (name, doing)))))
