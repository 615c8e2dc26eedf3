"""The range in which a parameter is sought, and places in it where a read-out is looked at."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.errors import UsageError
from core.modules.parameters import Parameter

_DECADES = 6.0  # about the present value, where the parameter has no end of its own
_SMALLEST = 1e-12  # of the largest value, where zero itself is not allowed
_LOG_FROM = 1000.0  # the end of a range over its beginning, from which on its steps are factors
_LINEAR_STEPS, _STEPS_A_DECADE, _MOST_STEPS = 32, 3, 60


@dataclass(frozen=True)
class SearchRange:
    """From one number to a greater one.

    Parameters
    ----------
    low, high : float
        The ends.
    log : bool
        Whether places lie equal factors apart.
    whole : bool
        Whether only whole numbers count.
    zero : bool
        Whether 0 is tried beside.
    """

    low: float
    high: float
    log: bool
    whole: bool = False
    zero: bool = False

    def places(self) -> tuple[float, ...]:
        """Numbers from one end to the other."""
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
        """The number on the axis of the places."""
        return math.log(value) if self.log else value

    def value(self, scaled: float) -> float:
        """The number at a place of that axis."""
        return math.exp(scaled) if self.log else scaled


def search_range(parameter: Parameter, present: object, given: str, *, option: str) -> SearchRange:
    """The range given as ``LOW:HIGH``, else the parameter's own, else about its present value.

    Raises
    ------
    UsageError
        If what is given is no range, or the parameter no number.
    """
    if parameter.kind not in ("number", "integer"):
        raise UsageError(f"{option}: {parameter.name} is {parameter.allowed()}, no number to solve")
    whole = parameter.kind == "integer"
    if given:
        low, high = _given(given, option)
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


def _given(text: str, option: str) -> tuple[float, float]:
    first, colon, last = text.partition(":")
    try:
        low, high = float(first), float(last)
    except ValueError:
        low = high = math.nan
    if not (colon and math.isfinite(low) and math.isfinite(high) and low < high):
        raise UsageError(f"{option}={text:.80}: write NODE.PARAM=LOW:HIGH, LOW below HIGH")
    return low, high
