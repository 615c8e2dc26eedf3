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


def summary(
    evaluation: Evaluation,
    skipped: tuple[Skip, ...],
    figures: Sequence[Figure],
    folder: Path,
    options: Options,
    others: Sequence[str],
) -> list[str]:
    """The figures, warnings, what was left out, and the files that were written."""
    shown = []
    readouts = readout_rows(evaluation)
    if figures and not options.all:
        rows = [(name, f"{value} {unit}", node) for name, value, unit, node in figure_rows(figures)]
        shown += [columns(rows), f"all {len(readouts)} read-outs: --all, or {READOUTS}\n"]
    elif readouts:
        shown.append(columns(readouts, right=(2,)) + "\n")
    if warnings := warning_lines(evaluation.cautions):
        shown.append("\n".join(warnings) + "\n")
    lines = []
    left_out = [
        f"{skip.node} (at most {skip.bound:.2g})" for skip in skipped if skip.kind == "below_budget"
    ]
    if left_out:
        budget = evaluation.work.policy.budget
        lines.append(f"left out within the error budget of {budget:.3g}: {', '.join(left_out)}")
    lines += [
        f"{skip.node}: {skip.text} (at most {skip.bound:.2g} of their contrast)"
        for skip in skipped
        if skip.kind == "wavelengths"
    ]
    names = [FINAL, MTF, READOUTS] if evaluation.chain.final is not None else [MTF, READOUTS]
    lines.append(f"{folder}: {', '.join(names)}")
    if evaluation.chain.final is None:
        output = find_output(evaluation.plan)
        lines.append(f"no {FINAL}: {how_to_choose(output) or output.missing}")
    if evaluation.chain.missing and evaluation.chain.grid is not None:
        lines.append(f"no total in {MTF}: {evaluation.chain.missing}")
    if evaluation.way.get("way") == "in blocks" or options.memory_bytes is not None:
        lines.append(way_in_words(evaluation.way))
    if others:
        lines.append(f"also {', '.join(others)}")
    return [*shown, *map(in_line, lines)]
