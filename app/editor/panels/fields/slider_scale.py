"""Which numbers a slider covers, and where on it each of them lies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from core.modules.parameters import Parameter

POSITIONS = 1000
PER_DECADE = 100
LOGARITHMIC_FROM = 1000.0
LARGEST_WHOLE_RANGE = 1e6

# Usual ranges, by unit, where the declaration leaves the range open.
_USUAL: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "µm": (0.4, 20.0),
        "mm": (1.0, 500.0),
        "cm": (1.0, 100.0),
        "m": (10.0, 10000.0),
        "km": (0.1, 10.0),
        "s": (1e-6, 1.0),
        "Hz": (1.0, 1e6),
        "K": (200.0, 400.0),
        "%": (0.0, 100.0),
        "mrad": (0.0, 5.0),
        "mrad/s": (0.0, 1e5),
        "m/s": (0.0, 300.0),
        "cyc/mrad": (1e-4, 10.0),
        "cm √Hz/W": (1e8, 1e14),
        "m^(-2/3)": (1e-18, 1e-12),
        "1/km": (0.0, 1.0),
        "W/m²/sr": (0.0, 100.0),
    }
)
_PLAIN = (0.0, 100.0)


@dataclass(frozen=True)
class Scale:
    """Positions 0 … `positions` of a slider over `low` … `high`.

    A logarithmic one may have 0 at its lower end, where `zero` is set.
    """

    low: float
    high: float
    whole: bool = False
    zero: bool = False

    @property
    def logarithmic(self) -> bool:
        """Whether equal ways on it are equal factors."""
        return self.low > 0 and self.high / self.low >= LOGARITHMIC_FROM

    @property
    def positions(self) -> int:
        """The last position."""
        if self.logarithmic:
            return math.ceil(PER_DECADE * math.log10(self.high / self.low))
        span = self.high - self.low
        return int(span) if self.whole and span <= 2 * POSITIONS else POSITIONS

    @property
    def rest(self) -> float:
        """Its position while there is no number."""
        return min(max(0.0, self.low), self.high)

    def value_at(self, position: int) -> float | int:
        """The number at a position, with no more digits than it can be placed by."""
        share = min(max(position / self.positions, 0.0), 1.0)
        if self.logarithmic:
            if self.zero and position <= 0:
                return 0 if self.whole else 0.0
            value = float(f"{self.low * (self.high / self.low) ** share:.3g}")
        else:
            step = (self.high - self.low) / self.positions
            value = round(self.low + share * (self.high - self.low), _decimals(step))
        value = min(max(value, self.low), self.high)
        return round(value) if self.whole else value

    def position_of(self, value: float | None) -> int:
        """The position next to a number; of `rest` for none."""
        if value is None:
            value = self.rest
        if value <= self.low:
            return 0
        if value >= self.high:
            return self.positions
        if self.logarithmic:
            share = math.log(value / self.low) / math.log(self.high / self.low)
        else:
            share = (value - self.low) / (self.high - self.low)
        return round(share * self.positions)

    def stepped(self, value: float | None, steps: float) -> float | int:
        """So many small steps from a number, which keeps its own digits."""
        start = self.rest if value is None else value
        result = start + steps * self._step(start, down=steps < 0)
        if self.logarithmic and start > 0:
            result = max(result, start / 10)
        return round(result) if self.whole else float(f"{result:.10g}")

    def within(self, value: float, start: float | None) -> float | int:
        """Kept on the scale, or not farther off it than the number one started from."""
        start = self.rest if start is None else start
        floor = 0.0 if self.logarithmic and self.zero else self.low
        clamped = min(max(value, min(floor, start)), max(self.high, start))
        return round(clamped) if self.whole else clamped

    def _step(self, value: float, *, down: bool) -> float:
        if not self.logarithmic:
            step = _nice((self.high - self.low) / 100)
        elif value < self.low:
            step = self.low
        else:
            decade = math.floor(math.log10(value) + 1e-9)
            at_decade = down and math.isclose(value, 10.0**decade)
            step = 10.0 ** (decade - (2 if at_decade else 1))
        return max(1.0, float(round(step))) if self.whole else step


def scale_of(parameter: Parameter) -> Scale:
    """The slider for a number: its declared part, its range, or what is usual in its unit."""
    param = parameter.param
    whole = parameter.kind == "integer"
    low, high = param.slider or _range(parameter, whole)
    if param.low is not None:
        low = max(low, param.low)
    if param.high is not None:
        high = min(high, param.high)
    margin = (high - low) / POSITIONS
    if param.above and low == param.low:
        low += 1 if whole else margin
    if param.below and high == param.high:
        high -= 1 if whole else margin
    zero_allowed = param.low is None or param.low < 0 or (param.low == 0 and not param.above)
    return Scale(low, high, whole, zero=zero_allowed)


def _range(parameter: Parameter, whole: bool) -> tuple[float, float]:
    param, default = parameter.param, parameter.default
    bounded = param.low is not None and param.high is not None
    if bounded and not (whole and param.high - param.low > LARGEST_WHOLE_RANGE):  # type: ignore[operator]
        return float(param.low), float(param.high)  # type: ignore[arg-type]
    given = abs(default) if isinstance(default, int | float) else 0.0
    low, high = _USUAL.get(param.unit, (0.0, 10 * given) if given else _PLAIN)
    if given > high:
        high = 10 * given
    return (low, high) if param.low is not None else (-high, high)


def _decimals(step: float) -> int:
    return max(0, math.ceil(-math.log10(step)))


def _nice(step: float) -> float:
    """1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next((n * power for n in (1, 2, 5) if n * power >= step * 0.999), 10 * power)
