"""``imagechain check``: every fault of a network, without computing anything."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from app.command.results import show
from app.command.run import FINAL, input_files, opened, own_files, rules_of, sink_targets
from app.options.command_options import Options
from app.run.evaluation import planned
from app.run.output import find_output, how_to_choose
from app.run.readout_tables import warning_lines
from app.run.shipped import Place, find_network
from app.run.staging import Staging, check_folder
from core.chain.engine import Engine, Plan
from core.errors import ImagechainError, InputError
from core.names import in_line
from core.network.validation import NetworkProblems


def carry_out(options: Options, _stop: object) -> None:
    """Print each error, or that there is none, what the nodes warn of, and what a run would write.

    Where there are errors, how many are raised once all are printed.
    """
    place = find_network(options.network)
    written: list[str] = []
    try:
        library, place, network = opened(options)
        plan = planned(Engine(library), network, place.folder)
        written, refused = planned_writes(options, place, plan)
        if refused:
            raise NetworkProblems(refused)
    except InputError as error:
        problems = error.problems if isinstance(error, NetworkProblems) else (error,)
        lines = [*map(in_line, written), *(in_line(str(problem)) for problem in problems)]
        facts = [{"node": problem.node, "message": problem.message} for problem in problems]
        show(options, lambda: {"errors": facts}, *lines)
        first = f"{place.name}: {_count(len(problems), 'error')}, the first: {problems[0]}"
        raised = InputError(first)
        raised.exit_code = error.exit_code  # 1 for the fault of a plug-in
        raise raised from None
    cautions = plan.warnings()
    warnings = warning_lines(cautions)
    if choose := how_to_choose(find_output(plan)):
        warnings.append(f"warning: no {FINAL}: {choose}")
    count = _count(len(warnings), "warning") if warnings else ""
    size = f"{_count(len(network.nodes), 'node')}, {_count(len(network.links), 'link')}"
    summary = f"{place.name}: no errors{', ' if count else ''}{count} ({size})"
    show(
        options,
        lambda: {"errors": [], "warnings": [asdict(caution) for caution in cautions]},
        *map(in_line, [*warnings, summary, *written]),
    )


def planned_writes(
    options: Options, place: Place, plan: Plan
) -> tuple[list[str], tuple[ImagechainError, ...]]:
    """Lines on what a run would write, and why it would refuse to."""
    folder = options.output_dir or Path(f"{place.name}-output")
    check_folder(folder)
    rules = rules_of(options, place, folder)
    own, sinks = own_files(plan, folder), sink_targets(plan, place.folder)
    staging = Staging(folder, [place.path, *input_files(plan, place.folder)])
    lines = [f"run writes {', '.join(map(str, own))}"]
    lines += [f"{node}: run writes {target}" for node, target in sinks.items()]
    return lines, rules.refused(sinks, own, staging)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
