"""``imagechain study``: a network at many points and over many pictures, a row for each."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from pathlib import Path

from app.command.run import open_network, policy_of
from app.options.command_options import Options
from app.options.option_values import assignment
from app.options.progress import Progress
from app.run.readout_tables import warned_points
from app.run.shipped import find_network
from app.study.carrying_out import StudyRows, Workers, carry_out
from app.study.run_study import sampled
from app.study.study_journal import check_installed
from app.study.study_points import Axis, Point, files_axis
from app.study.study_request import Study, make_study
from app.tradeoff.values import FORM, OPTION
from core.errors import DataError, UsageError
from core.modules.declaration import Library
from core.names import in_line
from core.network.network import Network
from nodes.files.common.file_format import CSV
from nodes.library import standard_library

_MOST_JOBS = 1024


def study(options: Options, cancel: threading.Event | None = None) -> None:
    """Carry out the command.

    Parameters
    ----------
    options : Options
        What the command line gives.
    cancel : threading.Event, optional
        Set to stop; what is done is kept.

    Raises
    ------
    ImagechainError
        The first fault; a `DataError` when all is done and written, but points have failed.
    """
    begun = time.perf_counter()
    library = standard_library()
    place = find_network(options.network)
    network = open_network(place, options, library)
    workers = Workers(_jobs(options), options.scheduler, options.tls, options.memory_bytes)
    workers.check()
    output = options.outputs[0]
    check_installed(output)
    wanted = make_study(
        network,
        name=network.name or place.name,
        folder=place.folder,
        library=library,
        overs=[files_axis(text, network, library=library) for text in options.over],
        sampling=lambda: _sampled(options, network, library),
        figures=options.figures,
        saves=options.saves,
        policy=policy_of(options),
    )
    listed = [Path(options.sample)] if CSV.matches(Path(options.sample)) else []
    wanted.check_places([output, *options.summaries], [place.path, *listed])
    if workers.warning:
        print(f"warning: {workers.warning}", flush=True)
    with Progress(len(wanted.points), time_left=True) as progress:
        result = carry_out(
            wanted,
            workers,
            output=output,
            fresh=options.fresh,
            reached=lambda done: progress.reach(done, _where(wanted, done)),
            cancel=cancel,
            also=lambda rows: _summarise(rows, options.summaries),
        )
    _print(result, output, options.summaries, time.perf_counter() - begun)


def _sampled(
    options: Options, network: Network, library: Library
) -> tuple[tuple[Axis, ...], Sequence[Point]]:
    settings = [assignment(OPTION, text, FORM) for text in options.vary]
    labels = [setting.port for setting in settings]
    twice = next((label for label in labels if labels.count(label) > 1), None)
    if twice is not None:
        raise UsageError(f"{OPTION} {twice} is given twice: vary another parameter")
    vary = {setting.port: setting.text for setting in settings}
    return sampled(network, vary, options.sample, options.points, library=library)


def _jobs(options: Options) -> int:
    if options.jobs is None:
        return 0
    if options.scheduler:
        raise UsageError("--jobs is for this machine: give it, or --scheduler, not both")
    if not 1 <= options.jobs <= _MOST_JOBS:
        raise UsageError(f"--jobs {options.jobs}: give a whole number from 1 to {_MOST_JOBS}")
    return options.jobs


def _where(wanted: Study, done: int) -> str:
    if done >= len(wanted.order):
        return ""
    point = wanted.points[wanted.order[done]]
    shown = (str(axis.shown(v)) for axis, v in zip(wanted.axes, point, strict=True))
    return " ".join(shown)[:60]


def _summarise(rows: StudyRows, paths: Sequence[Path]) -> None:
    for path in paths:
        from app.study.study_drawing import write_summary

        write_summary(rows, path)


def _print(result: StudyRows, output: Path, summaries: Sequence[Path], seconds: float) -> None:
    failed = result.failed
    count = len(result.rows)
    print(
        in_line(f"{count} points in {seconds:.3g} s: {', '.join(map(str, [output, *summaries]))}")
    )
    for line in warned_points([row.warnings for row in result.rows]):
        print(line)
    if failed:
        row = failed[0]
        raise DataError(
            f"{len(failed)} of {count} points failed, see the column error of {output}; the first, "
            f"point {row.place + 1}: {row.error}"
        )
