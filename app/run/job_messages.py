"""What the process of a background run reports: lines of text, read again by who started it."""

from __future__ import annotations

import base64
import json
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

_MARK = "imagechain-job "
_INTERVAL_S = 0.1


@dataclass(frozen=True)
class Step:
    """How far it is: a share of the whole, and what is being made."""

    share: float
    doing: str


@dataclass(frozen=True)
class Preview:
    """A small picture of what a run has made, as PNG; `name` is that of its folder."""

    name: str
    png: bytes


@dataclass(frozen=True)
class Result:
    """What has been made.

    Parameters
    ----------
    runs : int
        How many runs there were.
    failures : tuple of (str, str)
        Runs that could not be made: their names, and why.
    warnings : tuple of str
        What the nodes warn of, in lines.
    page : Path or None
        A page to look at first: the report, or the trade-off.
    previews : tuple of Preview
        Small pictures of the first runs.
    """

    runs: int = 1
    failures: tuple[tuple[str, str], ...] = ()
    warnings: tuple[str, ...] = ()
    page: Path | None = None
    previews: tuple[Preview, ...] = ()


def step_line(step: Step) -> str:
    """The line of a step."""
    return _MARK + json.dumps({"share": step.share, "doing": step.doing})


def result_line(result: Result) -> str:
    """The line of a result."""
    content = {
        "runs": result.runs,
        "failures": result.failures,
        "warnings": result.warnings,
        "page": None if result.page is None else str(result.page),
        "previews": [
            (preview.name, base64.b64encode(preview.png).decode()) for preview in result.previews
        ],
    }
    return _MARK + json.dumps(content)


def read_message(line: str) -> Step | Result | None:
    """What a line says; None for a line of somebody else's, such as a library's."""
    if not line.startswith(_MARK):
        return None
    try:
        content = json.loads(line.removeprefix(_MARK))
        if "share" in content:
            return Step(float(content["share"]), str(content["doing"]))
        return Result(
            int(content["runs"]),
            tuple((str(name), str(why)) for name, why in content["failures"]),
            tuple(map(str, content["warnings"])),
            None if content["page"] is None else Path(content["page"]),
            tuple(Preview(name, base64.b64decode(png)) for name, png in content["previews"]),
        )
    except (ValueError, TypeError, LookupError):
        return None


class Steps:
    """Counts what is done of a run, in parts of some weight; may be called from any thread.

    Parameters
    ----------
    write : callable
        Takes a `Step`, ten times a second at most.
    """

    def __init__(self, write: Callable[[Step], object]) -> None:
        self._write = write
        self._lock = threading.Lock()
        self._all, self._done, self._weight = 1.0, 0.0, 0.0
        self._nodes = 0
        self._seen: set[str] = set()
        self._name = ""
        self._last = -_INTERVAL_S

    def expect(self, weight: float) -> None:
        """The weight of all parts to come."""
        self._all = max(weight, 1e-9)

    def part(self, name: str, *, nodes: int = 0, weight: float = 1.0) -> None:
        """A part begins; the one before is done.

        Its share is counted by the nodes that have begun, of so many, or else by `piece`.
        """
        with self._lock:
            self._done += self._weight
            self._weight, self._name, self._nodes, self._seen = weight, name, nodes, set()
        self._report(0.0, "")

    def node(self, name: str | None) -> None:
        """A node is about to compute."""
        with self._lock:
            counts = bool(name) and self._nodes > 0
            if name and counts:
                self._seen.add(name)
            share = len(self._seen) / (self._nodes + 1)
        if counts:
            self._report(share, name or "")

    def piece(self, number: int, of: int) -> None:
        """So many pieces of the part are done."""
        self._report(number / of, f"{number} of {of}")

    def _report(self, share: float, doing: str) -> None:
        with self._lock:
            now = time.monotonic()
            if now - self._last < _INTERVAL_S:
                return
            self._last = now
            whole = min(1.0, (self._done + min(share, 1.0) * self._weight) / self._all)
            name = self._name
        self._write(Step(whole, " · ".join(filter(None, (name, doing)))))
