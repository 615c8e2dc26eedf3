"""Over which values a parameter is traded off, and in which order they are computed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from app.editor.panels.fields.slider_scale import LARGEST_WHOLE_RANGE, scale_of
from app.tradeoff.values import is_number, spaced
from core.modules.parameters import Parameter

COARSE = 5
PART = 8  # values in one query: it starts anew if an edit comes
NEAR = 0.2  # of a declared range: below that share of its end it would hide what happens
LOG_FROM = 3000.0  # the end of a range over its beginning, from which on its steps are factors
DEFAULT_COUNT = 25
LEAST_COUNT, MOST_COUNT = 2, 201


@dataclass(frozen=True)
class Span:
    """From one number to a greater one, in equal steps or factors."""

    low: float
    high: float
    log: bool = False
    whole: bool = False
    count: int = DEFAULT_COUNT

    def values(self) -> tuple[float | int, ...]:
        """The numbers."""
        return spaced(self.low, self.high, self.count, log=self.log, whole=self.whole)

    def share(self, value: float) -> float:
        """Where a number lies: 0 at the low end, 1 at the high one."""
        low, high, value = (self._scaled(number) for number in (self.low, self.high, value))
        return (value - low) / (high - low)

    def value_at(self, share: float) -> float | int:
        """The number at a place, with no more digits than it can be placed by."""
        share = min(max(share, 0.0), 1.0)
        low, high = self._scaled(self.low), self._scaled(self.high)
        value = low + share * (high - low)
        if self.log:
            value = float(f"{math.exp(value):.3g}")
        else:
            value = round(value, max(0, math.ceil(-math.log10((high - low) / 1000))))
        value = min(max(value, self.low), self.high)
        return round(value) if self.whole else value

    def _scaled(self, value: float) -> float:
        return math.log(max(value, 1e-300)) if self.log else value


def usual_span(parameter: Parameter, present: Any) -> Span:
    """A range to begin with: the declared one, else around the present value.

    Parameters
    ----------
    parameter : Parameter
        A number, whole or not.
    present : object
        Its value; None where it is empty.
    """
    scale, param = scale_of(parameter), parameter.param
    whole = parameter.kind == "integer"
    bounded = param.low is not None and param.high is not None
    declared = param.slider is not None or (
        bounded and param.high - param.low <= LARGEST_WHOLE_RANGE  # type: ignore[operator]
    )
    value = float(present) if is_number(present) else 0.0
    near = NEAR * scale.high <= abs(value) and scale.low <= value <= scale.high
    if (declared and near) or not value:
        low, high = scale.low, scale.high
        if low <= 0 and _zero_is_empty(parameter):
            low = _least(scale.high, whole)
        return Span(low, high, _spans_decades(low, high), whole)
    if _spans_decades(scale.low, scale.high) and value > 0:
        return _within(parameter, Span(value / 10, value * 10, log=True, whole=whole))
    start = 0.5 * value if _zero_is_empty(parameter) or param.above else 0.0
    low, high = sorted((start, 2.0 * value))
    return _within(parameter, Span(low, high, whole=whole))


def coarse_first(values: tuple[Any, ...]) -> tuple[tuple[Any, ...], ...]:
    """The values in parts: a few over the whole range, then those halfway between, and so on."""
    last = len(values) - 1
    done = sorted({round(number * last / (COARSE - 1)) for number in range(COARSE)})
    parts = [done]
    while len(done) <= last:
        between = [(a + b) // 2 for a, b in pairwise(done) if b - a > 1]
        parts += [between[start : start + PART] for start in range(0, len(between), PART)]
        done = sorted([*done, *between])
    return tuple(tuple(values[index] for index in part) for part in parts)


def _spans_decades(low: float, high: float) -> bool:
    return low > 0 and high / low >= LOG_FROM


def _zero_is_empty(parameter: Parameter) -> bool:
    return parameter.empty and parameter.param.zero_is_empty


def _least(high: float, whole: bool) -> float:
    return 1.0 if whole else high / 100


def _within(parameter: Parameter, span: Span) -> Span:
    """Cut at the declared limits; whole numbers at least one apart."""
    low, high = span.low, span.high
    if span.whole:
        low = float(math.floor(low))
        if low == 0 and _zero_is_empty(parameter):
            low = 1.0
        high = float(max(math.ceil(high), low + 1))
    if parameter.param.low is not None:
        low = max(low, parameter.param.low)
    if parameter.param.high is not None:
        high = min(high, parameter.param.high)
    if span.log and low <= 0:
        low = high / 100
    return Span(low, high, span.log, span.whole) if low < high else span
