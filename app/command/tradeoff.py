"""``imagechain tradeoff``: figures of merit as a parameter moves, on the terminal and in files."""

from __future__ import annotations

import shutil
import sys
import threading
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from app.command.run import input_files, open_network, policy_of
from app.options.command_options import Options
from app.options.progress import Progress
from app.options.stopping import too_late
from app.options.terminal_streams import show
from app.run.readout_tables import json_text, warned_points
from app.run.shipped import find_network
from app.run.staging import Staging
from app.tradeoff.tradeoff_drawing import csv_text, failures, table, trade_off_facts
from app.tradeoff.tradeoff_figures import Figure, chosen_figures
from app.tradeoff.tradeoff_results import (
    Curve,
    Point,
    PointEvaluator,
    Results,
    changing_figures,
    shown_value,
)
from app.tradeoff.values import MOST, OPTION, Variation, variation
from core.atomic import write_bytes, write_text
from core.chain.engine import Engine, Plan
from core.errors import Cancelled, UsageError
from core.modules.declaration import Library
from core.names import in_line, printable
from core.network.network import Network
from nodes.files.common.file_format import CSV, JSON
from nodes.files.formats import PNG
from nodes.library import standard_library

_MOST_VARIED = 2


def carry_out(options: Options, stop: threading.Event) -> None:
    """Print the table once all files are written.

    A value at which the network fails is no fault, unless all do.
    """
    library = standard_library()
    place = find_network(options.network)
    network = open_network(place, options, library)
    varied, second = _variations(options.vary, network, library)
    figures = chosen_figures(options.figures, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=place.folder)
    with Staging(None, [place.path, *input_files(plan, place.folder)]) as staging:
        for path in options.outputs:
            staging.claim(path)
        curves = _curves(options, engine, plan, (varied, second, figures), stop)
        if not options.figures:
            figures = changing_figures([f for f in figures if f.text != varied.text], curves)
        results = Results(
            network.name or place.name, varied, second, figures, curves, present_value(plan, varied)
        )
        _check_figures(results)
        for path in options.outputs:
            staging.write(path, partial(write_results, results))
        if stop.is_set():
            raise Cancelled("stopped on request")
        too_late(stop)
        staging.commit()
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
        raise UsageError(f"{OPTION} is given {len(texts)} times: once, or twice for a family")
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


def _curves(
    options: Options,
    engine: Engine,
    plan: Plan,
    asked: tuple[Variation, Variation | None, tuple[Figure, ...]],
    stop: threading.Event,
) -> tuple[Curve, ...]:
    varied, second, figures = asked
    axes = [varied] if second is None else [second, varied]
    evaluator = PointEvaluator(
        engine, plan, [(axis.node, axis.parameter.name) for axis in axes], figures
    )
    seconds = (None,) if second is None else second.values
    curves: list[Curve] = []
    with Progress(len(seconds) * len(varied.values)) as progress:
        work = engine.work(policy_of(options), cancel=stop)
        for place in seconds:
            points: list[Point] = []
            for value in varied.values:
                work.check()
                result = evaluator.at((value,) if second is None else (place, value), work)
                points.append(Point(value, result.values, result.reasons, result.warnings))
                label = shown_value(value, varied.unit)
                # Each point counts once, also where values look alike.
                progress(f"{len(curves) * len(varied.values) + len(points)}: {varied.text} {label}")
            curves.append(Curve(place, tuple(points)))
    return tuple(curves)


def present_value(plan: Plan, varied: Variation) -> Any:
    """The value of a parameter in the network as it stands."""
    default = None if varied.parameter.required else varied.parameter.default
    return plan.node(varied.node).node.params.get(varied.parameter.name, default)


def _check_figures(results: Results) -> None:
    """Refuse a trade-off that has nothing to show."""
    if any(f.text in point.figures for f in results.figures for _, point in results.rows()):
        return
    gaps = results.failures()
    if not gaps:  # the default figures had no value, so none is left
        gaps = [("", r) for _, point in results.rows() for r in point.reasons.values()]
    why = f": {gaps[0][1]}" if gaps else ""
    raise UsageError(f"{OPTION} {results.varied.text}: no value of it gives a figure{why}")


def write_results(results: Results, path: Path) -> None:
    """Write a trade-off in the format of the path's suffix."""
    if CSV.matches(path):
        write_text(path, printable(csv_text(results)))
    elif JSON.matches(path):
        write_text(path, json_text(trade_off_facts(results), indent=1))
    elif PNG.matches(path):
        from app.tradeoff.tradeoff_drawing import trade_off_png

        write_bytes(path, trade_off_png(results))
    else:
        from app.tradeoff.tradeoff_drawing import page

        write_text(path, printable(page(results)))
