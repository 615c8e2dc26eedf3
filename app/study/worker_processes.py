"""Points dealt out in batches, and processes of this machine, reached over private pipes."""

from __future__ import annotations

import contextlib
import pickle
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from app.run.shipped import command, environment
from app.study.point_rows import Row, Setting, Task
from core.errors import Cancelled, FileError

_STARTS = 3  # attempts at a process that ends before it can compute
_END_S = 5.0  # for a process to remove what it has half written
_ENDED = (EOFError, OSError, pickle.UnpicklingError)
# A process is one thread of work: those of BLAS beside it are in its way. Memory that is let go
# stays with the process: given back, its pages are cleared anew for each picture.
_VARIABLES = {
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "MALLOC_TRIM_THRESHOLD_": str(1 << 28),
}
_MOST = 500  # points of a batch
_LOOK_S = 0.1


class WorkerEnded(Exception):
    """Who had a batch ended before it was done."""


class Workers:
    lanes: int  # how many stretches the points are parted into
    most_ends: int  # of workers within a point, before it is the point's own fault
    why: str  # the error of such a point

    def free(self, busy: Sequence[int]) -> Iterable[int]:
        """Lanes that can take one more batch; `busy` has the lane of each that is out."""
        return {*range(self.lanes)} - {*busy}

    def submit(self, lane: int, batch: list[Task]) -> Any:
        """A future of the rows of the batch's first points."""
        raise NotImplementedError

    def has_ended(self, future: Any) -> bool:
        return bool(future.done())

    def rows(self, future: Any) -> list[Row]:
        rows: list[Row] = future.result()
        return rows


class _Lanes:
    """A stretch of the points for each worker; who has come to its end takes half of another's.

    So neighbours share what is known. A batch grows as long as a worker does all of it in time.
    """

    def __init__(self, tasks: Sequence[Task], workers: int) -> None:
        each = -(-len(tasks) // workers) or 1
        self._stretches = [list(tasks[n * each : (n + 1) * each]) for n in range(workers)]
        self._size = 1

    @property
    def left(self) -> int:
        return sum(map(len, self._stretches))

    def batch(self, worker: int) -> list[Task]:
        if not self._stretches[worker]:
            longest = max(self._stretches, key=len)
            half = len(longest) // 2
            self._stretches[worker] = longest[half:]
            del longest[half:]
        stretch = self._stretches[worker]
        # Towards the end in smaller ones, so that all workers end together.
        size = min(self._size, -(-len(stretch) // 2))
        batch = stretch[:size]
        del stretch[:size]
        return batch

    def done(self, worker: int, batch: list[Task], rows: int) -> None:
        """So many of a batch's points are done; the others go back."""
        self._stretches[worker][:0] = batch[rows:]
        if batch:
            self._size = min(2 * rows, _MOST) if rows == len(batch) else max(1, rows)


def dealt_rows(
    workers: Workers, tasks: Sequence[Task], figures: int, cancel: threading.Event | None
) -> Iterator[list[Row]]:
    """The rows of points as they come; empty ones when workers are ready.

    The points of a worker that has ended are tried again once all others are done, one at a time
    with nothing beside them: it shows which it was, and one may need all of the memory.
    """
    lanes, again, ends = _Lanes(tasks, workers.lanes), list[Task](), Counter[int]()
    out: dict[Any, tuple[int, list[Task]]] = {}
    landed = threading.Event()

    def send(lane: int, batch: list[Task]) -> None:
        future = workers.submit(lane, batch)
        out[future] = lane, batch
        future.add_done_callback(lambda _: landed.set())

    for lane in range(workers.lanes):
        send(lane, [])
    while lanes.left or again or out:
        for lane in workers.free([lane for lane, _ in out.values()]):
            if lanes.left:
                send(lane, lanes.batch(lane))
        if again and not out and not lanes.left:
            send(0, [again.pop()])
        if cancel is not None and cancel.is_set():
            raise Cancelled("stopped on request")
        landed.wait(_LOOK_S)
        landed.clear()
        # Looked at, not waited for: Dask calls nobody for what is lost with its worker.
        for future in [future for future in out if workers.has_ended(future)]:
            lane, batch = out.pop(future)
            try:
                rows = workers.rows(future)
            except WorkerEnded:
                ends.update(task[0] for task in batch)
                if len(batch) == 1 and ends[batch[0][0]] >= workers.most_ends:
                    yield [Row(batch[0][0], (None,) * figures, "", 0.0, workers.why)]
                else:
                    again += batch
            else:
                lanes.done(lane, batch, len(rows))
                yield rows


# The processes of this machine.


def process_rows(
    setting: Setting, tasks: Sequence[Task], jobs: int, cancel: threading.Event | None = None
) -> Generator[list[Row]]:
    """The rows of points as they come; the first, empty list when a process is ready."""
    jobs = min(jobs, len(tasks))
    processes = _Processes(pickle.dumps((setting, jobs)), jobs)
    try:
        yield from dealt_rows(processes, tasks, len(setting.figures), cancel)
    finally:
        processes.end()


class _Processes(Workers):
    most_ends = 3
    why = f"the process computing this point stopped {most_ends} times"

    def __init__(self, first: bytes, count: int) -> None:
        self.lanes = count
        self._processes = [_Process(first) for _ in range(count)]
        self._threads = ThreadPoolExecutor(count)

    def submit(self, lane: int, batch: list[Task]) -> Future[list[Row]]:
        return self._threads.submit(self._processes[lane].rows, batch)

    def end(self) -> None:
        """Let all of them end in order, where they still listen, and start none again."""
        for process in self._processes:
            process.stop()
        for process in self._processes:
            process.end()
        self._threads.shutdown()
        for process in self._processes:
            process.drop()


class _Process:
    def __init__(self, first: bytes) -> None:
        self._first = first
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = False

    def rows(self, batch: list[Task]) -> list[Row]:
        if self._process is None:
            self._begin()
        try:
            rows: list[Row] = self._answer(pickle.dumps(batch))
        except _ENDED as error:
            self.drop()
            raise WorkerEnded from error
        return rows

    def stop(self) -> None:
        self._stopped = True
        self._hang_up()

    def end(self) -> int | None:
        process = self._process
        if process is None:
            return None
        self._hang_up()
        try:
            return process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            return process.wait()

    def drop(self) -> int | None:
        code = self.end()
        if self._process is not None and self._process.stdout is not None:
            self._process.stdout.close()
        self._process = None
        return code

    def _hang_up(self) -> None:
        if self._process is not None and self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()

    def _begin(self) -> None:
        code: int | None = None
        for _ in range(_STARTS):
            # A group of its own: Ctrl-C, which a terminal sends to all of a group, is for the
            # process that knows what to keep.
            self._process = subprocess.Popen(
                command("app.study.worker_rows"), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, env={**environment(), **_VARIABLES},
                process_group=None if sys.platform == "win32" else 0,
            )  # fmt: skip
            if self._stopped:
                raise Cancelled("stopped on request")
            try:
                self._answer(self._first)
            except _ENDED:
                code = self.drop()
            else:
                return
        raise FileError(f"a process of the study stopped while starting (exit code {code})")

    def _answer(self, request: bytes) -> Any:
        process = self._process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(request)
        process.stdin.flush()
        answer = pickle.load(process.stdout)
        if isinstance(answer, str):
            raise FileError(f"a process of the study failed: {answer}")
        return answer
