"""Study a chain: figures and pictures at many points and over many scenes."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.run.option_values import save_target, summary_path
from app.study import study_request
from core.errors import UsageError
from core.evaluation.work import Policy, Precision
from imagechain.building.chain import Chain
from imagechain.building.chain import open as open_chain
from imagechain.parts.plain_errors import plain_errors
from imagechain.results.tables import StudyTable

if TYPE_CHECKING:
    from distributed import Client

File = str | PathLike[str]
Values = str | Sequence[Any] | NDArray[Any]
_CHAIN = "a Chain, a network file, or the name of an example network"
_VARY = "{'NODE.PARAM': values}, or the points as sample='points.csv'"
_TEXTS = "a mapping of strings, {'NODE.NAME': pattern}"
_OUTPUT = "the name of a .csv, .parquet or .nc file"
_SCHEDULER = (
    "the address of a Dask scheduler, or a distributed.Client (for a cluster: cluster.get_client())"
)
_VALUES = "a list or a one-dimensional array of values, or a string such as '0:1:5'"


@plain_errors
def study(
    chain: Chain | File,
    *,
    vary: Mapping[str, Values] | None = None,
    over: Mapping[str, str] | None = None,
    sample: File = "grid",
    points: int | None = None,
    figures: str | Sequence[str] = (),
    save: Mapping[str, str] | None = None,
    output: File | None = None,
    summary: File | Sequence[File] = (),
    jobs: int = 0,
    scheduler: str | Client = "",
    memory_bytes: int | None = None,
    fresh: bool = False,
    precision: Precision = "single",
    tolerance: float | None = None,
    threads: int = 0,
) -> StudyTable:
    """Evaluate a chain at many points: one row per point, with the reason if the point failed.

    Parameters
    ----------
    chain : Chain or path
        A chain, a file, or the name of an example network.
    vary : mapping
        Values by ``NODE.PARAM``: a sequence or an array, or a string as in the command
        (``"0:1:5"``, ``"1e10:1e12:7:log"``, ``"a,b"``; ``"0:1"`` for a Latin hypercube).
    over : mapping
        File patterns by ``NODE.PARAM``: ``{"scene.path": "scenes/*.img"}``.
    sample : "grid", "latin" or a .csv file
        All combinations of the values, a Latin hypercube, or the rows of a file.
    points : int, optional
        Number of points of a Latin hypercube.
    figures : sequence of str
        ``NODE.READOUT``; by default the most useful read-outs.
    save : mapping
        Files to write, by ``NODE.PORT``: ``{"back.image": "out/{scene}_{point}.tif"}``.
    output : path, optional
        File for the rows (.csv, .parquet, .nc); an unfinished study is resumed from it.
    summary : sequence of path
        Pictures (.png) and pages (.html) of the figures.
    jobs : int
        Number of processes on this machine; 0 uses all cores if that is faster than one process.
    scheduler : str or distributed.Client
        Address of a Dask scheduler, or a client connected to one, to use instead of local
        processes.
    memory_bytes : int, optional
        Memory for computed values, for all processes together; by default 256 MB per process.
    fresh : bool
        Whether to discard the rows of an unfinished study.
    precision, tolerance, threads
        As for `Chain.run`, in each process.
    """
    distributed = sys.modules.get("distributed")
    is_client = distributed is not None and isinstance(scheduler, distributed.Client)
    text_maps = {"over": over, "save": save}
    for name, given, fits, taken in (
        ("chain", chain, isinstance(chain, Chain) or _is_path(chain), _CHAIN),
        ("vary", vary, vary is None or isinstance(vary, Mapping), _VARY),
        *((name, given, _is_of_texts(given), _TEXTS) for name, given in text_maps.items()),
        ("output", output, output is None or _is_path(output), _OUTPUT),
        ("sample", sample, _is_path(sample), "'grid', 'latin', or a .csv file of points"),
        ("scheduler", scheduler, is_client or isinstance(scheduler, str), _SCHEDULER),
    ):
        if not fits:
            raise _refused(name, given, taken)
    if is_client and getattr(scheduler, "asynchronous", False):
        raise UsageError(
            "scheduler: an asynchronous Client is not allowed; give a synchronous Client"
        )
    counts = {"jobs": jobs, "points": points, "memory_bytes": memory_bytes, "threads": threads}
    for name, count in counts.items():
        if not (count is None or (isinstance(count, Integral) and count >= 0)):
            raise UsageError(
                f"{name} = {count!r:.80} is not allowed: must be a whole number, 0 or more"
            )
    files = _texts("summary", summary, str | PathLike, "a file, or a list of files")
    own = chain if isinstance(chain, Chain) else open_chain(chain)
    file = own._state.file
    rows = study_request.run_study(
        own.network,
        jobs=jobs,
        scheduler=scheduler,
        memory_bytes=memory_bytes,
        name="" if file is None else file.stem,
        folder=own.folder,
        read=[] if file is None else [file],
        output=None if output is None else fspath(output),
        summaries=[summary_path("--summary", fspath(path)) for path in files],
        fresh=fresh,
        vary={label: _values(label, values) for label, values in (vary or {}).items()},
        over=[f"{label}={pattern}" for label, pattern in (over or {}).items()],
        sample=fspath(sample),
        points=points,
        figures=_texts("figures", figures, str, "NODE.READOUT, or a list of read-outs"),
        saves=[save_target(f"{port}={pattern}") for port, pattern in (save or {}).items()],
        policy=Policy(precision, tolerance, threads),
    )
    return StudyTable(rows)


def _texts(name: str, given: Any, kind: Any, taken: str) -> list[Any]:
    if given is None or isinstance(given, kind):
        return [] if given is None else [given]
    texts = list(given) if isinstance(given, Iterable) else [given]
    for text in texts:
        if not isinstance(text, kind):
            raise _refused(name, text, taken)
    return texts


def _values(label: str, values: Any) -> str | Sequence[Any]:
    if isinstance(values, str) or (isinstance(values, Sequence) and not isinstance(values, bytes)):
        return values
    if hasattr(values, "__array__") and np.ndim(values) == 1:  # of numpy, pandas or xarray
        return list(np.asarray(values).tolist())
    raise _refused(f"vary {label}", values, _VALUES)


def _is_of_texts(given: object) -> bool:
    texts = given.values() if isinstance(given, Mapping) else [given]
    return given is None or all(isinstance(text, str) for text in texts)


def _is_path(given: object) -> bool:
    return isinstance(given, str | PathLike)


def _refused(name: str, given: object, taken: str) -> UsageError:
    return UsageError(f"{name}: {type(given).__name__} is not allowed; give {taken}")
