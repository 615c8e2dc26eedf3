"""Find the value of a parameter at which a read-out has a wanted value."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.run.option_values import low_high
from core.errors import UsageError
from core.modules.parameters import Parameter
from core.physics.numerics import brent_root

Evaluated = Callable[[float], float | None]
_HALVINGS = 24  # of a step, to find where the read-out's values end within it


class _Gap(Exception):
    """The read-out has no value between two places where it has one."""


@dataclass(frozen=True)
class Sample:
    value: float
    figure: float


@dataclass(frozen=True)
class Edge:
    """Two values of the parameter close together, of which one alone has a read-out."""

    sample: Sample
    without: float


@dataclass(frozen=True)
class Solution:
    at: Sample | None  # the value, and what the read-out then is; None where no value does it
    beside: Sample | None  # of whole numbers, the neighbour on the other side of the wanted value
    others: tuple[float, ...]  # further values that do it, to the width of a step
    seen: tuple[Sample, ...]  # what was looked at, from one end of the range to the other
    edges: tuple[Edge, ...] = ()  # where the read-out's values end within the range

    @property
    def nearest(self) -> tuple[Sample, Sample]:
        by_figure = sorted(self.seen, key=lambda sample: sample.figure)
        return by_figure[0], by_figure[-1]


def solve(
    evaluate: Evaluated, *, wanted: float, places: SearchRange, present: float | None
) -> Solution:
    """Look along the range for changes of sign, and close in on the one nearest to the present.

    `evaluate` gives the read-out, None where there is none; of several solutions the one nearest to
    `present` is found, by Brent's method to 1e-13 of the parameter, of whole numbers by halving.
    """
    seen: list[Sample] = []
    edges: list[Edge] = []
    crossings: list[tuple[Sample, Sample]] = []

    def pass_by(sample: Sample, before: Sample | None) -> Sample:
        seen.append(sample)
        if before is not None and _between(before, sample, wanted):
            crossings.append((before, sample))
        return sample

    before: Sample | None = None
    gap: float | None = None
    for value in places.places():
        figure = evaluate(value)
        if figure is None:
            if before is not None:
                edge = _edge(evaluate, before, value, places)
                edges.append(edge)
                if edge.sample is not before:
                    pass_by(edge.sample, before)
            before, gap = None, value
            continue
        sample = Sample(value, figure)
        if gap is not None:
            edge = _edge(evaluate, sample, gap, places)
            edges.append(edge)
            before = None if edge.sample is sample else pass_by(edge.sample, None)
        before, gap = pass_by(sample, before), None
    if not crossings:
        exact = next((sample for sample in seen if sample.figure == wanted), None)
        return Solution(exact, None, (), tuple(seen), tuple(edges))

    def distance(pair: tuple[Sample, Sample]) -> float:
        if present is None or (places.log and present <= 0):
            return 0.0
        low, high = (_scaled(places, sample.value) for sample in pair)
        now = places.scaled(present)
        return max(low - now, now - high, 0.0)

    chosen = min(crossings, key=distance)
    others = tuple(pair[0].value for pair in crossings if pair is not chosen)
    if places.whole:
        at, beside = _halved(evaluate, *chosen, wanted)
        return Solution(at, beside, others, tuple(seen), tuple(edges))
    at = _brent(evaluate, *chosen, wanted, places)
    return Solution(at, None, others, tuple(seen), tuple(edges))


def _edge(evaluate: Evaluated, sample: Sample, without: float, places: SearchRange) -> Edge:
    """Between a value of the parameter with a read-out and one without: where they meet."""
    on_log = places.log and min(sample.value, without) > 0
    for _ in range(_HALVINGS):
        if places.whole:
            middle = float((int(sample.value) + int(without)) // 2)
        elif on_log:
            middle = places.value(0.5 * (places.scaled(sample.value) + places.scaled(without)))
        else:
            middle = 0.5 * (sample.value + without)
        if middle in (sample.value, without):
            break
        figure = evaluate(middle)
        if figure is None:
            without = middle
        else:
            sample = Sample(middle, figure)
    return Edge(sample, without)


def _between(one: Sample, other: Sample, wanted: float) -> bool:
    first, second = one.figure - wanted, other.figure - wanted
    return first == 0.0 or first * second < 0.0 or (second == 0.0 and first != 0.0)


def _scaled(places: SearchRange, value: float) -> float:
    """On the axis of the places; zero on one of factors lies before all others."""
    return places.scaled(value) if value > 0 or not places.log else places.scaled(places.low) - 1.0


def _brent(
    evaluate: Evaluated, one: Sample, other: Sample, wanted: float, places: SearchRange
) -> Sample:
    for end in (one, other):
        if end.figure == wanted:
            return end
    on_log = places.log and one.value > 0
    known: dict[float, float] = {}

    def excess(scaled: float) -> float:
        value = places.value(scaled) if on_log else scaled
        figure = evaluate(value)
        if figure is None:  # a gap inside: the step that is left is as good as it gets
            raise _Gap
        known[value] = figure
        return figure - wanted

    ends = [places.scaled(s.value) if on_log else s.value for s in (one, other)]
    try:
        brent_root(excess, low=ends[0], high=ends[1])
    except _Gap:
        known |= {one.value: one.figure, other.value: other.figure}
    value = min(known, key=lambda place: abs(known[place] - wanted))
    return Sample(value, known[value])


def _halved(
    evaluate: Evaluated, one: Sample, other: Sample, wanted: float
) -> tuple[Sample, Sample | None]:
    """Two neighbouring whole numbers with the wanted value between them, the nearer one first."""
    low, high = one, other
    while high.value - low.value > 1.0:
        middle = float((int(low.value) + int(high.value)) // 2)
        figure = evaluate(middle)
        if figure is None:
            break
        sample = Sample(middle, figure)
        if _between(low, sample, wanted):
            high = sample
        else:
            low = sample
    first, second = sorted((low, high), key=lambda sample: abs(sample.figure - wanted))
    return (first, None) if first.figure == wanted else (first, second)


# The range in which a parameter is sought, and places in it where a read-out is looked at.

_DECADES = 6.0  # about the present value, where the parameter has no end of its own
_SMALLEST = 1e-12  # of the largest value, where zero itself is not allowed
_LOG_FROM = 1000.0  # the end of a range over its beginning, from which on its steps are factors
_LINEAR_STEPS, _STEPS_A_DECADE, _MOST_STEPS = 32, 3, 60


@dataclass(frozen=True)
class SearchRange:
    # the ends
    low: float
    high: float
    log: bool  # whether places lie equal factors apart
    whole: bool = False  # whether only whole numbers count
    zero: bool = False  # whether 0 is tried beside

    def places(self) -> tuple[float, ...]:
        if self.log:
            decades = math.log10(self.high / self.low)
            count = min(_MOST_STEPS, max(_LINEAR_STEPS, math.ceil(decades * _STEPS_A_DECADE)))
            spaced = np.geomspace(self.low, self.high, count + 1)
        else:
            spaced = np.linspace(self.low, self.high, _LINEAR_STEPS + 1)
        values = [float(value) for value in spaced]
        values[0], values[-1] = self.low, self.high
        if self.whole:
            values = [float(value) for value in dict.fromkeys(map(round, values))]
        return (0.0, *values) if self.zero else tuple(values)

    def scaled(self, value: float) -> float:
        return math.log(value) if self.log else value

    def value(self, scaled: float) -> float:
        return math.exp(scaled) if self.log else scaled


def search_range(parameter: Parameter, present: object, given: str, *, option: str) -> SearchRange:
    """The range given as ``LOW:HIGH``, else the parameter's own, else about its present value."""
    if parameter.kind not in ("number", "integer"):
        raise UsageError(
            f"{option}: {parameter.name} is {parameter.allowed()}, not a number "
            "that can be solved for"
        )
    whole = parameter.kind == "integer"
    if given:
        low, high = low_high(option, given)
        return SearchRange(low, high, low > 0 and high / low >= _LOG_FROM, whole)
    bound_low, bound_high = parameter.param.low, parameter.param.high
    now = float(present) if isinstance(present, int | float) and present else 1.0
    high = bound_high if bound_high is not None else abs(now) * 10.0**_DECADES
    if bound_low is None:
        return SearchRange(-high if bound_high is None else now - abs(high), high, False, whole)
    if bound_low != 0.0 or whole:
        log = bound_low > 0 and high / bound_low >= _LOG_FROM
        return SearchRange(bound_low, high, log, whole)
    # From next to nothing on; the present value is well inside.
    low = min(high * _SMALLEST, abs(now) * 1e-3)
    zero = not parameter.param.above and not (parameter.empty and parameter.param.zero_is_empty)
    return SearchRange(low, high, True, zero=zero)
