"""``imagechain study``: a network at many points and over many pictures, a row for each."""

from __future__ import annotations

import re
import threading
import time
from pathlib import Path
from typing import Any

from app.command.results import Progress, say, show
from app.command.run import opened, policy_of
from app.options.command_options import Options
from app.options.option_values import assignment
from app.run.readout_tables import warned_points
from app.study.carrying_out import TLS, Workers
from app.study.carrying_out import carry_out as carry_out_study
from app.study.study_request import Study, StudyRows, make_study
from app.tradeoff.values import FORM, OPTION
from core.errors import DataError, UsageError
from core.names import in_line, shown

_MOST_JOBS = 1024
_OF_PLUG_IN = re.compile(r"\ba fault of the (module \S+ in the )?plug-in ")


def carry_out(options: Options, stop: threading.Event) -> None:
    """Make the rows and write them; a `DataError` when all is done, but points have failed."""
    begun = time.perf_counter()
    library, place, network = opened(options)
    workers = Workers(_jobs(options), options.scheduler, _tls(options), options.memory_bytes)
    workers.check()
    settings = [assignment(OPTION, text, FORM) for text in options.vary]
    labels = [setting.port for setting in settings]
    if twice := next((label for label in labels if labels.count(label) > 1), None):
        raise UsageError(f"{OPTION} {twice} is given twice: vary another parameter")
    output = options.output
    assert output is not None  # argparse requires it
    wanted = make_study(
        network, name=network.name or place.name, folder=place.folder, library=library,
        vary={setting.port: setting.text for setting in settings}, over=options.over,
        sample=options.sample, points=options.points, figures=options.figures,
        saves=options.saves, policy=policy_of(options), read=[place.path], output=output,
        summaries=options.summaries,
    )  # fmt: skip
    if workers.warning:
        say(options, f"warning: {workers.warning}")
    with Progress(len(wanted.points), time_left=True) as progress:
        result = carry_out_study(
            wanted, workers, output=output, summaries=options.summaries, fresh=options.fresh,
            reached=lambda done: progress.reach(done, _where(wanted, done)), cancel=stop,
        )  # fmt: skip
    _show(result, output, options, time.perf_counter() - begun)


def _jobs(options: Options) -> int:
    if options.jobs is None:
        return 0
    if options.scheduler:
        raise UsageError(
            "--jobs is for processes on this machine: give --jobs or --scheduler, not both"
        )
    if not 1 <= options.jobs <= _MOST_JOBS:
        raise UsageError(f"--jobs {options.jobs}: give a whole number from 1 to {_MOST_JOBS}")
    return options.jobs


def _tls(options: Options) -> tuple[str, ...]:
    texts = dict(zip(TLS, (options.tls_ca_file, options.tls_cert, options.tls_key), strict=True))
    files = {option: text for option, text in texts.items() if text is not None}
    missing = [option for option in TLS if option not in files]
    if files and missing:
        raise UsageError(f"{missing[0]} is missing: TLS needs {', '.join(TLS)}")
    for option, text in files.items():
        if not Path(text).is_file():
            raise UsageError(f"{option} {shown(text)}: there is no such file")
    return tuple(files.values())


def _where(wanted: Study, done: int) -> str:
    if done >= len(wanted.order):
        return ""
    point = wanted.points[wanted.order[done]]
    words = (str(axis.shown(v)) for axis, v in zip(wanted.axes, point, strict=True))
    return " ".join(words)[:60]


def _show(result: StudyRows, output: Path, options: Options, seconds: float) -> None:
    failed = result.failed
    count = len(result.rows)
    files = [*map(str, (output, *options.summaries))]

    def facts() -> dict[str, Any]:
        columns = result.columns()
        rows = zip(*(column.values for column in columns), strict=True)
        heads = [column.head for column in columns]
        return {"rows": [dict(zip(heads, row, strict=True)) for row in rows], "files": files}

    show(
        options,
        facts,
        in_line(f"{count} points in {seconds:.3g} s: {', '.join(files)}"),
        *warned_points([row.warnings for row in result.rows]),
    )
    if failed:
        row = failed[0]
        error = DataError(
            f"{len(failed)} of {count} points failed, see the column error of {output}; the first, "
            f"point {row.place + 1}: {row.error}"
        )
        error.exit_code = 1 if _OF_PLUG_IN.search(row.error) else 2
        raise error
