"""A progress bar on a terminal, once work takes long."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

PATIENCE_S = 0.7


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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
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
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeRemainingColumn,
        )

        self._bar = Progress(
            BarColumn(),
            MofNCompleteColumn(),
            *([TimeRemainingColumn()] if self._time_left else []),
            TextColumn("{task.description}", markup=False),
            console=Console(stderr=True),
            transient=True,  # stderr is for one line of error
        )
        self._task = self._bar.add_task("", total=self._total)
        self._bar.start()
