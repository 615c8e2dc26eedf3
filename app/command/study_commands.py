"""``imagechain tradeoff``, ``study`` and ``solve``: a network with other values of parameters."""

from __future__ import annotations

import math
import re
import shutil
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.command import options
from app.run import option_values as values
from app.run.terminal import Stop
from core.errors import DataError, UsageError, in_line, several
from nodes.files.file_format import suffixes

if TYPE_CHECKING:
    from app.run.overrides import GivenNetwork
    from app.study.study_rows import StudyRows
    from core.evaluation.work import Policy

_MOST_JOBS = 1024
_OF_PLUG_IN = re.compile(r"\ba fault in the (module \S+ of the )?plug-in ")


@options.command()
@options.network_options
@options.option(
    "--vary", "NODE.PARAM=VALUES",
    "parameter to vary: FROM:TO:COUNT, FROM:TO:COUNT:log (logarithmic), or values a,b,c; "
    "if given twice, each value of the second parameter gives one curve",
    many=True, required=True)  # fmt: skip
@options.option(
    "--figure", "NODE.READOUT",
    "figure to compute: a read-out of a node, or an MTF of the chain. total.mtf_nyquist_x "
    "and total.mtf_half_nyquist_x (or _y) are the MTF at the samples' Nyquist frequency and at "
    "half of it; total.mtf_pixel_nyquist_x and total.mtf_half_pixel_nyquist_x use the pixels' "
    "Nyquist frequency. May be repeated (default: the sensor's figures and the chain's MTFs, "
    "without figures that do not change)",
    many=True, to="figures")  # fmt: skip
@options.written_outputs("write the figures", values.OUTPUTS)
@options.numerical_options
@options.json_flag
def tradeoff(
    stop: Stop,
    asked: GivenNetwork,
    policy: Policy,
    vary: tuple[str, ...],
    figures: tuple[str, ...],
    outputs: tuple[Path, ...],
    json: bool,
) -> None:
    """Plot figures against a parameter.

    If the network fails at a value, the table has a gap, and the reason is printed.
    """
    from app.command.network_run import input_files
    from app.run import overrides, terminal
    from app.study.study_drawing import failures, table, trade_off_content, trade_off_facts
    from app.tradeoff.tradeoff_results import Results, chosen_figures, shown_value, trade_off
    from core.chain.engine import Engine

    library, place, network = options.opened(asked, json)
    axes = overrides.variations(vary, network, library)
    along = axes[-1]
    chosen = chosen_figures(figures, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=place.folder)

    def made() -> Results:
        def reached(count: int) -> None:
            value = along.values[(count - 1) % len(along.values)]
            # Each point counts once, also where values look alike.
            progress(f"{count}: {along.text} {shown_value(value, along.unit)}")

        with options.Progress(math.prod(len(axis.values) for axis in axes)) as progress:
            results = trade_off(
                engine, plan, engine.work(policy, cancel=stop), axes, chosen,
                name=network.name or place.name, by_default=not figures, reached=reached,
            )  # fmt: skip
        if (why := results.why_nothing()) is not None:
            why = why and f": {why}"
            raise UsageError(
                f"{overrides.OPTION} {along.text}: no figure could be computed at any value{why}"
            )
        return results

    inputs = [place.path, *input_files(plan)]
    results = options.written(outputs, inputs, stop, made, trade_off_content)
    width = shutil.get_terminal_size().columns if sys.stdout and sys.stdout.isatty() else None
    lines = [table(results, width)]
    if reasons := failures(results):
        lines += ["", *map(in_line, reasons)]
    if outputs:
        lines += ["", in_line(", ".join(map(str, outputs)))]
    warned = terminal.warned_points([point.warnings for point in results.points])
    options.show(json, lambda: trade_off_facts(results), *lines, *warned)


@options.command()
@options.network_options
@options.option(
    "--vary", "NODE.PARAM=VALUES",
    "parameter to vary: FROM:TO:COUNT, FROM:TO:COUNT:log (logarithmic), or values a,b,c; "
    "with --sample latin, FROM:TO or FROM:TO:log; may be repeated", many=True)  # fmt: skip
@options.option(
    "--over", "NODE.PARAM=PATTERN",
    "compute every point for each file that matches a pattern, such as "
    "scene.path='scenes/*.img'; files are taken in the order of the numbers in their names; "
    "may be repeated",
    many=True)  # fmt: skip
@options.option(
    "--sample", "HOW",
    "grid: all combinations of the values (default); latin: --points N points of a Latin "
    "hypercube, drawn with the network's seed; a .csv file: one point per row, with columns "
    "named NODE.PARAM", default="grid")  # fmt: skip
@options.option("--points", "N", "number of points for --sample latin", values.whole_number)
@options.option(
    "--figure", "NODE.READOUT",
    "figure to compute at each point, as for tradeoff; may be repeated (default: the "
    "sensor's figures and the chain's MTFs; none if pictures are saved)",
    many=True, to="figures")  # fmt: skip
@options.save_option(
    "NODE.PORT=PATTERN",
    "save each point's picture or curve. Fields for the file name: {point}, {NODE.PARAM} (the "
    "value of a varied parameter), {scene} (the name of the picture). Formats: "
    f"{options.SAVED}. May be repeated")  # fmt: skip
@options.option(
    "--output", "FILE",
    f"file for the results, one row per point, as {' '.join(suffixes(*values.STUDIES))}",
    values.study_path, required=True)  # fmt: skip
@options.option(
    "--summary", "FILE",
    f"plot of the figures, as {' '.join(suffixes(*values.SUMMARIES))}; may be repeated",
    values.summary_path, many=True, to="summaries")  # fmt: skip
@options.flag("--fresh", "discard the rows of an unfinished study")
@options.option(
    "--jobs", "N",
    "number of processes on this machine (default: all cores if the remaining points would "
    "take one process more than a few seconds, else one)",
    values.whole_number, group=options.RARER)  # fmt: skip
@options.option(
    "--memory", "SIZE",
    "memory for computed values, shared by all processes, such as 2GB (default: 256MB per "
    "process); raise it if pictures are larger than about 4000 x 4000 samples",
    values.size_in_bytes, to="memory_bytes", group=options.RARER)  # fmt: skip
@options.option(
    "--scheduler", "ADDRESS",
    "compute on the workers of a Dask scheduler, such as tls://10.0.0.1:8786; the workers need "
    "Imagechain and access to the same files", default="", group=options.RARER)  # fmt: skip
@options.numerical_options
@options.json_flag
def study(
    stop: Stop,
    asked: GivenNetwork,
    policy: Policy,
    vary: tuple[str, ...],
    output: Path,
    summaries: tuple[Path, ...],
    fresh: bool,
    jobs: int | None,
    memory_bytes: int | None,
    scheduler: str,
    json: bool,
    **points: Any,
) -> None:
    """Compute figures and pictures for many values and scenes.

    The points form a grid, a Latin hypercube or a list, for every picture that matches a pattern.
    Each point becomes a row with its values, its figures, a key that identifies the computation,
    the computing time, and the reason if it failed. To resume a study that was stopped or killed,
    give the same command again; finished rows are saved in OUTPUT.journal.
    """
    from app.run.overrides import FORM, OPTION
    from app.study import study_request, study_rows

    begun = time.perf_counter()
    library, place, network = options.opened(asked, json)
    jobs = _jobs(jobs, scheduler)
    warning = study_rows.check_scheduler(scheduler)
    settings = [values.assignment(OPTION, text, FORM) for text in vary]
    labels = [setting.port for setting in settings]
    if twice := next((label for label in labels if labels.count(label) > 1), None):
        raise UsageError(f"{OPTION} {twice} is given twice: give each parameter once")
    wanted = study_request.make_study(
        network, name=network.name or place.name, folder=place.folder, library=library,
        vary={setting.port: setting.text for setting in settings}, policy=policy,
        memory_bytes=memory_bytes, read=[place.path], output=output, summaries=summaries, **points,
    )  # fmt: skip
    if warning:
        options.say(json, f"warning: {warning}")

    def where(done: int) -> str:
        if done >= len(wanted.order):
            return ""
        point = wanted.points[wanted.order[done]]
        words = (str(axis.shown(v)) for axis, v in zip(wanted.axes, point, strict=True))
        return " ".join(words)[:60]

    with options.Progress(len(wanted.points), time_left=True) as progress:
        result = study_request.carry_out(
            wanted, jobs=jobs, scheduler=scheduler, output=output, summaries=summaries, fresh=fresh,
            reached=lambda done: progress.reach(done, where(done)), cancel=stop,
        )  # fmt: skip
    _show_rows(result, [output, *summaries], json, time.perf_counter() - begun)


def _jobs(jobs: int | None, scheduler: str) -> int:
    if jobs is None:
        return 0
    if scheduler:
        raise UsageError(
            "--jobs and --scheduler cannot be used together: --jobs sets the processes on "
            "this machine"
        )
    if not 1 <= jobs <= _MOST_JOBS:
        raise UsageError(
            f"--jobs {jobs} is not allowed: must be a whole number from 1 to {_MOST_JOBS}"
        )
    return jobs


def _show_rows(result: StudyRows, written: list[Path], json: bool, seconds: float) -> None:
    """Print where the rows are; a `DataError` when all is done, but points have failed."""
    from app.run.terminal import warned_points

    failed, count, files = result.failed, len(result.rows), [*map(str, written)]

    def facts() -> dict[str, Any]:
        columns = result.columns()
        rows = zip(*(column.values for column in columns), strict=True)
        heads = [column.head for column in columns]
        return {"rows": [dict(zip(heads, row, strict=True)) for row in rows], "files": files}

    done = in_line(f"{several(count, 'point')} in {seconds:.3g} s: {', '.join(files)}")
    options.show(json, facts, done, *warned_points([row.warnings for row in result.rows]))
    if failed:
        row = failed[0]
        error = DataError(
            f"{len(failed)} of {count} points failed (see the column error in {files[0]}); the "
            f"first is point {row.place + 1}: {row.error}"
        )
        error.exit_code = 1 if _OF_PLUG_IN.search(row.error) else 2
        raise error


@options.command()
@options.network_options
@options.option(
    "--for", "NODE.PARAM[=LOW:HIGH]",
    "parameter to find, within its own range or a range that you give",
    required=True, to="solve_for",
)  # fmt: skip
@options.option(
    "--until", "NODE.READOUT=VALUE",
    "read-out and its target value, in the read-out's unit", required=True)  # fmt: skip
@options.numerical_options
@options.json_flag
def solve(
    stop: Stop, asked: GivenNetwork, policy: Policy, solve_for: str, until: str, json: bool
) -> None:
    """Find the parameter value that gives a read-out the value you want."""
    from app.tradeoff.solve import solve_network

    library, place, network = options.opened(asked, json)
    facts, lines = solve_network(
        network, library, place.folder, solve_for=solve_for, until=until, policy=policy,
        cancel=stop, progress=options.Progress,
    )  # fmt: skip
    options.show(json, lambda: facts, *lines)
