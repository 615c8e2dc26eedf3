"""Axes of small charts: where a value lies, and which ticks have a number."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.editor.panels.illustrations.painting.few_digits import power_of_ten, signed

_STEPS = (1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True)
class Tick:
    """A place on an axis, and what stands there."""

    value: float
    text: str


@dataclass(frozen=True)
class Axis:
    """From `low` to `high`, on a linear scale or, for values above 0, a logarithmic one.

    `reach` is where ticks end, if not at `high`.
    """

    low: float
    high: float
    title: str = ""
    log: bool = False
    reach: float | None = None

    def share(self, values: ArrayLike) -> NDArray[Any]:
        """Where values lie: 0 at the low end, 1 at the high one."""
        array = np.asarray(values, np.float64)
        if not self.log:
            return np.asarray((array - self.low) / (self.high - self.low))
        start, end = math.log(self.low), math.log(self.high)
        return np.asarray((np.log(np.maximum(array, self.low * 1e-30)) - start) / (end - start))

    def ticks(self, most: int) -> tuple[Tick, ...]:
        """Round values in the range, about so many at most."""
        most = max(2, most)
        return self._powers(most) if self.log else self._steps(most)

    def _steps(self, most: int) -> tuple[Tick, ...]:
        low, high = sorted((self.low, self.high if self.reach is None else self.reach))
        step = round_step((high - low) / most)
        first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
        places = max(0, -math.floor(math.log10(step) + 1e-9))
        scientific = step >= 1e5 or step < 1e-5
        ticks = []
        for count in range(first, last + 1):
            value = count * step
            text = f"{value:.2g}" if scientific else f"{value:.{places}f}"
            ticks.append(Tick(value, signed(text) if count else "0"))
        return tuple(ticks)

    def _powers(self, most: int) -> tuple[Tick, ...]:
        first = math.ceil(math.log10(self.low) - 1e-9)
        last = math.floor(math.log10(self.high) + 1e-9)
        step = max(1, math.ceil((last - first + 1) / most))
        return tuple(Tick(10.0**n, power_of_ten(n)) for n in range(first, last + 1, step))


def round_step(least: float) -> float:
    """The smallest of 1, 2, 5 times a power of ten that is not below."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in _STEPS if step * power >= least * (1 - 1e-9))
