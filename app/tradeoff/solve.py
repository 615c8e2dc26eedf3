"""Find the value of a parameter at which a read-out has a wanted value."""

import math
import threading
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from app.run import option_values, overrides, terminal
from app.tradeoff.tradeoff_results import Figure, PointEvaluator, named_figure, shown_value
from core.chain.engine import Engine, Plan
from core.errors import DataError, ParameterError, UsageError, in_line
from core.evaluation.work import Policy
from core.kernels import brentq
from core.modules.declaration import Library
from core.modules.parameters import Parameter
from core.network.network import Network
from core.records import asdict, dataclass, field

FOR, UNTIL = "--for", "--until"
_FOR_FORM = "NODE.PARAM, or NODE.PARAM=LOW:HIGH"
_UNTIL_FORM = "NODE.READOUT=VALUE"
Sample = tuple[float, float]
"""A value of the parameter, and the read-out there."""


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
    """The value that does it, as facts and in lines; else a `DataError` with what the ends give."""
    sought = option_values.assignment(
        FOR, solve_for if "=" in solve_for else f"{solve_for}=", _FOR_FORM
    )
    parameter = overrides.named_parameter(FOR, sought, network, library=library)
    if parameter is None:
        raise UsageError(f"{FOR} {sought.port}: the node's module is unknown")
    figure, wanted = _wanted(until, network, library)
    engine = Engine(library)
    plan = engine.plan(network, folder=folder)
    present = plan.node(sought.node).node.params.get(sought.name, parameter.default)
    search = _search_range(parameter, present, sought.text, f"{FOR} {sought.port}")
    search.wanted = wanted
    work = engine.work(policy, cancel=cancel)
    unit, reasons = parameter.param.unit, dict[float, str]()
    evaluator = PointEvaluator(engine, plan, [(sought.node, sought.name)], (figure,))

    def planned(value: float) -> Plan:
        return evaluator.planned((int(value) if search.whole else value,))

    with progress(len(search.places())) as reached:

        def evaluate(value: float) -> float | None:
            work.check()
            reached(f"{sought.port} {shown_value(value, unit)}")
            try:
                result = evaluator.figures_of(planned(value), work)
            except ParameterError as error:
                reasons[value] = str(error.at(sought.node))
                return None
            reasons.update((value, reason) for reason in result.reasons.values())
            return result.figures.get(figure.text)

        search.evaluate = evaluate
        search.solve(present if isinstance(present, int | float) else None)
    if search.at is None:
        raise DataError(_nothing(search, sought.port, unit, figure, reasons))
    value, result = search.at
    final = planned(value)
    readouts = {
        node: engine.readouts(final, node, work)
        for node in dict.fromkeys((figure.node, sought.node))
        if node in final.nodes and final.nodes[node].error is None
    }
    cautions = engine.warnings(final, work, known_only=True)
    facts = {
        "parameter": sought.port,
        "unit": unit,
        "value": int(value) if search.whole else value,
        "figure": {"name": figure.text, "unit": figure.unit, "value": result},
        "wanted": wanted,
        "others": search.others,
        "readouts": readouts,
        "warnings": [asdict(caution) for caution in cautions],
    }
    lines = [in_line(_found(search, sought.port, unit, figure)) + "\n"]
    for node, values in readouts.items():
        units = final.node(node).units
        for name, each in values.items():
            text = "none" if each is None else shown_value(each, units[name])
            lines.append(in_line(f"  {node}.{name}  {text}"))
    return facts, [*lines, *terminal.warning_lines(cautions)]


def _wanted(text: str, network: Network, library: Library) -> tuple[Figure, float]:
    target = option_values.assignment(UNTIL, text, _UNTIL_FORM)
    figure = named_figure(UNTIL, target.port, network, library)
    wanted = math.nan
    with suppress(ValueError):
        wanted = float(target.text)
    if not math.isfinite(wanted):
        unit = f", in {figure.unit}" if figure.unit else ""
        raise UsageError(f"{UNTIL} {target.port}={target.text:.80}: VALUE must be a number{unit}")
    return figure, wanted


# The range in which a parameter is sought, and places in it where a read-out is looked at.

_DECADES = 6.0  # about the present value, where the parameter has no end of its own
_SMALLEST = 1e-12  # of the largest value, where zero itself is not allowed
_LOG_FROM = 1000.0  # the end of a range over its beginning, from which on its steps are factors
_LINEAR_STEPS, _STEPS_A_DECADE, _MOST_STEPS = 32, 3, 60
_HALVINGS = 24  # of a step, to find where the read-out's values end within it


class _Gap(Exception):
    """The read-out has no value between two places where it has one."""


@dataclass
class _Search:
    """Changes of sign along a range, of which one is closed in on."""

    low: float
    high: float
    log: bool  # whether places lie equal factors apart
    whole: bool = False  # whether only whole numbers count
    zero: bool = False  # whether 0 is tried beside
    wanted: float = math.nan  # and the read-out at a value, None where it has none
    evaluate: Callable[[float], float | None] = lambda _: None
    # what was looked at, from one end of the range to the other
    seen: list[Sample] = field(default_factory=list)
    # where the read-out's values end: there, and a value beside it without one
    edges: list[tuple[Sample, float]] = field(default_factory=list)
    at: Sample | None = None  # None where no value does it
    beside: Sample | None = None  # of whole numbers, the neighbour beyond the wanted value
    others: list[float] = field(default_factory=list)  # further ones, to the width of a step

    def places(self) -> tuple[float, ...]:
        if self.log:
            decades = math.log10(self.high / self.low)
            count = min(_MOST_STEPS, max(_LINEAR_STEPS, math.ceil(decades * _STEPS_A_DECADE)))
            spaced = np.geomspace(self.low, self.high, count + 1)
        else:
            spaced = np.linspace(self.low, self.high, _LINEAR_STEPS + 1)
        values = [self.low, *map(float, spaced[1:-1]), self.high]
        if self.whole:
            values = [float(value) for value in dict.fromkeys(map(round, values))]
        return (0.0, *values) if self.zero else tuple(values)

    def scaled(self, value: float) -> float:
        """On the axis of the places; zero on one of factors lies before all others."""
        if not self.log:
            return value
        return math.log(value) if value > 0 else math.log(self.low) - 1.0

    def middle(self, one: float, other: float) -> float:
        if self.whole:
            return float((int(one) + int(other)) // 2)
        if self.log and min(one, other) > 0:
            return math.exp(0.5 * (math.log(one) + math.log(other)))
        return 0.5 * (one + other)

    def solve(self, present: float | None) -> None:
        """Of several solutions the one nearest to `present`, by Brent or by halving."""
        line = list[tuple[float, float | None]]()
        for value in self.places():
            here = (value, self.evaluate(value))
            if line and (line[-1][1] is None) != (here[1] is None):
                ends = sorted((line[-1], here), key=lambda sample: sample[1] is None)
                (inside, figure), (without, _) = ends
                assert figure is not None
                self.edges.append(self._edge((inside, figure), without))
                if self.edges[-1][0][0] != inside:
                    line.append(self.edges[-1][0])
            line.append(here)
        self.seen = [(value, figure) for value, figure in line if figure is not None]
        crossings = [
            ((low, first), (high, second))
            for (low, first), (high, second) in pairwise(line)
            if first is not None and second is not None and self._between(first, second)
        ]
        if not crossings:
            self.at = next((sample for sample in self.seen if sample[1] == self.wanted), None)
            return

        def distance(pair: tuple[Sample, Sample]) -> float:
            if present is None or (self.log and present <= 0):
                return 0.0
            now = self.scaled(present)
            return max(self.scaled(pair[0][0]) - now, now - self.scaled(pair[1][0]), 0.0)

        chosen = min(crossings, key=distance)
        self.others = [pair[0][0] for pair in crossings if pair is not chosen]
        (self._halve if self.whole else self._brent)(*chosen)

    def _edge(self, sample: Sample, without: float) -> tuple[Sample, float]:
        """Between a value of the parameter with a read-out and one without: where they meet."""
        for _ in range(_HALVINGS):
            middle = self.middle(sample[0], without)
            if middle in (sample[0], without):
                break
            figure = self.evaluate(middle)
            if figure is None:
                without = middle
            else:
                sample = middle, figure
        return sample, without

    def _between(self, one: float, other: float) -> bool:
        first, second = one - self.wanted, other - self.wanted
        return first == 0.0 or first * second < 0.0 or second == 0.0

    def _brent(self, one: Sample, other: Sample) -> None:
        known = dict((one, other))
        on_log = self.log and one[0] > 0

        def excess(scaled: float) -> float:
            value = math.exp(scaled) if on_log else scaled
            figure = self.evaluate(value)
            if figure is None:  # a gap inside: the step that is left is as good as it gets
                raise _Gap
            known[value] = figure
            return figure - self.wanted

        low, high = (math.log(value) if on_log else value for value in known)
        if self.wanted not in known.values():
            with suppress(_Gap):
                brentq(excess, low, high, xtol=1e-16 * abs(high - low), rtol=1e-13)
        self.at = min(known.items(), key=lambda sample: abs(sample[1] - self.wanted))

    def _halve(self, low: Sample, high: Sample) -> None:
        """Two neighbouring whole numbers about the wanted value, the nearer one in `at`."""
        while high[0] - low[0] > 1.0:
            middle = self.middle(low[0], high[0])
            figure = self.evaluate(middle)
            if figure is None:
                break
            if self._between(low[1], figure):
                high = middle, figure
            else:
                low = middle, figure
        self.at, other = sorted((low, high), key=lambda sample: abs(sample[1] - self.wanted))
        self.beside = None if self.at[1] == self.wanted else other


def _search_range(parameter: Parameter, present: object, given: str, option: str) -> _Search:
    """The range given as ``LOW:HIGH``, else the parameter's own, else about its present value."""
    if parameter.kind not in ("number", "integer"):
        raise UsageError(
            f"{option}: {parameter.name} is {parameter.allowed()}, not a number "
            "that can be solved for"
        )
    whole = parameter.kind == "integer"
    if given:
        low, high = option_values.low_high(option, given)
        return _Search(low, high, low > 0 and high / low >= _LOG_FROM, whole)
    bound_low, bound_high = parameter.param.low, parameter.param.high
    now = float(present) if isinstance(present, int | float) and present else 1.0
    high = bound_high if bound_high is not None else abs(now) * 10.0**_DECADES
    if bound_low is None:
        return _Search(-high if bound_high is None else now - abs(high), high, False, whole)
    if bound_low != 0.0 or whole:
        log = bound_low > 0 and high / bound_low >= _LOG_FROM
        return _Search(bound_low, high, log, whole)
    # From next to nothing on; the present value is well inside.
    low = min(high * _SMALLEST, abs(now) * 1e-3)
    zero = not parameter.param.above and not (parameter.empty and parameter.param.zero_is_empty)
    return _Search(low, high, True, zero=zero)


# What was found, in words.


def _found(search: _Search, port: str, unit: str, figure: Figure) -> str:
    assert search.at is not None
    value, result = search.at
    # What is found is typed in again: with the six digits of figures it would be off by 1e-6.
    found = int(value) if search.whole else float(f"{value:.10g}")
    text = f"{port} = {found!r} {unit}".rstrip()
    text += f": {figure.text} = {shown_value(result, figure.unit)}"
    if search.beside is not None:
        other, gives = search.beside
        text += (
            f"; no whole number gives exactly {shown_value(search.wanted, figure.unit)} "
            f"({shown_value(other, unit)} gives {shown_value(gives, figure.unit)})"
        )
    if search.others:
        others = ", ".join(shown_value(other, unit) for other in search.others)
        text += f"; other solutions are near {others}"
    return text


def _nothing(
    search: _Search, port: str, unit: str, figure: Figure, reasons: Mapping[float, str]
) -> str:
    def at(sample: Sample) -> str:
        return f"{shown_value(sample[1], figure.unit)} at {shown_value(sample[0], unit)}"

    name = figure.text
    begins = f"{name} has no value: "  # as most reasons do
    reasons = {place: reason.removeprefix(begins) for place, reason in reasons.items()}
    if not search.seen:
        why = "".join(f": {reason}" for reason in list(reasons.values())[:1])
        return f"{name} has no value for any value of {port}{why}"
    first, last = search.seen[0], search.seen[-1]
    text = (
        f"no value of {port} from {shown_value(first[0], unit)} to {shown_value(last[0], unit)} "
        f"makes {name} equal to {shown_value(search.wanted, figure.unit)}: the figure is "
        f"{at(first)} and {at(last)}"
    )
    by_figure = sorted(search.seen, key=lambda sample: sample[1])
    least, most = by_figure[0], by_figure[-1]
    extreme, word = (most, "most") if most[1] < search.wanted else (least, "least")
    if extreme not in (first, last):
        text += f", at {word} {at(extreme)}"
    for (inside, _), without in search.edges:
        side = "above" if without > inside else "below"
        text += f"; {side} {shown_value(inside, unit)}, {name} has no value"
        text += f": {reasons[without]}" if without in reasons else ""
    return text
