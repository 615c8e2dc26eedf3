"""The rows of a batch on a worker of a Dask cluster, which keeps what batches have in common."""

from __future__ import annotations

import pickle
import threading
from typing import Any

from distributed import get_worker

from app.options.command_options import version
from app.study.point_rows import Row, RowMaker, Setting, Task
from core.errors import UsageError
from nodes.library import standard_library

Plain = tuple[int, tuple[float | None, ...], str, float, str]
_NAME = "imagechain_studies"
_MOST = 2  # studies that a worker remembers


def rows_of_batch(setting: bytes, key: str, tasks: list[Task], share: int) -> list[Plain]:
    """Make the rows of points, by the worker's own engine and store for this study.

    Parameters
    ----------
    setting : bytes
        The study, pickled.
    key : str
        Its content key.
    tasks : list of Task
        The points.
    share : int
        How many share the machine's memory.

    Raises
    ------
    UsageError
        If the worker has another version of this program.
    """
    makers = _makers(get_worker(), key)
    # A maker goes from point to point; threads of one worker have one each.
    thread = threading.get_ident()
    if thread not in makers:
        wanted: Setting = pickle.loads(setting)
        if wanted.version != version():
            raise UsageError(
                f"a worker has imagechain {version()}, and this is {wanted.version}: all must have "
                "one version"
            )
        makers[thread] = RowMaker(wanted, standard_library(), share)
    return [plain_row(makers[thread].row(task)) for task in tasks]


def plain_row(row: Row) -> Plain:
    """A row as it is sent."""
    return row.place, row.figures, row.key, row.seconds, row.error


def _makers(worker: Any, key: str) -> dict[int, RowMaker]:
    known: dict[str, dict[int, RowMaker]] = vars(worker).setdefault(_NAME, {})
    while len(known) >= _MOST and key not in known:
        del known[next(iter(known))]
    return known.setdefault(key, {})
