"""What a module shows on top of its panel: charts, bars or a picture, as plain data.

A module's `preview` makes it of the planned node; the panel draws it. Colours are places in the
theme's list of curve colours, or names of the theme's other colours.
"""

import math
from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.records import dataclass

Colour = int | Literal["text", "faint_text"]
Style = Literal["solid", "dashed", "dotted", "dots"]

_STEPS = (1.0, 2.0, 5.0, 10.0)


Tick = tuple[float, str]
"""A place on an axis, and what stands there."""


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
        power = math.floor(math.log10(step) + 1e-9)
        form = f".{max(0, -power)}f"
        if step >= 1e5 or step < 1e-5:  # in as many digits as tell one from the next
            form = f".{max(2, math.floor(math.log10(max(-low, high))) - power + 1)}g"
        ticks = []
        for count in range(first, last + 1):
            value = count * step
            text = f"{value:{form}}"
            ticks.append((value, signed(text) if count else "0"))
        return tuple(ticks)

    def _powers(self, most: int) -> tuple[Tick, ...]:
        first = math.ceil(math.log10(self.low) - 1e-9)
        last = math.floor(math.log10(self.high) + 1e-9)
        step = max(1, math.ceil((last - first + 1) / most))
        return tuple((10.0**n, power_of_ten(n)) for n in range(first, last + 1, step))


def round_step(least: float) -> float:
    """The smallest of 1, 2, 5 times a power of ten that is not below."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in _STEPS if step * power >= least * (1 - 1e-9))


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points, broken where a value is NaN; with a `name` it is in the legend.

    `fill` tints what lies below it, or inside where it is closed. Of `dots`, `width` is the radius.
    """

    x: ArrayLike
    y: ArrayLike
    colour: Colour = 0
    style: Style = "solid"
    name: str = ""
    width: float = 1.6
    fill: Literal["", "below", "inside"] = ""


@dataclass(frozen=True)
class Mark:
    """A point of a chart and a text beside it, so many lines further down."""

    x: float
    y: float
    text: str = ""
    colour: Colour = 0
    down: float = 0.0
    dot: bool = True


@dataclass(frozen=True, eq=False)
class Picture:
    """Samples (rows, columns) from `low`, dark, to `high`, light; row 0 at the top.

    Of a `signed` one, from `low` below 0 over light to `high`, in colours, which are explained with
    their `unit`; what is NaN is dark. `shape` is its width and height as they are seen.
    """

    samples: NDArray[Any]
    low: float
    high: float
    shape: tuple[float, float]
    signed: bool = False
    unit: str = ""


@dataclass(frozen=True, eq=False)
class Plot:
    """A chart. `square`: a unit across is as long as one along; then a picture may fill it."""

    x: Axis
    y: Axis
    curves: tuple[Curve, ...] = ()  # dashed ones on top of the others, then the first
    marks: tuple[Mark, ...] = ()
    # Dashed lines at places across, each with a text at its top, so many lines down.
    uprights: tuple[tuple[float, str, int], ...] = ()
    levels: tuple[float, ...] = ()  # heights with a faint line
    band: tuple[float, float] | None = None  # places across between which it is shaded
    square: bool = False
    picture: Picture | None = None


@dataclass(frozen=True)
class Bar:
    """One bar: its name, how long it is beside the others, its value in words, its colour."""

    name: str
    size: float
    value: str
    colour: Colour


@dataclass(frozen=True)
class Bars:
    """Bars below one another, the longest as long as there is room."""

    bars: tuple[Bar, ...]
    lines: float  # height in lines of text


@dataclass(frozen=True)
class Stack:
    """One bar of parts that add up, in a frame of the size `whole`; a text at either side above.

    Parts above 0 are named below it. `excess`: the parts are more than the whole.
    """

    parts: tuple[Bar, ...]
    whole: float | None
    left: str
    right: str
    excess: bool = False
    lines: float = 5.2


Part = Plot | Picture | Bars | Stack | str


@dataclass(frozen=True, eq=False)
class Preview:
    """Parts below one another; with `facts`, one part and lines of text at its right.

    `words` say what is shown, for those who cannot see it.
    """

    words: str
    parts: tuple[Part, ...]
    facts: tuple[str, ...] = ()
    more_lines: float = 0.0  # of height than the module's previews have


# Numbers as previews write them: few digits, powers of ten in print.

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PLAIN = (1e-3, 1e5)  # sizes written without a power of ten


def brief(value: float, digits: int = 3) -> str:
    """A number in that many digits, such as 0.489 or 1.1·10¹¹."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}".replace("-0", "0")
    shown = f"{value:.{digits - 1}e}"
    if _PLAIN[0] <= abs(value) < _PLAIN[1]:
        whole = abs(float(shown)) >= 10**digits  # as shown: 999.6 in three digits is 1000
        return signed(f"{value:.0f}" if whole else f"{value:.{digits}g}")
    mantissa, _, exponent = shown.partition("e")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return signed(f"{mantissa}·{power_of_ten(int(exponent))}")


def power_of_ten(exponent: int) -> str:
    """10 with its exponent raised."""
    return f"10{str(exponent).translate(_RAISED)}"


def signed(text: str) -> str:
    return text.replace("-", "\N{MINUS SIGN}")


def kelvin(value: float) -> str:
    if value == 0 or abs(value) >= 0.1:
        return f"{brief(value)} K"
    return f"{brief(1e3 * value)} mK"


def electrons(value: float) -> str:
    """Electrons, as data sheets give them: e⁻, ke⁻ or Me⁻."""
    for least, unit, prefix in ((1e6, 1e6, "M"), (1e4, 1e3, "k")):
        if abs(value) >= least:
            return f"{brief(value / unit)} {prefix}e\N{SUPERSCRIPT MINUS}"
    return f"{brief(value)} e\N{SUPERSCRIPT MINUS}"


def pair(x: float, y: float, digits: int = 3) -> str:
    """Across × along, or one number where both are the same."""
    first, second = brief(x, digits), brief(y, digits)
    return first if first == second else f"{first} × {second}"


def not_connected(inputs: Iterable[str]) -> str:
    return f"not connected yet: {', '.join(inputs)}"
