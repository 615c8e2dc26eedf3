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
from app.study.study_points import (
    Axis,
    Point,
    files_axis,
    grid_axis,
    grid_points,
    latin_points,
    listed_points,
    span_axis,
    values_axis,
)
from app.study.study_request import make_study
from core.errors import UsageError
from core.evaluation.policy import Policy
from core.modules.declaration import Library
from core.network.file import load_network
from core.network.network import Network
from core.network.validation import check_network, plain_network
from nodes.files.common.file_format import CSV
from nodes.library import standard_library

GRID, LATIN = "grid", "latin"
Values = str | Sequence[Any]


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
    name, place = "", Path(folder or ".")
    read = [Path(sample)] if CSV.matches(Path(sample)) else []
    if not isinstance(network, Network):
        found = find_network(str(network))
        name, place = found.name, found.folder
        read.append(found.path)
        network = load_network(found.path, library=known)
    plain = plain_network(network, library=known)
    check_network(plain, library=known)
    path = None if output is None else study_path("--output", str(output))
    if path is not None:
        check_installed(path)
    study = make_study(
        plain,
        name=plain.name or name,
        folder=place,
        library=known,
        overs=[files_axis(f"{k}={v}", plain, library=known) for k, v in (over or {}).items()],
        sampling=lambda: sampled(plain, vary or {}, str(sample), points, library=known),
        figures=figures,
        saves=[save_target(f"{port}={pattern}") for port, pattern in (saves or {}).items()],
        policy=policy or Policy(),
    )
    pages = [summary_path("--summary", str(page)) for page in summaries]
    study.check_places([*([] if path is None else [path]), *pages], read)

    def summarise(rows: StudyRows) -> None:
        from app.study.study_drawing import write_summary

        for page in pages:
            write_summary(rows, page)

    workers = Workers(jobs, scheduler, memory_bytes=memory_bytes)
    if workers.warning:
        warnings.warn(workers.warning, UserWarning, stacklevel=2)
    rows = carry_out(study, workers, output=path, fresh=fresh, also=summarise)
    if path is None:
        summarise(rows)
    return rows


def sampled(
    network: Network,
    vary: Mapping[str, Values],
    sample: str,
    points: int | None,
    *,
    library: Library,
) -> tuple[tuple[Axis, ...], Sequence[Point]]:
    """The axes and points of ``vary`` and ``sample``."""
    if points is not None and sample != LATIN:
        raise UsageError(f"--points {points}: only --sample latin draws points")
    if sample in (GRID, LATIN):
        of_text = grid_axis if sample == GRID else span_axis
        axes = tuple(
            of_text(f"{label}={values}", network, library=library)
            if isinstance(values, str)
            else values_axis(label, values, network, library=library)
            for label, values in vary.items()
        )
        if sample == GRID:
            return axes, grid_points(axes)
        if points is None or not axes:
            raise UsageError(
                "--sample latin: give --points N, how many to draw, and --vary NODE.PARAM=FROM:TO, "
                "from where"
            )
        return latin_points(axes, points, network.seed)
    if vary:
        raise UsageError(f"--vary {next(iter(vary)):.80}: the points are those of {sample:.120}")
    if not CSV.matches(Path(sample)):
        raise UsageError(f"--sample {sample:.120}: write grid, latin, or the name of a .csv file")
    return listed_points(Path(sample), network, library=library)
