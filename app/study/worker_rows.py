"""The rows of a study in a worker: a process of its own on this machine, or one of a cluster."""

from __future__ import annotations

import gc
import os
import pickle
import queue
import threading
import time
import warnings
from collections.abc import Iterable
from typing import Any, BinaryIO

from app.study.point_rows import Row, RowMaker, Setting, Task
from core.errors import Cancelled, UsageError
from nodes.library import standard_library

_NAME = "imagechain_studies"
_MOST = 2  # studies that a worker of a cluster remembers
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

    from app.run.process import version

    makers = _makers(get_worker(), key)
    # A maker goes from point to point; threads of one worker have one each.
    thread = threading.get_ident()
    if thread not in makers:
        wanted: Setting = pickle.loads(setting)
        if wanted.version != version():
            raise UsageError(
                f"a worker has imagechain {version()}, and this machine has {wanted.version}: all "
                "must have the same version"
            )
        makers[thread] = RowMaker(wanted, standard_library(), share)
    return [tuple(row) for row in _first_rows(makers[thread], tasks)]


def _makers(worker: Any, key: str) -> dict[int, RowMaker]:
    known: dict[str, dict[int, RowMaker]] = vars(worker).setdefault(_NAME, {})
    while len(known) >= _MOST and key not in known:
        del known[next(iter(known))]
    return known.setdefault(key, {})


if __name__ == "__main__":
    main()
