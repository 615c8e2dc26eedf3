"""A study's rows by the workers of a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import pickle
import threading
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from typing import Any

from app.study.point_rows import Row, Setting, Task
from app.study.worker_processes import WorkerEnded, Workers, dealt_rows
from app.study.worker_rows import rows_of_batch
from core.errors import FileError, ImagechainError, UsageError, shown

_AHEAD, _FEWEST = 2, 32  # batches out for each thread, and at least: more workers may come
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
        yield from dealt_rows(cluster, tasks, len(setting.figures), cancel)


class _Cluster(Workers):
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

    def rows(self, future: Any) -> list[Row]:
        from distributed import KilledWorker

        try:
            return [Row(*row) for row in future.result(timeout=_GATHER_S)]
        except KilledWorker as error:
            raise WorkerEnded from error
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
            raise WorkerEnded from error

    def _check(self) -> None:
        if self._client.status != "running":
            raise FileError(f"the scheduler {self._address()} no longer answers")

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
    words: dict[str, Any] = {}
    if tls:
        names = ("tls_ca_file", "tls_client_cert", "tls_client_key")
        files = dict(zip(names, tls, strict=True))
        words["security"] = given.Security(**files, require_encryption=True)
    with dask.config.set({"distributed.comm.timeouts.connect": f"{_CONNECT_S}s"}):
        try:
            client = given.Client(
                scheduler, timeout=_CONNECT_S, set_as_default=False, name="imagechain", **words
            )
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise UsageError(
                f"--scheduler {scheduler:.120}: no Dask scheduler answers at this address"
                + (", or it rejects these certificates" if tls else "")
            ) from error
        with client:
            yield client


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
    made: Any = Security
    if tls and protocol not in ("tls", "wss"):
        raise UsageError(
            f"--scheduler {scheduler:.120}: certificates need the address tls://HOST:PORT of a "
            "scheduler started with --tls-ca-file, --tls-cert and --tls-key"
        )
    if protocol in ("tls", "wss") and not tls and made().tls_client_cert is None:
        raise UsageError(
            f"--scheduler {scheduler:.120}: give the files that the scheduler was started with, "
            "as --tls-ca-file, --tls-cert and --tls-key"
        )


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep what Dask logs off the terminal: what matters comes as an error of ours."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(before)
