"""A study's points dealt out in batches to processes of this machine, or to a Dask cluster."""

import contextlib
import gc
import logging
import os
import pickle
import queue
import subprocess
import sys
import threading
import time
import warnings
from collections import Counter
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, BinaryIO

from app.run.terminal import command, environment
from app.study.study_rows import WITH_TLS, Row, RowMaker, Setting, Task
from core.errors import Cancelled, FileError, ImagechainError, UsageError, shown
from nodes.library import standard_library

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
    workers: "_Processes | _Cluster",
    tasks: Sequence[Task],
    figures: int,
    cancel: threading.Event | None,
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
            rows = workers.rows(future)
            if rows is None:  # who had the batch ended before it was done
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


class _Processes:
    most_ends = 3  # of workers within a point, before it is the point's own fault
    why = f"the process computing this point stopped {most_ends} times"
    has_ended, rows = staticmethod(Future.done), staticmethod(Future.result)

    def __init__(self, first: bytes, count: int) -> None:
        self.lanes = count  # how many stretches the points are parted into
        self._processes = [_Process(first) for _ in range(count)]
        self._threads = ThreadPoolExecutor(count)

    def free(self, busy: Sequence[int]) -> Iterable[int]:
        """Lanes that can take one more batch; `busy` has the lane of each that is out."""
        return {*range(self.lanes)} - {*busy}

    def submit(self, lane: int, batch: list[Task]) -> Future[list[Row] | None]:
        """A future of the rows of the batch's first points; of None if the process ends."""
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

    def rows(self, batch: list[Task]) -> list[Row] | None:
        if self._process is None:
            self._begin()
        try:
            rows: list[Row] = self._answer(pickle.dumps(batch))
        except _ENDED:
            self.drop()
            return None
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
            words = command("app.study.worker_processes")
            self._process = subprocess.Popen(
                words, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
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


# The workers of a Dask cluster.

_AHEAD, _FEWEST = 2, 32  # batches out for each thread, and at least: more workers may come
_CONNECT_S = 10
_GATHER_S = 5  # for rows that are made, on their way here
_WITHOUT_S = 300.0  # how long a study waits for a worker: a busy machine starts one in a minute


def cluster_rows(
    setting: Setting,
    key: str,
    tasks: Sequence[Task],
    scheduler: Any,
    cancel: threading.Event | None = None,
) -> Generator[list[Row]]:
    """The rows of points, batch by batch; the first, empty one when a worker is ready."""
    with _silent(), _connected(scheduler) as client:
        cluster = _Cluster(client, setting, key)
        yield from dealt_rows(cluster, tasks, len(setting.figures), cancel)


class _Cluster:
    """The workers of a scheduler, which gives the batches of a lost one to another."""

    lanes = 1  # whoever is free takes the next points: each worker keeps what neighbours share
    most_ends = 2  # of what the scheduler gives up, each time after several workers
    why = "the workers computing this point stopped repeatedly"

    def __init__(self, client: Any, setting: Setting, key: str) -> None:
        self._client, self._words = client, (pickle.dumps(setting), key)
        try:
            client.wait_for_workers(1, timeout=_WITHOUT_S)
            workers = client.scheduler_info(n_workers=-1)["workers"].values()
        except Exception as error:
            self._check()
            raise FileError(f"the scheduler {self._address()} has no workers") from error
        hosts: Counter[str] = Counter()
        for info in workers:
            hosts[info.get("host", "")] += info["nthreads"]
        self._share = max(hosts.values(), default=1)
        self._most = max(_FEWEST, _AHEAD * hosts.total())

    def free(self, busy: Sequence[int]) -> list[int]:
        return [0] * (self._most - len(busy))

    def submit(self, _lane: int, batch: list[Task]) -> Any:
        self._check()
        return self._client.submit(rows_of_batch, *self._words, batch, self._share, pure=False)

    def has_ended(self, future: Any) -> bool:
        self._check()
        return bool(future.status != "pending")

    def rows(self, future: Any) -> list[Row] | None:
        from distributed import KilledWorker

        try:
            return [Row(*row) for row in future.result(timeout=_GATHER_S)]
        except KilledWorker:
            return None
        except ImagechainError:
            raise
        except ImportError as error:
            raise UsageError(
                f"a worker cannot load imagechain: {error}; install imagechain on the worker"
            ) from error
        except Exception as error:
            self._check()
            if future.status == "error":
                what = f"{type(error).__name__}: {error}"
                raise FileError(f"a worker failed: {what}") from error
            # Made, and lost with the worker before it came here, or the scheduler began anew.
            return None

    def _check(self) -> None:
        if self._client.status != "running":
            raise FileError(f"the scheduler {self._address()} no longer answers")

    def _address(self) -> str:
        scheduler = self._client.scheduler
        return shown(scheduler.address if scheduler is not None else "")


@contextlib.contextmanager
def _connected(scheduler: Any) -> Iterator[Any]:
    """A client of a scheduler; one that was given stays open."""
    import dask
    import distributed

    if not isinstance(scheduler, str):
        yield scheduler
        return
    given: Any = distributed  # its constructors have no types
    words: dict[str, Any] = {}
    if scheduler.startswith(WITH_TLS):  # the certificates are Dask's own settings
        words["security"] = given.Security(require_encryption=True)
    with dask.config.set({"distributed.comm.timeouts.connect": f"{_CONNECT_S}s"}):
        try:
            words |= {"timeout": _CONNECT_S, "set_as_default": False, "name": "imagechain"}
            client = given.Client(scheduler, **words)
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise UsageError(
                f"--scheduler {scheduler:.120}: no Dask scheduler answers at this address"
                + (", or the scheduler rejects these certificates" if "security" in words else "")
            ) from error
        with client:
            yield client


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep what Dask logs off the terminal: what matters comes as an error of ours."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(before)


# The rows of a study in a worker: a process of its own on this machine, or one of a cluster.

_NAME = "imagechain_studies"
_STUDIES = 2  # studies that a worker of a cluster remembers
_BATCH_S = 0.5  # longer than the way there and back, short enough to lose
_GRACE_S = 3.0  # for a point that is stopped to remove what it has half written


def main() -> None:
    """Compute what comes by standard input, rows to standard output, until that ends.

    Both are pipes to the process that started this one; it ends with them, even within a point.
    """
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what a library prints is no row
    gc.set_threshold(50_000, 10, 10)  # as the command itself
    warnings.simplefilter("ignore")
    cancel = threading.Event()
    received: queue.SimpleQueue[Any] = queue.SimpleQueue()
    requests = os.fdopen(os.dup(0), "rb")
    threading.Thread(target=_listen, args=(requests, received, cancel), daemon=True).start()
    try:
        first = received.get()
        if first is None:
            return
        if isinstance(first, Exception):
            raise first
        setting, share = first
        maker = RowMaker(setting, standard_library(), share)
        answers.write(pickle.dumps(None))
        while (batch := received.get()) is not None:
            answers.write(pickle.dumps(_first_rows(maker, batch, cancel)))
    except (Cancelled, BrokenPipeError):
        return
    except Exception as error:
        answers.write(pickle.dumps(f"{type(error).__name__}: {error}"))


def _listen(requests: BinaryIO, received: queue.SimpleQueue[Any], cancel: threading.Event) -> None:
    try:
        while True:
            received.put(pickle.load(requests))
    except (EOFError, OSError, pickle.UnpicklingError):
        cancel.set()
        received.put(None)
        time.sleep(_GRACE_S)
        os._exit(1)
    except Exception as error:  # a module's class that cannot be imported here
        received.put(error)


def _first_rows(
    maker: RowMaker, tasks: Iterable[Task], cancel: threading.Event | None = None
) -> list[Row]:
    """The rows of as many points, from the first on, as there is time for."""
    rows, end = [], time.monotonic() + _BATCH_S
    for task in tasks:
        rows.append(maker.row(task, cancel))
        if time.monotonic() > end:
            break
    return rows


def rows_of_batch(setting: bytes, key: str, tasks: list[Task], share: int) -> list[tuple[Any, ...]]:
    """Make rows on a worker of a Dask cluster, by its own engine and store for this study."""
    from distributed import get_worker

    from app.run.terminal import version

    known: dict[str, dict[int, RowMaker]] = vars(get_worker()).setdefault(_NAME, {})
    while len(known) >= _STUDIES and key not in known:
        del known[next(iter(known))]
    makers = known.setdefault(key, {})
    # A maker goes from point to point; threads of one worker have one each.
    thread = threading.get_ident()
    if thread not in makers:
        wanted: Setting = pickle.loads(setting)
        if wanted.version != version():
            raise UsageError(
                f"a worker has imagechain {version()}, and this machine has {wanted.version}: all "
                "machines must have the same version"
            )
        makers[thread] = RowMaker(wanted, standard_library(), share)
    return [tuple(row) for row in _first_rows(makers[thread], tasks)]


if __name__ == "__main__":
    main()
