"""A study's rows by the workers of a Dask cluster, of this machine or of others."""

from __future__ import annotations

import contextlib
import logging
import pickle
import signal
import threading
import time
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace
from multiprocessing import resource_tracker
from typing import Any

from app.study.lanes import Lanes
from app.study.point_rows import Row, Task
from app.study.remote_batch import rows_there, sent_by_value
from app.study.study_request import Study
from core.errors import Cancelled, FileError, ImagechainError, UsageError
from core.evaluation.policy import Policy
from core.names import shown

MOST_DEATHS = 3
"""How many workers a point may end before it is the point's own fault."""
_LOOK_S = 0.5  # how often the workers are counted
_CONNECT_S = 10
_GATHER_S = 5  # for rows that are made, on their way here
_WITHOUT_S = 300.0  # how long a study waits for a worker: a busy machine starts one in a minute


def dask_rows(
    study: Study,
    tasks: Sequence[Task],
    jobs: int,
    scheduler: str,
    cancel: threading.Event | None = None,
) -> Generator[list[Row]]:
    """The rows of points, batch by batch; the first, empty one when there are workers.

    Parameters
    ----------
    study : Study
        What is wanted.
    tasks : sequence of Task
        The points, in order.
    jobs : int
        Processes of this machine.
    scheduler : str
        The address of a scheduler, in their place.
    cancel : threading.Event, optional
        Set to stop.

    Raises
    ------
    FileError
        If the scheduler, or the last worker, is gone.
    """
    with _silent(), contextlib.ExitStack() as stack:
        client = stack.enter_context(_connected(jobs, scheduler))
        yield []
        dealer = _Dealer(client, study, tasks, jobs=0 if scheduler else jobs)
        try:
            yield from dealer.rows(cancel)
        finally:
            dealer.forget()


class _Dealer:
    """Hands batches to workers and takes their rows.

    Each batch is for one worker alone, so that it is known which ones a worker had that ends. Their
    points go out once more, one at a time with no other beside them, and a point that ends its
    worker again and again gets that as its error.
    """

    def __init__(self, client: Any, study: Study, tasks: Sequence[Task], *, jobs: int) -> None:
        self._client, self._key = client, study.key
        self._jobs, self._policy = jobs, study.policy
        self._function = sent_by_value(rows_there)
        self._study = study
        self._lanes = Lanes(tasks)
        self._suspects: list[Task] = []
        self._deaths: Counter[int] = Counter()
        self._flying: dict[Any, tuple[str, list[Task]]] = {}
        self._landed = threading.Event()
        self._ended: set[str] = set()
        self._threads: dict[str, int] = {}
        self._share = 1
        self._setting = b""

    def rows(self, cancel: threading.Event | None) -> Iterator[list[Row]]:
        """The rows as they come."""
        looked, seen = 0.0, time.monotonic()
        while self._lanes.left or self._suspects or self._flying:
            now = time.monotonic()
            if now > looked + _LOOK_S:
                self._look()
                looked = now
            seen = now if self._threads else seen
            if now > seen + _WITHOUT_S:
                raise FileError(f"the scheduler {self._address()} has no workers")
            convicted = self._convicted()
            if convicted:
                yield convicted
            self._hand_out()
            if cancel is not None and cancel.is_set():
                raise Cancelled("stopped on request")
            self._landed.wait(0.1)
            self._landed.clear()
            # Looked at, not waited for: Dask calls nobody for what is lost with its worker.
            for future in [future for future in self._flying if future.status != "pending"]:
                rows = self._taken(future)
                if rows:
                    yield rows

    def forget(self) -> None:
        """Give up what is not done."""
        with contextlib.suppress(Exception):
            self._client.cancel(list(self._flying), force=True)

    def _look(self) -> None:
        """Count the workers."""
        self._check()
        try:
            workers = self._client.scheduler_info(n_workers=-1)["workers"]
        except Exception as error:
            raise self._gone() from error
        workers = {name: info for name, info in workers.items() if name not in self._ended}
        self._threads = {name: info["nthreads"] for name, info in workers.items()}
        hosts = Counter(info.get("host", "") for info in workers.values())
        share = self._jobs or max(
            (hosts[info.get("host", "")] * info["nthreads"] for info in workers.values()), default=1
        )
        if not self._setting:
            # The engine's threads beside those of the other processes would only be in their way.
            threads = self._policy.threads or max(1, Policy().workers // share if self._jobs else 1)
            setting = self._study.setting(replace(self._policy, threads=threads))
            self._setting, self._share = pickle.dumps(setting), share
        self._lanes.workers(self._threads)
        lost = [future for future, (worker, _) in self._flying.items() if worker not in workers]
        for future in lost:
            if future.status == "pending":
                worker, batch = self._flying.pop(future)
                self._give_up(future)
                self._blame(worker, batch)

    def _hand_out(self) -> None:
        flying = Counter(worker for worker, _ in self._flying.values())
        for worker, threads in self._threads.items():
            # One more than it can compute, so that it never waits for the way there and back.
            while flying[worker] < threads + 1 and self._lanes.left:
                batch = self._lanes.batch(worker)
                self._send(worker, batch)
                flying[worker] += 1
            if not self._lanes.left and self._suspects and not flying[worker]:
                self._send(worker, [self._suspects.pop()])
                flying[worker] += 1

    def _send(self, worker: str, batch: list[Task]) -> None:
        if not batch:
            return
        try:
            future = self._client.submit(
                self._function,
                self._setting,
                self._key,
                batch,
                self._share,
                workers=[worker],
                pure=False,
            )
        except Exception as error:
            raise self._gone() from error
        self._flying[future] = worker, batch
        future.add_done_callback(lambda _: self._landed.set())

    def _taken(self, future: Any) -> list[Row]:
        """The rows of a batch that has come back, if it has any, and of points given up."""
        from distributed import KilledWorker

        worker, batch = self._flying.pop(future)
        if future.status != "finished":
            self._check()
        try:
            rows = [Row(*row) for row in future.result(timeout=_GATHER_S)]
        except KilledWorker:
            self._blame(worker, batch)
            return []
        except ImagechainError:
            raise
        except ImportError as error:
            raise UsageError(
                f"a worker cannot load imagechain: {error}; it must be installed there"
            ) from error
        except Exception as error:
            self._check()
            if future.status == "error":
                what = f"{type(error).__name__}: {error}"
                raise FileError(f"a worker failed: {what}") from error
            # Made, and lost with the worker before it came here, or the scheduler began anew.
            self._give_up(future)
            self._suspects += batch
            return []
        self._lanes.took(sum(row.seconds for row in rows), len(rows))
        return rows

    def _blame(self, worker: str, batch: list[Task]) -> None:
        """A worker has ended with this batch: each of its points may be why."""
        self._ended.add(worker)
        self._threads.pop(worker, None)
        for task in batch:
            self._deaths[task[0]] += 1
            self._suspects.append(task)

    def _convicted(self) -> list[Row]:
        """The rows of points that have ended too many workers."""
        wanted = [task for task in self._suspects if self._deaths[task[0]] >= MOST_DEATHS]
        self._suspects = [task for task in self._suspects if task not in wanted]
        why = f"its worker ended without a word, {MOST_DEATHS} times"
        nothing = (None,) * len(self._study.figures)
        return [Row(task[0], nothing, "", 0.0, why) for task in wanted]

    def _give_up(self, future: Any) -> None:
        with contextlib.suppress(Exception):
            self._client.cancel([future], force=True)

    def _check(self) -> None:
        if self._client.status != "running":
            raise self._gone()

    def _gone(self) -> FileError:
        return FileError(f"the scheduler {self._address()} is gone")

    def _address(self) -> str:
        scheduler = self._client.scheduler
        return shown(scheduler.address if scheduler is not None else "")


@contextlib.contextmanager
def _connected(jobs: int, scheduler: str) -> Iterator[Any]:
    """A client of a scheduler, or of one with workers of its own."""
    import dask
    import distributed

    settings = {
        # A batch that ends its worker is looked into at once, point by point.
        "distributed.scheduler.allowed-failures": 0,
        "distributed.scheduler.work-stealing": False,
        "distributed.comm.timeouts.connect": f"{_CONNECT_S}s",
        "distributed.worker.memory.terminate": False,
        "logging": {"distributed": "critical", "tornado": "critical", "asyncio": "critical"},
    }
    given: Any = distributed  # its constructors have no types
    with dask.config.set(settings), contextlib.ExitStack() as stack:
        place: Any = scheduler
        if not scheduler:
            with _left_to_us():
                cluster = given.LocalCluster(
                    n_workers=jobs,
                    threads_per_worker=1,
                    processes=True,
                    memory_limit=0,
                    # Any port: a cluster of the user's may have the usual one.
                    dashboard_address="127.0.0.1:0",
                    scheduler_kwargs={"dashboard": False},
                    silence_logs=logging.CRITICAL,
                )
            place = stack.enter_context(cluster)
        try:
            client = given.Client(
                place, timeout=_CONNECT_S, set_as_default=False, name="imagechain"
            )
        except (OSError, ValueError, TypeError) as error:
            raise UsageError(
                f"--scheduler {scheduler:.120}: no Dask scheduler answers there"
            ) from error
        yield stack.enter_context(client)


def check_address(scheduler: str) -> None:
    """Refuse what is no address: a client of it would go on trying in the background.

    Raises
    ------
    UsageError
        Saying what is one.
    """
    from distributed.comm.addressing import parse_host_port
    from distributed.comm.registry import backends

    protocol, parted, place = scheduler.rpartition("://")
    try:
        host, port = parse_host_port(place)
        sound = bool(host) and 0 < port < 65536 and (not parted or protocol in backends)
    except ValueError:
        sound = False
    if not sound:
        known = ", ".join(sorted(backends))
        raise UsageError(
            f"--scheduler {scheduler:.120}: write HOST:PORT or PROTOCOL://HOST:PORT; protocols are "
            f"{known}"
        )


@contextlib.contextmanager
def _left_to_us() -> Iterator[None]:
    """Start processes that Ctrl-C, which a terminal sends to all, does not reach.

    They inherit the mask of the thread that starts them, and that its own maker's. A signal that
    comes meanwhile reaches this process afterwards.
    """
    change = getattr(signal, "pthread_sigmask", None)  # Windows has none
    if change is None:
        yield
        return
    resource_tracker.ensure_running()  # which would lift the mask when the first process starts
    before = change(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        change(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep what Dask logs off the terminal: what matters comes as an error of ours."""
    import distributed  # noqa: F401  (gives each of its loggers a level)

    ours = ("distributed", "tornado", "asyncio")
    known = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] in ours]
    loggers = [logging.getLogger(name) for name in {*known, *ours}]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
