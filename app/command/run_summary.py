"""What `imagechain run` prints at its end."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from app.options.command_options import Options
from app.run.evaluation import Evaluation
from app.run.figures import Figure, figure_rows
from app.run.output import find_output, how_to_choose
from app.run.readout_tables import columns, readout_rows, warning_lines
from app.run.way_of_running import way_in_words
from core.chain.skipped import Skip
from core.names import in_line

FINAL, MTF, READOUTS = "final.png", "mtf.csv", "readouts.json"


def print_summary(
    evaluation: Evaluation,
    skipped: tuple[Skip, ...],
    figures: Sequence[Figure],
    folder: Path,
    options: Options,
    sinks: dict[str, Path],
) -> None:
    """Print the figures, warnings, what was left out, and the files that were written."""
    readouts = readout_rows(evaluation)
    if figures and not options.all_readouts:
        rows = [(name, f"{value} {unit}", node) for name, value, unit, node in figure_rows(figures)]
        print(columns(rows))
        print(f"all {len(readouts)} read-outs: --all, or {READOUTS}", end="\n\n")
    elif readouts:
        print(columns(readouts, right=(2,)), end="\n\n")
    lines = warning_lines(evaluation.cautions)
    if lines:
        print("\n".join(lines), end="\n\n")
    left_out = [
        f"{skip.node} (at most {skip.bound:.2g})" for skip in skipped if skip.kind == "below_budget"
    ]
    if left_out:
        budget = evaluation.work.policy.budget
        print(in_line(f"left out within the error budget of {budget:.3g}: {', '.join(left_out)}"))
    for skip in skipped:
        if skip.kind == "wavelengths":
            print(in_line(f"{skip.node}: {skip.text} (at most {skip.bound:.2g} of their contrast)"))
    names = [FINAL, MTF, READOUTS] if evaluation.chain.final is not None else [MTF, READOUTS]
    print(in_line(f"{folder}: {', '.join(names)}"))
    if evaluation.chain.final is None:
        output = find_output(evaluation.plan)
        print(in_line(f"no {FINAL}: {how_to_choose(output) or output.missing}"))
    if evaluation.chain.missing and evaluation.chain.grid is not None:
        print(in_line(f"no total in {MTF}: {evaluation.chain.missing}"))
    if evaluation.way.get("way") == "in blocks" or options.memory_bytes is not None:
        print(in_line(way_in_words(evaluation.way)))
    others = [
        *(save.text for save in options.saves),
        *map(str, options.reports),
        *map(str, sinks.values()),
    ]
    if others:
        print(in_line(f"also {', '.join(others)}"))
