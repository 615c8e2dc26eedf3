"""A progress bar on a terminal, once work takes long."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

PATIENCE_S = 0.7


class Progress:
    """Shows which node computes; silent where stderr is no terminal.

    Parameters
    ----------
    total : int
        Number of nodes.
    """

    def __init__(self, total: int) -> None:
        self._total = total
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
        """Show that `node` is about to compute."""
        if not self._wanted:
            return
        if node:
            self._seen.add(node)
        if self._bar is None:
            if time.perf_counter() - self._start < PATIENCE_S:
                return
            self._begin()
        self._bar.update(self._task, completed=len(self._seen), description=node or "")

    def _begin(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

        self._bar = Progress(
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.description}", markup=False),
            console=Console(stderr=True),
            transient=True,  # stderr is for one line of error
        )
        self._task = self._bar.add_task("", total=self._total)
        self._bar.start()
