"""A study's rows by processes of this machine, over pipes that no other user can open."""

from __future__ import annotations

import contextlib
import pickle
import queue
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Generator, Sequence
from typing import Any

from app.run.shipped import command, environment
from app.study.dask_study import Lanes
from app.study.point_rows import Row, Setting, Task
from core.errors import Cancelled, FileError
from core.modules.declaration import Library
from core.network.network import Network

MOST_DEATHS = 3
"""How many processes a point may end before it is the point's own fault."""
_STARTS = 3  # attempts at a process that ends before it can compute
_END_S = 5.0  # for a process to remove what it has half written
_POLL_S = 0.1
# A process is one thread of work: those of BLAS beside it are in its way. Memory that is let go
# stays with the process: given back, its pages are cleared anew for each picture.
_VARIABLES = {
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "MALLOC_TRIM_THRESHOLD_": str(1 << 28),
}
_Answers = queue.SimpleQueue[list[Row] | Exception | None]


def process_rows(
    setting: Setting,
    library: Library,
    tasks: Sequence[Task],
    jobs: int,
    cancel: threading.Event | None = None,
) -> Generator[list[Row]]:
    """The rows of points as they come; the first, empty list when a process is ready."""
    jobs = min(jobs, len(tasks))
    points, answers = _Points(tasks, jobs), _Answers()
    first = pickle.dumps((setting, jobs, _needed(library, setting.network)))
    workers = [_Worker(n, first, len(setting.figures), points, answers) for n in range(jobs)]
    for worker in workers:
        worker.start()
    try:
        running = jobs
        while running:
            if cancel is not None and cancel.is_set():
                raise Cancelled("stopped on request")
            with contextlib.suppress(queue.Empty):
                answer = answers.get(timeout=_POLL_S)
                if isinstance(answer, Exception):
                    raise answer
                running -= answer is None
                if answer is not None:
                    yield answer
    finally:
        points.close()
        for worker in workers:
            worker.stop()
        for worker in workers:
            worker.join()


def _needed(library: Library, network: Network) -> Library | None:
    """The network's own modules, as a process starts in half the time without all the others.

    None where a package has made the class of one at run time: a process asks that package then.
    """
    keys = {node.module for node in network.nodes.values()}
    modules = {key: library[key] for key in keys if key in library}
    for module in modules.values():
        if getattr(sys.modules.get(module.__module__), module.__qualname__, None) is not module:
            return None
    return modules


class _Points:
    """Points to be handed out to threads.

    When a process ends, the points that it had are tried again once all others are done, one at a
    time with nothing beside them: it shows which it was, and one may need all of the memory.
    """

    def __init__(self, tasks: Sequence[Task], workers: int) -> None:
        self._lanes = Lanes(tasks, workers)
        self._changed = threading.Condition()
        self._again: list[Task] = []
        self._deaths: Counter[int] = Counter()
        self._busy = 0
        self._closed = False

    def take(self, worker: int) -> list[Task]:
        """The next points of a worker, as soon as there are some; none when all are done."""
        with self._changed:
            while not self._closed:
                if self._lanes.left:
                    self._busy += 1
                    return self._lanes.batch(worker)
                if not self._busy:
                    self._busy += bool(self._again)
                    return [self._again.pop()] if self._again else []
                self._changed.wait()
            return []

    def done(self, rows: Sequence[Row]) -> None:
        with self._changed:
            self._busy -= 1
            self._lanes.took(sum(row.seconds for row in rows), len(rows))
            self._changed.notify_all()

    def lost(self, tasks: Sequence[Task]) -> Task | None:
        """A process has ended before these were done; the point that is given up, if one is."""
        with self._changed:
            self._busy -= 1
            self._changed.notify_all()
            self._deaths.update(task[0] for task in tasks)
            if len(tasks) == 1 and self._deaths[tasks[0][0]] >= MOST_DEATHS:
                return tasks[0]
            self._again += tasks
            return None

    def close(self) -> None:
        """Hand out no more."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class _Worker(threading.Thread):
    """A thread that has a process compute batches, and starts another one where that ends."""

    def __init__(
        self, number: int, first: bytes, figures: int, points: _Points, answers: _Answers
    ) -> None:
        super().__init__(daemon=True)
        self._number, self._points, self._answers = number, points, answers
        self._first, self._nothing = first, (None,) * figures
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()
        self._stopped = False

    def run(self) -> None:
        """Compute until all points are done."""
        try:
            self._begin()
            self._answers.put([])
            while batch := self._points.take(self._number):
                self._compute(batch)
            self._answers.put(None)
        except Exception as error:
            self._answers.put(error)
        finally:
            self._end()
            self._close_answers()

    def stop(self) -> None:
        """End the process."""
        with self._lock:
            self._stopped = True
        self._end()

    def _compute(self, batch: list[Task]) -> None:
        rows: list[Row] = []
        try:
            self._send(pickle.dumps(batch))
            while len(rows) < len(batch):
                new = self._received()
                rows += new
                self._answers.put(new)
        except (EOFError, OSError, pickle.UnpicklingError):
            self._end()
            given_up = self._points.lost(batch[len(rows) :])
            if given_up is not None:
                why = f"the process that computes it ended, {MOST_DEATHS} times"
                self._answers.put([Row(given_up[0], self._nothing, "", 0.0, why)])
            self._begin()
        else:
            self._points.done(rows)

    def _begin(self) -> None:
        code: int | None = None
        for _ in range(_STARTS):
            with self._lock:
                self._close_answers()
                if self._stopped:
                    return
                # A group of its own: Ctrl-C, which a terminal sends to all of a group, is for
                # the process that knows what to keep.
                self._process = subprocess.Popen(
                    command("app.study.worker_rows"), stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                    env={**environment(), **_VARIABLES},
                    process_group=None if sys.platform == "win32" else 0,
                )  # fmt: skip
            try:
                self._send(self._first)
                self._received()
            except (EOFError, OSError, pickle.UnpicklingError):
                code = self._end()
            else:
                return
        raise FileError(f"a process of the study ends as it begins (exit code {code})")

    def _send(self, data: bytes) -> None:
        assert self._process is not None
        assert self._process.stdin is not None
        self._process.stdin.write(data)
        self._process.stdin.flush()

    def _received(self) -> Any:
        assert self._process is not None
        assert self._process.stdout is not None
        answer = pickle.load(self._process.stdout)
        if isinstance(answer, str):
            raise FileError(f"a process of the study failed: {answer}")
        return answer

    def _close_answers(self) -> None:
        if self._process is not None and self._process.stdout is not None:
            self._process.stdout.close()

    def _end(self) -> int | None:
        """End the process: in order, where it still listens."""
        with self._lock:
            process = self._process
        if process is None:
            return None
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            process.stdin.close()
        try:
            return process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            return process.wait()
