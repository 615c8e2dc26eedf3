"""A study's rows by the workers of a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import pickle
import threading
import time
import types
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from typing import Any

from app.study.point_rows import Row, Setting, Task
from app.study.worker_processes import WorkerEnded, Workers, dealt_rows
from core.errors import FileError, ImagechainError, UsageError
from core.names import shown

_AHEAD = 2  # batches for each thread: it never waits for the way there and back
_LOOK_S = 0.5  # how often the workers are counted
_CONNECT_S = 10
_GATHER_S = 5  # for rows that are made, on their way here
_WITHOUT_S = 300.0  # how long a study waits for a worker: a busy machine starts one in a minute


def cluster_rows(
    setting: Setting,
    key: str,
    tasks: Sequence[Task],
    scheduler: Any,
    tls: Sequence[str] = (),
    cancel: threading.Event | None = None,
) -> Generator[list[Row]]:
    """The rows of points, batch by batch; the first, empty one when a worker is ready."""
    with _silent(), _connected(scheduler, tls) as client:
        cluster = _Cluster(client, setting, key)
        try:
            yield from dealt_rows(cluster, tasks, len(setting.figures), cancel)
        finally:
            with contextlib.suppress(Exception):
                client.cancel(list(cluster.out), force=True)


class _Cluster(Workers):
    """The workers of a scheduler, which gives the batches of a lost one to another."""

    lanes = 1
    most_ends = 2  # of what the scheduler gives up, each time after several workers
    why = "the workers that computed it stopped again and again"

    def __init__(self, client: Any, setting: Setting, key: str) -> None:
        self.out: set[Any] = set()
        self._client, self._key = client, key
        self._function = by_value(rows_there)
        self._setting = pickle.dumps(setting)
        self._looked, self._seen = 0.0, time.monotonic()
        self._threads, self._share = 0, 1

    def free(self, busy: Sequence[int]) -> list[int]:
        now = time.monotonic()
        if now > self._looked + _LOOK_S:
            self._look()
            self._looked = now
        self._seen = now if self._threads else self._seen
        if now > self._seen + _WITHOUT_S:
            raise FileError(f"the scheduler {self._address()} has no workers")
        return [0] * (_AHEAD * self._threads - len(busy))

    def submit(self, _lane: int, batch: list[Task]) -> Any:
        try:
            future = self._client.submit(
                self._function, self._setting, self._key, batch, self._share, pure=False
            )
        except Exception as error:
            raise self._gone() from error
        self.out.add(future)
        return future

    def has_ended(self, future: Any) -> bool:
        return bool(future.status != "pending")

    def rows(self, future: Any) -> list[Row]:
        from distributed import KilledWorker

        self.out.discard(future)
        if future.status != "finished":
            self._check()
        try:
            return [Row(*row) for row in future.result(timeout=_GATHER_S)]
        except KilledWorker as error:
            raise WorkerEnded from error
        except ImagechainError:
            raise
        except ImportError as error:
            raise UsageError(
                f"a worker cannot load imagechain: {error}; install it there"
            ) from error
        except Exception as error:
            self._check()
            if future.status == "error":
                what = f"{type(error).__name__}: {error}"
                raise FileError(f"a worker failed: {what}") from error
            # Made, and lost with the worker before it came here, or the scheduler began anew.
            with contextlib.suppress(Exception):
                self._client.cancel([future], force=True)
            raise WorkerEnded(blamed=False) from error

    def _look(self) -> None:
        self._check()
        try:
            workers = self._client.scheduler_info(n_workers=-1)["workers"].values()
        except Exception as error:
            raise self._gone() from error
        hosts: Counter[str] = Counter()
        for info in workers:
            hosts[info.get("host", "")] += info["nthreads"]
        self._threads = hosts.total()
        self._share = max(hosts.values(), default=1)

    def _check(self) -> None:
        if self._client.status != "running":
            raise self._gone()

    def _gone(self) -> FileError:
        return FileError(f"the scheduler {self._address()} no longer answers")

    def _address(self) -> str:
        scheduler = self._client.scheduler
        return shown(scheduler.address if scheduler is not None else "")


@contextlib.contextmanager
def _connected(scheduler: Any, tls: Sequence[str]) -> Iterator[Any]:
    """A client of a scheduler; one that was given stays open."""
    import dask
    import distributed

    if not isinstance(scheduler, str):
        yield scheduler
        return
    given: Any = distributed  # its constructors have no types
    settings = {
        "distributed.comm.timeouts.connect": f"{_CONNECT_S}s",
        "logging": {"distributed": "critical", "tornado": "critical", "asyncio": "critical"},
    }
    words: dict[str, Any] = {}
    if tls:
        ca, certificate, private = tls
        words["security"] = given.Security(
            tls_ca_file=ca, tls_client_cert=certificate, tls_client_key=private,
            require_encryption=True,
        )  # fmt: skip
    with dask.config.set(settings), contextlib.ExitStack() as stack:
        try:
            client = given.Client(
                scheduler, timeout=_CONNECT_S, set_as_default=False, name="imagechain", **words
            )
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise UsageError(
                f"--scheduler {scheduler:.120}: no Dask scheduler answers there"
                + (", or not with these certificates" if tls else "")
            ) from error
        yield stack.enter_context(client)


def check_address(scheduler: str, tls: Sequence[str]) -> None:
    """Refuse what is no address: a client of it would go on trying in the background."""
    from distributed import Security
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
    if tls and protocol not in ("tls", "wss"):
        raise UsageError(
            f"--scheduler {scheduler:.120}: certificates need the address tls://HOST:PORT of a "
            "scheduler started with --tls-ca-file, --tls-cert and --tls-key"
        )
    made: Any = Security
    if protocol in ("tls", "wss") and not tls and made().tls_client_cert is None:
        raise UsageError(
            f"--scheduler {scheduler:.120}: give the files that the scheduler was started with, "
            "as --tls-ca-file, --tls-cert and --tls-key"
        )


def by_value(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function as one that is pickled with its code, as those of a user's own script are.

    A worker that was started beside a folder named `core` or `app` finds that in the place of
    ours: code that is sent can look in other places first, a reference to a module cannot.
    """
    copy = types.FunctionType(function.__code__, {"__builtins__": __builtins__}, function.__name__)
    copy.__module__ = "__main__"
    return copy


def rows_there(setting: bytes, key: str, tasks: Any, share: int) -> Any:
    """The rows of a batch, on a worker; what it imports is all it knows there."""
    import importlib
    import os
    import sys

    # Python and the worker's own start look in the current folder first.
    here = {"", os.getcwd()}  # noqa: PTH109
    path = list(sys.path)
    try:
        if "app.study.worker_rows" not in sys.modules:
            sys.path[:] = [entry for entry in path if entry not in here]
            for name in ("core", "nodes", "app", "networks"):
                try:
                    importlib.import_module(name)
                except ModuleNotFoundError:  # it runs from a source tree, and is not installed
                    sys.path[:] = path
        from app.study.worker_rows import rows_of_batch
    finally:
        sys.path[:] = path
    return rows_of_batch(setting, key, tasks, share)


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
