"""``imagechain tradeoff``: figures of merit as a parameter moves, on the terminal and in files."""

from __future__ import annotations

import shutil
import sys
import threading
from collections.abc import Sequence
from pathlib import Path

from app.command.results import Progress, show, written
from app.command.run import input_files, opened, policy_of
from app.options.command_options import Options
from app.run.readout_tables import json_text, warned_points
from app.tradeoff.tradeoff_drawing import (
    csv_text,
    failures,
    page,
    table,
    trade_off_facts,
    trade_off_png,
)
from app.tradeoff.tradeoff_figures import chosen_figures
from app.tradeoff.tradeoff_results import Results, shown_value, trade_off
from app.tradeoff.values import MOST, OPTION, Variation, variation
from core.chain.engine import Engine
from core.errors import UsageError
from core.modules.declaration import Library
from core.names import in_line, printable
from core.network.network import Network
from nodes.files.common.file_format import CSV, JSON
from nodes.files.formats import PNG

_MOST_VARIED = 2


def carry_out(options: Options, stop: threading.Event) -> None:
    """Print the table once all files are written.

    A value at which the network fails is no fault, unless all do.
    """
    library, place, network = opened(options)
    varied, second = _variations(options.vary, network, library)
    figures = chosen_figures(options.figures, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=place.folder)
    points = [value for _ in (second.values if second else (None,)) for value in varied.values]

    def made() -> Results:
        with Progress(len(points)) as progress:
            results = trade_off(
                engine, plan, engine.work(policy_of(options), cancel=stop), varied, second, figures,
                name=network.name or place.name, by_default=not options.figures,
                # Each point counts once, also where values look alike.
                reached=lambda count: progress(
                    f"{count}: {varied.text} {shown_value(points[count - 1], varied.unit)}"
                ),
            )  # fmt: skip
        if (why := results.why_nothing()) is not None:
            why = why and f": {why}"
            raise UsageError(f"{OPTION} {varied.text}: no value gives a figure{why}")
        return results

    inputs = [place.path, *input_files(plan, place.folder)]
    results = written(options.outputs, inputs, stop, made, trade_off_content)
    width = shutil.get_terminal_size().columns if sys.stdout and sys.stdout.isatty() else None
    lines = [table(results, width)]
    if reasons := failures(results):
        lines += ["", *map(in_line, reasons)]
    if options.outputs:
        lines += ["", in_line(", ".join(map(str, options.outputs)))]
    warned = warned_points([point.warnings for _, point in results.rows()])
    show(options, lambda: trade_off_facts(results), *lines, *warned)


def _variations(
    texts: Sequence[str], network: Network, library: Library
) -> tuple[Variation, Variation | None]:
    if not 1 <= len(texts) <= _MOST_VARIED:
        raise UsageError(
            f"{OPTION} is given {len(texts)} times: give it once, or twice for a family of curves"
        )
    variations = [variation(text, network, library=library) for text in texts]
    if len(variations) == 1:
        return variations[0], None
    first, second = variations
    if first.text == second.text:
        raise UsageError(f"{OPTION} {second.text} is given twice: vary another parameter")
    if len(first.values) * len(second.values) > MOST:
        raise UsageError(
            f"{OPTION} {second.text}: {len(first.values)} × {len(second.values)} values, "
            f"at most {MOST} are allowed"
        )
    return first, second


def trade_off_content(results: Results, path: Path) -> str | bytes:
    if CSV.matches(path):
        return printable(csv_text(results))
    if JSON.matches(path):
        return json_text(trade_off_facts(results), indent=1)
    return trade_off_png(results) if PNG.matches(path) else printable(page(results))
