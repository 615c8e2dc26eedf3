"""Studies of chains: figures and pictures at many points and over many scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any

from app.study.run_study import run_study
from core.evaluation.policy import Policy, Precision
from imagechain.building.chain import Chain
from imagechain.common.plain_errors import plain_errors
from imagechain.results.study_table import StudyTable

File = str | PathLike[str]


@plain_errors
def study(
    chain: Chain | File,
    *,
    vary: Mapping[str, str | Sequence[Any]] | None = None,
    over: Mapping[str, str] | None = None,
    sample: File = "grid",
    points: int | None = None,
    figures: Sequence[str] = (),
    save: Mapping[str, str] | None = None,
    output: File | None = None,
    summary: Sequence[File] = (),
    jobs: int = 1,
    scheduler: str = "",
    fresh: bool = False,
    precision: Precision = "single",
    tolerance: float | None = None,
    threads: int = 0,
) -> StudyTable:
    """Evaluate a chain at many points: a row for each, or the reason why it failed.

    Parameters
    ----------
    chain : Chain or path
        A chain, a file, or the name of a shipped network.
    vary : mapping
        Values by ``NODE.PARAM``: a sequence or an array, or a text as of the command
        (``"0:1:5"``, ``"1e10:1e12:7:log"``, ``"a,b"``; ``"0:1"`` for a Latin hypercube).
    over : mapping
        Files by ``NODE.PARAM``, as patterns: ``{"scene.path": "scenes/*.img"}``.
    sample : "grid", "latin" or a .csv file
        Every value with every other, `points` drawn, or the rows of a list.
    points : int, optional
        How many a Latin hypercube has.
    figures : sequence of str
        ``NODE.READOUT``; those of most use, if none are given.
    save : mapping
        Files by ``NODE.PORT``: ``{"back.image": "out/{scene}_{point}.tif"}``.
    output : path, optional
        Where the rows go (.csv, .parquet, .nc); an unfinished study is taken up from there.
    summary : sequence of path
        Pictures (.png) and pages (.html) of the figures.
    jobs : int
        Processes of this machine, 0 for all cores where that pays. Beyond 1 a script needs its
        ``if __name__ == "__main__":``.
    scheduler : str
        The address of a Dask scheduler, in their place.
    fresh : bool
        Whether what an unfinished study has left is thrown away.
    precision : "single" or "double"
        Of the pictures.
    tolerance : float, optional
        Error budget.
    threads : int
        Of each process, 0 for all there are.

    Returns
    -------
    StudyTable
        The rows, by column.

    Raises
    ------
    ImagechainError
        If it cannot be carried out. A point that fails is a row.
    """
    rows = run_study(
        chain.network if isinstance(chain, Chain) else fspath(chain),
        folder=chain.folder if isinstance(chain, Chain) else None,
        vary=vary,
        over=over,
        sample=fspath(sample),
        points=points,
        figures=figures,
        saves=save,
        output=None if output is None else fspath(output),
        summaries=[fspath(path) for path in summary],
        jobs=jobs,
        scheduler=scheduler,
        fresh=fresh,
        policy=Policy(precision, tolerance, threads),
    )
    return StudyTable(rows)
