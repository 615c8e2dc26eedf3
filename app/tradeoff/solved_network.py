"""The value of a parameter at which a read-out of a network is what a data sheet says."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from app.run.option_values import Assignment, assignment
from app.run.overrides import listed, named_parameter
from app.run.readout_tables import warning_lines
from app.tradeoff.solve_readout import Sample, Solution, search_range, solve
from app.tradeoff.tradeoff_figures import Figure, computed, figures_of
from app.tradeoff.tradeoff_results import shown_value, with_value
from core.chain.engine import Engine, Plan
from core.errors import DataError, ParameterError, UsageError
from core.evaluation.policy import Policy
from core.modules.declaration import Library
from core.modules.parameters import Parameter
from core.names import close, in_line, shown
from core.network.network import Network

FOR, UNTIL = "--for", "--until"
_FOR_FORM = "NODE.PARAM, or NODE.PARAM=LOW:HIGH"
_UNTIL_FORM = "NODE.READOUT=VALUE"


def solve_network(
    network: Network,
    library: Library,
    folder: Path,
    *,
    solve_for: str,
    until: str,
    policy: Policy,
    cancel: threading.Event,
    progress: Callable[[int], AbstractContextManager[Callable[[str], object]]],
) -> tuple[dict[str, Any], list[str]]:
    """The value that does it, as facts and in lines.

    Raises a `DataError` where none does, with what the ends give.
    """
    sought, parameter = _sought(solve_for, network, library)
    figure, wanted = _wanted(until, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=folder)
    present = plan.node(sought.node).node.params.get(sought.name, parameter.default)
    range_ = search_range(parameter, present, sought.text, option=f"{FOR} {sought.port}")
    work = engine.work(policy, cancel=cancel)
    reasons: dict[float, str] = {}

    def planned(value: float) -> Plan:
        exact: Any = int(value) if parameter.kind == "integer" else value
        changed = with_value(plan.network, engine, sought.node, sought.name, exact)
        return engine.plan(changed, folder=folder, previous=plan)

    with progress(len(range_.places())) as reached:

        def evaluate(value: float) -> float | None:
            work.check()
            reached(f"{sought.port} {shown_value(value, parameter.param.unit)}")
            try:
                result = computed((figure,), engine, planned(value), work, {sought.node})
            except ParameterError as error:
                reasons[value] = str(error.at(sought.node))
                return None
            reasons.update((value, reason) for reason in result.reasons.values())
            return result.figures.get(figure.text)

        number = present if isinstance(present, int | float) else None
        solution = solve(evaluate, wanted=wanted, places=range_, present=number)
    unit = parameter.param.unit
    if solution.at is None:
        raise DataError(_none(solution, sought.port, unit, figure, wanted, reasons))
    at = solution.at
    whole = parameter.kind == "integer"
    final = planned(at.value)
    readouts = {
        node: engine.readouts(final, node, work)
        for node in dict.fromkeys((figure.node, sought.node))
        if node in final.nodes and final.nodes[node].error is None
    }
    cautions = engine.warnings(final, work, known_only=True)

    facts = {
        "parameter": sought.port,
        "unit": unit,
        "value": int(at.value) if whole else at.value,
        "figure": {"name": figure.text, "unit": figure.unit, "value": at.figure},
        "wanted": wanted,
        "others": solution.others,
        "readouts": readouts,
        "warnings": [asdict(caution) for caution in cautions],
    }
    text = _found(solution, sought.port, unit, figure, wanted, whole=whole)
    return facts, [in_line(text) + "\n", *_lines(final, readouts), *warning_lines(cautions)]


def _sought(text: str, network: Network, library: Library) -> tuple[Assignment, Parameter]:
    target = assignment(FOR, text if "=" in text else f"{text}=", _FOR_FORM)
    parameter = named_parameter(FOR, target, network, library=library)
    if parameter is None:
        raise UsageError(f"{FOR} {target.port}: the node's module is unknown")
    return target, parameter


def _wanted(text: str, network: Network, library: Library) -> tuple[Figure, float]:
    target = assignment(UNTIL, text, _UNTIL_FORM)
    known = figures_of(network, library)
    figure = known.get(target.port)
    if figure is None:
        beside = [name for name, other in known.items() if other.node == target.node]
        hint = listed(beside) if beside else close(target.port, known) or listed(known)
        raise UsageError(f"{UNTIL} {shown(target.port)}: the network has no such read-out{hint}")
    try:
        wanted = float(target.text)
    except ValueError:
        wanted = float("nan")
    if not abs(wanted) < float("inf"):
        unit = f", in {figure.unit}" if figure.unit else ""
        raise UsageError(f"{UNTIL} {target.port}={target.text:.80}: VALUE must be a number{unit}")
    return figure, wanted


def _found(
    solution: Solution, port: str, unit: str, figure: Figure, wanted: float, *, whole: bool
) -> str:
    at = solution.at
    assert at is not None
    # What is found is typed in again: with the six digits of figures it would be off by 1e-6.
    found = int(at.value) if whole else float(f"{at.value:.10g}")
    text = f"{port} = {found!r} {unit}".rstrip()
    text += f": {figure.text} = {shown_value(at.figure, figure.unit)}"
    if solution.beside is not None:
        other = solution.beside
        text += (
            f"; no whole number gives {shown_value(wanted, figure.unit)}: "
            f"{shown_value(other.value, unit)} gives {shown_value(other.figure, figure.unit)}"
        )
    if solution.others:
        places = ", ".join(shown_value(value, unit) for value in solution.others)
        text += f"; so does a value near {places}"
    return text


def _none(
    solution: Solution,
    port: str,
    unit: str,
    figure: Figure,
    wanted: float,
    reasons: Mapping[float, str],
) -> str:
    if not solution.seen:
        why = "".join(f": {reason}" for reason in list(reasons.values())[:1])
        return f"{figure.text} has no value for any {port}{why}"
    first, last = solution.seen[0], solution.seen[-1]
    text = (
        f"no value of {port} from {shown_value(first.value, unit)} to "
        f"{shown_value(last.value, unit)} makes {figure.text} {shown_value(wanted, figure.unit)}: "
        f"it is {_at(first, unit, figure)} and {_at(last, unit, figure)}"
    )
    least, most = solution.nearest
    extreme = most if most.figure < wanted else least
    if extreme not in (first, last):
        word = "most" if extreme is most else "least"
        text += f", at {word} {_at(extreme, unit, figure)}"
    for edge in solution.edges:
        side = "above" if edge.without > edge.sample.value else "below"
        text += f"; {side} {shown_value(edge.sample.value, unit)} {figure.text} has no value"
        text += f": {reasons[edge.without]}" if edge.without in reasons else ""
    return text


def _at(sample: Sample, unit: str, figure: Figure) -> str:
    return f"{shown_value(sample.figure, figure.unit)} at {shown_value(sample.value, unit)}"


def _lines(plan: Plan, readouts: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    for node, values in readouts.items():
        planned = plan.node(node)
        units = {r.name: planned.unit(r) for r in planned.declaration.readouts}
        for name, value in values.items():
            text = "none" if value is None else shown_value(value, units[name])
            yield in_line(f"  {node}.{name}  {text}")
