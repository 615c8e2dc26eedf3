"""What a command leaves: files, all or none; what it prints; a progress bar while it takes long."""

import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Self, TypeVar

from app.run.process import too_late
from app.run.readout_tables import json_text
from core.errors import Cancelled

Made = TypeVar("Made")
PATIENCE_S = 0.7


def written(
    outputs: Sequence[Path],
    inputs: Iterable[Path],
    stop: threading.Event,
    make: Callable[[], Made],
    content: Callable[[Made, Path], str | bytes],
) -> Made:
    """Make a result, and write what each file is to hold; files are reserved before any work."""
    from app.run.staging import Staging  # which takes numpy to load

    with Staging(None, inputs) as staging:
        for path in outputs:
            staging.claim(path)
        made = make()
        for path in outputs:
            staging.write(path, partial(write_content, content=content(made, path)))
        check_stop(stop)
        too_late(stop)
        staging.commit()
    return made


def write_content(path: Path, content: str | bytes) -> None:
    from core.atomic import write_bytes, write_text  # only where files are written

    if isinstance(content, bytes):
        write_bytes(path, content)
    else:
        write_text(path, content)


def check_stop(stop: threading.Event) -> None:
    if stop.is_set():
        raise Cancelled("stopped on request")


def say(json: object, *lines: str) -> None:
    """Print lines for people; none where the result is printed as JSON."""
    if lines and json is not True:
        print("\n".join(lines), flush=True)


def show(json: object, facts: Callable[[], Any], *lines: str) -> None:
    """Print the result of a command: as JSON where `json` is True, else in lines."""
    say(json, *lines)
    if json is True:
        print(json_text(facts()), end="", flush=True)


class Progress:
    """Shows which node computes; silent where stderr is no terminal."""

    def __init__(self, total: int, *, time_left: bool = False) -> None:
        self._total = total
        self._time_left = time_left
        self._start = time.perf_counter()
        self._seen: set[str] = set()
        self._bar: Any = None
        self._task: Any = None
        self._wanted = sys.stderr is not None and sys.stderr.isatty()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, node: str | None) -> None:
        if node:
            self._seen.add(node)
        self.reach(len(self._seen), node or "")

    def reach(self, done: int, text: str) -> None:
        if not self._wanted:
            return
        if self._bar is None:
            if time.perf_counter() - self._start < PATIENCE_S:
                return
            self._begin()
        self._bar.update(self._task, completed=done, description=text)

    def _begin(self) -> None:
        from rich import progress
        from rich.console import Console

        self._bar = progress.Progress(
            progress.BarColumn(),
            progress.MofNCompleteColumn(),
            *([progress.TimeRemainingColumn()] if self._time_left else []),
            progress.TextColumn("{task.description}", markup=False),
            console=Console(stderr=True),
            transient=True,  # stderr is for one line of error
        )
        self._task = self._bar.add_task("", total=self._total)
        self._bar.start()
