"""A study from Python, as the command carries it out."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from app.options.option_values import save_target, study_path, summary_path
from app.run.shipped import find_network
from app.study.carrying_out import StudyRows, Workers, carry_out
from app.study.study_journal import check_installed
from app.study.study_points import GRID, Values
from app.study.study_request import Study, make_study
from core.evaluation.policy import Policy
from core.modules.declaration import Library
from core.network.file import load_network
from core.network.network import Network
from core.network.validation import check_network, plain_network
from nodes.files.common.file_format import CSV
from nodes.library import standard_library


def run_study(
    network: Network | str | Path,
    *,
    vary: Mapping[str, Values] | None = None,
    over: Mapping[str, str] | None = None,
    sample: str | Path = GRID,
    points: int | None = None,
    figures: Sequence[str] = (),
    saves: Mapping[str, str] | None = None,
    output: str | Path | None = None,
    summaries: Sequence[str | Path] = (),
    jobs: int = 1,
    scheduler: Any = "",
    memory_bytes: int | None = None,
    fresh: bool = False,
    policy: Policy | None = None,
    folder: str | Path | None = None,
    library: Library | None = None,
) -> StudyRows:
    """Evaluate a network at many points; `StudyRows.columns` is the table.

    Parameters
    ----------
    network : Network, str or Path
        A network, the name of a shipped one, or a file.
    vary : mapping
        Values by ``NODE.PARAM``: a sequence, or a text as of the command (``"0:1:5"``).
    over : mapping
        Patterns of files by ``NODE.PARAM``.
    sample : "grid", "latin" or a .csv file
        How points are made.
    points : int, optional
        How many a Latin hypercube has.
    figures : sequence of str
        ``NODE.READOUT``; those of most use, if none are given.
    saves : mapping
        Patterns of files by ``NODE.PORT``.
    output : path, optional
        Where the rows go, and where an unfinished study is taken up.
    summaries : sequence of path
        Pictures (.png) and pages (.html) of it.
    jobs : int
        Processes of this machine; 0 takes all cores where that is faster.
    scheduler : str or distributed.Client
        The address of a Dask scheduler, or a client of one, in their place.
    memory_bytes : int, optional
        How much computed values may take, all processes together.
    fresh : bool
        Whether what an unfinished study has left is thrown away.
    policy : Policy, optional
        Precision, tolerance and threads.
    folder : path, optional
        What file names in a `Network` are relative to; the current folder, if not given.
    library : Library, optional
        The modules.

    Returns
    -------
    StudyRows
        A row for each point, in order; those that failed have an error.
    """
    known = library if library is not None else standard_library()
    name, place, read = "", Path(folder or "."), []
    if not isinstance(network, Network):
        found = find_network(str(network))
        name, place, read = found.name, found.folder, [found.path]
        network = load_network(found.path, library=known)
    plain = plain_network(network, library=known)
    check_network(plain, library=known)
    path = None if output is None else study_path("--output", str(output))
    pages = [summary_path("--summary", str(page)) for page in summaries]
    study = checked_study(
        plain, name=plain.name or name, folder=place, library=known, vary=vary or {},
        over=[f"{k}={v}" for k, v in (over or {}).items()], sample=str(sample), points=points,
        figures=figures, policy=policy or Policy(), read=read, output=path, summaries=pages,
        saves=[save_target(f"{port}={pattern}") for port, pattern in (saves or {}).items()],
    )  # fmt: skip
    workers = Workers(jobs, scheduler, memory_bytes=memory_bytes)
    if workers.warning:
        warnings.warn(workers.warning, UserWarning, stacklevel=2)
    return carried_out(study, workers, output=path, summaries=pages, fresh=fresh)


def checked_study(
    network: Network,
    *,
    read: Sequence[Path],
    output: Path | None,
    summaries: Sequence[Path],
    sample: str,
    **wanted: Any,
) -> Study:
    """A study whose files can be written: those `read` are no outputs; else as `make_study`."""
    if output is not None:
        check_installed(output)
    study = make_study(network, sample=sample, **wanted)
    listed = [Path(sample)] if CSV.matches(Path(sample)) else []
    study.check_places([*filter(None, [output]), *summaries], [*read, *listed])
    return study


def carried_out(
    study: Study,
    workers: Workers,
    *,
    output: Path | None,
    summaries: Sequence[Path],
    **how: Any,
) -> StudyRows:
    """The rows, written with their summaries; else as `carry_out`."""

    def summarise(rows: StudyRows) -> None:
        from app.study.study_drawing import write_summary

        for page in summaries:
            write_summary(rows, page)

    rows = carry_out(study, workers, output=output, also=summarise, **how)
    if output is None:
        summarise(rows)
    return rows
