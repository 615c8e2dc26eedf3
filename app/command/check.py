"""``imagechain check``: every fault of a network, without computing anything."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from app.command.run import input_files, open_network, own_files, rules_of, sink_targets
from app.command.run_summary import FINAL
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
from nodes.library import standard_library


def check(options: Options) -> None:
    """Print each error, or that there is none, what the nodes warn of, and what a run would write.

    Raises
    ------
    InputError
        If there is no such network; else how many errors it has, once all are printed.
    """
    library = standard_library()
    place = find_network(options.network)
    try:
        network = open_network(place, options, library)
        plan = planned(Engine(library), network, place.folder)
        written, refused = planned_writes(options, place, plan)
        if refused:
            print("\n".join(map(in_line, written)))
            raise NetworkProblems(refused)
    except NetworkProblems as faults:
        raise _printed(place, faults.problems) from None
    except InputError as error:
        raise _printed(place, [error]) from None
    warnings = warning_lines(plan.warnings())
    if choose := how_to_choose(find_output(plan)):
        warnings.append(f"warning: no {FINAL}: {choose}")
    count = _count(len(warnings), "warning") if warnings else ""
    size = f"{_count(len(network.nodes), 'node')}, {_count(len(network.links), 'link')}"
    summary = f"{place.name}: no errors{', ' if count else ''}{count} ({size})"
    print("\n".join(map(in_line, [*warnings, summary, *written])))


def planned_writes(
    options: Options, place: Place, plan: Plan
) -> tuple[list[str], tuple[ImagechainError, ...]]:
    """Lines on what a run would write, and why it would refuse to.

    Raises
    ------
    InputError
        If it would write nothing at all, as its folder is none.
    """
    folder = options.output_dir or Path(f"{place.name}-output")
    check_folder(folder)
    rules = rules_of(options, place, folder)
    own, sinks = own_files(plan, folder), sink_targets(plan, place.folder)
    staging = Staging(folder, [place.path, *input_files(plan, place.folder)])
    lines = [f"run writes {', '.join(map(str, own))}"]
    lines += [f"{node}: run writes {target}" for node, target in sinks.items()]
    return lines, rules.refused(sinks, own, staging)


def _printed(place: Place, problems: Sequence[ImagechainError]) -> InputError:
    for problem in problems:
        print(in_line(str(problem)))
    return InputError(f"{place.name}: {_count(len(problems), 'error')}, the first: {problems[0]}")


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
