"""Expressions that a parameter follows, and the units that their numbers may be written in."""

import math
import operator
import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache, partial
from typing import Any, Literal

from core.errors import InputError, close, shown
from core.records import dataclass

Factor = Fraction | float

_DEGREE = math.pi / 180.0

# By what is measured: each unit's symbol, and the power of ten, or the factor, that makes it the
# first unit of its row. A symbol stands in one row alone. A unit that no row has is converted to no
# other.
_ROWS: Mapping[str, Mapping[str, int | Factor]] = {
    "length": {"m": 0, "nm": -9, "µm": -6, "um": -6, "mm": -3, "cm": -2, "km": 3},
    "time": {"s": 0, "ns": -9, "µs": -6, "us": -6, "ms": -3},
    "frequency": {"Hz": 0, "kHz": 3, "MHz": 6, "GHz": 9},
    "angle": {"rad": 0, "nrad": -9, "µrad": -6, "urad": -6, "mrad": -3, "deg": _DEGREE,
              "°": _DEGREE, "arcmin": _DEGREE / 60.0, "arcsec": _DEGREE / 3600.0},
    "angular rate": {"rad/s": 0, "µrad/s": -6, "urad/s": -6, "mrad/s": -3,
                     "deg/s": _DEGREE, "°/s": _DEGREE},
    "speed": {"m/s": 0, "mm/s": -3, "km/s": 3, "km/h": Fraction(1000, 3600)},
    "angular frequency": {"cyc/mrad": 0, "cyc/rad": -3, "cyc/deg": 1.0 / (_DEGREE * 1000.0)},
    "temperature": {"K": 0, "mK": -3},
    "spectral radiance": {"W/m²/sr/µm": 0, "W/m²/sr/nm": 3, "W/cm²/sr/µm": 4},
    "spectral irradiance": {"W/m²/µm": 0, "W/m²/nm": 3},
    "electron count": {"e-": 0, "ke-": 3, "Me-": 6},
    "electron current": {"e-/s": 0, "ke-/s": 3},
    "current density": {"A/cm²": 0, "A/cm2": 0, "µA/cm²": -6, "nA/cm²": -9, "pA/cm²": -12},
    "responsivity": {"A/W": 0, "mA/W": -3},
    "gain": {"e-/DN": 0},
    "digital number": {"DN": 0},
    "extinction": {"1/km": 0, "/km": 0, "1/m": 3, "/m": 3, "1/cm": 5, "1/mm": 6, "1/µm": 9,
                   "1/um": 9},
    "radiance": {"W/m²/sr": 0, "W/m2/sr": 0, "W/m^2/sr": 0, "W/cm²/sr": 4, "W/cm2/sr": 4,
                 "mW/cm²/sr": 1, "mW/cm2/sr": 1, "µW/cm²/sr": -2, "uW/cm2/sr": -2},
    "illuminance": {"lx": 0, "mlx": -3, "klx": 3},
    "luminance": {"cd/m²": 0, "cd/m2": 0, "cd/m^2": 0},
    "detectivity": {"cm √Hz/W": 0, "cm Hz^0.5/W": 0, "Jones": 0},
    "turbulence": {"m^(-2/3)": 0},
    "proportion": {"": 0, "%": -2},
    "scatter": {"1/sr": 0, "/sr": 0},
    "image speed": {"px/s": 0},
    "sample count": {"px": 0, "samples": 0, "pixels": 0},
    "digital resolution": {"bit": 0, "bits": 0},
    "camera gain": {"dB": 0},
    "relative frequency": {"Nyquist": 0},
    "frequency per frame": {"cycles per frame": 0},
    "wavefront": {"waves": 0},
    "wavefront error": {"waves rms": 0},
}  # fmt: skip
_KINDS: Mapping[str, Mapping[str, Factor]] = {
    kind: {unit: Fraction(10) ** by if isinstance(by, int) else by for unit, by in row.items()}
    for kind, row in _ROWS.items()
}


def canonical(unit: str) -> str:
    """The unit with its micro sign as declarations write it: Unicode has two."""
    return unit.replace("\N{GREEK SMALL LETTER MU}", "µ")


def symbols() -> tuple[str, ...]:
    """Every symbol that can be written behind a number, longest first."""
    every = {symbol for row in _KINDS.values() for symbol in row if symbol}
    return tuple(sorted(every, key=len, reverse=True))


def kind_of(unit: str) -> str:
    """What a unit measures; empty for one that is converted to no other."""
    return next((kind for kind, row in _KINDS.items() if canonical(unit) in row), "")


def fitting(unit: str) -> tuple[str, ...]:
    """The units that convert to `unit`, itself included."""
    row = _KINDS.get(kind_of(unit), {})
    return tuple(symbol for symbol in row if symbol) or ((unit,) if unit else ())


def converted(number: Fraction | float, unit: str, wanted: str) -> Fraction | float | None:
    """The number in another unit; None where the units measure other things."""
    unit, wanted = canonical(unit), canonical(wanted)
    if unit == wanted:
        return number
    row = _KINDS.get(kind_of(unit), {})
    if wanted not in row:
        return None
    have, want = row[unit], row[wanted]
    if isinstance(have, Fraction) and isinstance(want, Fraction):
        ratio = have / want
        return number * ratio if isinstance(number, Fraction) else number * float(ratio)
    return float(number) * (float(have) / float(want))


def similar(unit: str) -> str:
    """A suggestion for a unit that there is not, to end an error with."""
    folded = {symbol.casefold(): symbol for symbol in symbols()}
    if unit.casefold() in folded:
        return f"; did you mean {folded[unit.casefold()]}?"
    return close(unit, symbols())


# Expressions that a parameter follows: their text read, and their value; none is run as code.
#
#     sum      = product {("+" | "-") product}
#     product  = signed {("*" | "/") signed}
#     signed   = {"-" | "+"} power
#     power    = value [("^" | "**") signed]
#     value    = (number | NODE.PARAMETER | "pi" | "(" sum ")" | function) [unit]
#     function = name "(" sum {"," sum} ")"
#
# A node whose name is no plain word stands in single quotes, a quote in it twice: ``'Lens 2'.x``.
# Sums, products and quotients of decimal numbers are made of fractions and rounded once, at the
# end: ``3 * 0.1`` is 0.3. What a function or a power gives is a double.

LONGEST = 1000
DEEPEST = 40
_LARGEST_EXPONENT = 400  # of a number that is taken as a fraction: a double has none beyond
_LONG_EXPONENT = 8

Function = Callable[..., Any]
Moved = Callable[[str, str], tuple[str, str]]
"""What is to be named in the place of a node and its parameter."""

# How many arguments each takes (None: two or more), and whether they may have a unit: it goes on to
# the result ("keeps"), is turned into radians ("angle"), or is refused ("none").
Units = Literal["keeps", "angle", "none"]
FUNCTIONS: Mapping[str, tuple[Function, int | None, Units]] = {
    **{one.__name__: (one, 1, "none") for one in (math.sqrt, math.exp, math.log, math.log10)},
    **{one.__name__: (one, 1, "angle") for one in (math.sin, math.cos, math.tan)},
    "atan": (math.atan, 1, "none"),
    **{one.__name__: (one, 1, "keeps") for one in (abs, round, math.floor, math.ceil)},
    **{one.__name__: (one, None, "keeps") for one in (min, max)},
}
ALLOWED = f"numbers, NODE.PARAMETER, + - * / ^ ( ), pi and the functions {', '.join(FUNCTIONS)}"

_SPACE = re.compile(r"\s*")
_NUMBER = re.compile(r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", re.ASCII)
_NAME = re.compile(r"[^\W\d]\w*")
_QUOTED = re.compile(r"'((?:[^']|'')*)'")
_OPERATOR = re.compile(r"\*\*|[-+*/^(),]")
_SIGNS = str.maketrans({"\N{MINUS SIGN}": "-", "×": "*", "·": "*", "÷": "/"})
_AFTER_UNIT = re.compile(r"[\w.(']")


class ExpressionError(InputError):
    """An expression that cannot be read, or has no value."""


@dataclass(frozen=True)
class Reference:
    """A parameter that an expression names, and where in its text the node's name stands."""

    node: str
    parameter: str
    start: int
    end: int

    @property
    def text(self) -> str:
        return f"{quoted(self.node)}.{self.parameter}"


Exact = Fraction | float
Lookup = Callable[[Reference], float]
Number = tuple[Exact, bool]
"""The value, and whether it was written with a unit."""
Context = tuple[str, Lookup]
"""The unit of the parameter, and what gives the value of another."""
Step = tuple[int, Callable[..., Number]]
"""How many numbers are taken off a stack, and what makes one of a context and these."""


@dataclass(frozen=True)
class Expression:
    """An expression that has been read: its text, its steps, and what it names."""

    text: str
    steps: tuple[Step, ...]
    references: tuple[Reference, ...]


def quoted(node: str) -> str:
    """A node's name as an expression has it."""
    return node if _NAME.fullmatch(node) else "'" + node.replace("'", "''") + "'"


def readable(parameter: str) -> bool:
    return _NAME.fullmatch(parameter) is not None


@lru_cache(maxsize=512)
def parse_expression(text: str) -> Expression:
    if len(text) > LONGEST:
        raise ExpressionError(
            f"the expression has {len(text)} characters; at most {LONGEST} are allowed"
        )
    reader = _Reader(text)
    reader.sum(0, angle=False)
    reader.end()
    return Expression(text, tuple(reader.steps), tuple(reader.references))


def rewritten(text: str, moved: Moved) -> str:
    """The expression with other nodes and parameters named; one that cannot be read stays."""
    try:
        references = parse_expression(text).references
    except ExpressionError:
        return text
    for reference in sorted(references, key=lambda one: one.start, reverse=True):
        new = moved(reference.node, reference.parameter)
        if new != (reference.node, reference.parameter):
            end = reference.end + 1 + len(reference.parameter)
            text = f"{text[: reference.start]}{quoted(new[0])}.{new[1]}{text[end:]}"
    return text


class _Reader:
    def __init__(self, text: str) -> None:
        # One character for one: places in it are places in the text that was given.
        self.text = canonical(text.translate(_SIGNS))
        self.given = text
        self.at = 0
        self.steps: list[Step] = []
        self.references: list[Reference] = []
        self.takes_unit = False  # a number or parameter was read last
        self.skip()

    def skip(self) -> None:
        match = _SPACE.match(self.text, self.at)
        self.at = match.end() if match else self.at

    def add(self, count: int, function: Callable[..., Number]) -> None:
        self.steps.append((count, function))
        self.takes_unit = False

    def add_value(self, value: Exact) -> None:
        self.add(0, lambda _: (value, False))
        self.takes_unit = True

    def operator(self, *wanted: str) -> str:
        match = _OPERATOR.match(self.text, self.at)
        if match is None or match[0] not in wanted:
            return ""
        self.at = match.end()
        self.skip()
        return match[0]

    def fault(self, wanted: str) -> ExpressionError:
        """The error for what stands next where `wanted` should."""
        if not self.given.strip():
            return ExpressionError(f"the expression is empty; allowed: {ALLOWED}")
        if self.at >= len(self.text):
            return ExpressionError(f"the expression is not complete; expected: {wanted}")
        match = _NAME.match(self.text, self.at) or _NUMBER.match(self.text, self.at)
        next_text = match[0] if match else self.given[self.at]
        place = f"at character {self.at + 1}"
        if next_text == ",":
            return ExpressionError(
                f"',' {place} is not allowed here; expected: {wanted}. A comma separates the "
                "arguments of min and max; the decimal point is '.'"
            )
        return ExpressionError(
            f"{shown(next_text)} {place} is not allowed here; expected: {wanted}"
        )

    def end(self) -> None:
        if self.at < len(self.text):
            word = re.compile(r"[^\W\d][\w/²%^]*").match(self.text, self.at)
            if word and self.takes_unit:
                unit = word[0]
                hint = similar(unit) or "; an operator such as * may be missing"
                raise ExpressionError(f"{shown(unit)} is not a known unit{hint}")
            raise self.fault("an operator such as + - * / ^")

    def sum(self, depth: int, *, angle: bool) -> None:
        self.product(depth, angle=angle)
        while sign := self.operator("+", "-"):
            self.product(depth, angle=angle)
            self.add(2, partial(_combined, sign))

    def product(self, depth: int, *, angle: bool) -> None:
        self.signed(depth, angle=angle)
        while sign := self.operator("*", "/"):
            self.signed(depth, angle=angle)
            self.add(2, partial(_combined, sign))

    def signed(self, depth: int, *, angle: bool) -> None:
        negative = False
        while sign := self.operator("-", "+"):
            negative ^= sign == "-"
        self.power(depth, angle=angle)
        if negative:
            self.add(1, _negative)

    def power(self, depth: int, *, angle: bool) -> None:
        if depth > DEEPEST:
            raise ExpressionError(f"the expression is nested more than {DEEPEST} levels deep")
        self.value(depth, angle=angle)
        if self.operator("^", "**"):
            self.signed(depth + 1, angle=angle)
            self.add(2, partial(_combined, "^"))

    def value(self, depth: int, *, angle: bool) -> None:
        if self.operator("("):
            self.sum(depth + 1, angle=angle)
            self.closed()
        elif number := _NUMBER.match(self.text, self.at):
            self.at = number.end()
            self.add_value(_number(number))
        else:
            self.named(depth)
        self.unit(angle=angle)

    def closed(self) -> None:
        if not self.operator(")"):
            raise self.fault("')'")

    def named(self, depth: int) -> None:
        start = self.at
        match = _QUOTED.match(self.text, start) or _NAME.match(self.text, start)
        if match is None:
            raise self.fault("a number, a NODE.PARAMETER or a function")
        end = match.end()
        plain = not match[0].startswith("'")
        parameter = _NAME.match(self.text, end + 1) if self.text[end : end + 1] == "." else None
        if parameter is not None:
            # What the reader's own text has in place of another sign is the name as it was given.
            node = self.given[start:end] if plain else self.given[start + 1 : end - 1]
            node = node if plain else node.replace("''", "'")
            name = self.given[parameter.start() : parameter.end()]
            reference = Reference(node, name, start, end)
            self.references.append(reference)
            self.add(0, partial(_looked_up, reference))
            self.takes_unit = True
            self.at = parameter.end()
            return
        self.at = end
        self.skip()
        if plain and self.operator("("):
            self.called(match[0], depth)
        elif plain and match[0] == "pi":
            self.add_value(math.pi)
        else:
            raise _no_parameter(match[0])

    def called(self, name: str, depth: int) -> None:
        if name not in FUNCTIONS:
            hint = close(name, FUNCTIONS) or f"; the functions are {', '.join(FUNCTIONS)}"
            raise ExpressionError(f"there is no function {shown(name)}{hint}")
        _, wanted, units = FUNCTIONS[name]
        if self.text[self.at : self.at + 1] == ")":
            raise ExpressionError(f"{name}() has no arguments")
        count = 1
        self.sum(depth + 1, angle=units == "angle")
        while self.operator(","):
            self.sum(depth + 1, angle=units == "angle")
            count += 1
        self.closed()
        if count != wanted if wanted is not None else count < 2:
            allowed = "two or more numbers" if wanted is None else "one number"
            raise ExpressionError(f"{name} takes {allowed}, not {count}")
        self.add(count, partial(_called, name))

    def unit(self, *, angle: bool) -> None:
        self.skip()
        for symbol in symbols():
            end = self.at + len(symbol)
            if self.text.startswith(symbol, self.at) and not _AFTER_UNIT.match(self.text, end):
                self.at = end
                self.skip()
                self.add(1, partial(_in_unit, symbol, angle))
                return


def _number(match: re.Match[str]) -> Fraction | float:
    """The number as written; its double where its exponent would make a fraction huge."""
    value = float(match[0])
    if not math.isfinite(value):
        raise ExpressionError(f"the number {shown(match[0])} is too large")
    exponent = match[2] or "e0"
    short = len(exponent) < _LONG_EXPONENT and abs(int(exponent[1:])) <= _LARGEST_EXPONENT
    return Fraction(match[0]) if short else value


def _no_parameter(name: str) -> ExpressionError:
    if name in FUNCTIONS:
        return ExpressionError(f"{name} is a function: write its arguments in parentheses after it")
    text = f"{shown(name)} is not a number or a parameter"
    hint = close(name, [*FUNCTIONS, "pi"])
    return ExpressionError(text + (hint or ": write NODE.PARAMETER, such as init.f_number"))


_MOST_BITS = 4096  # of a fraction: beyond, its next double is taken


def no_references(reference: Reference) -> float:
    """For arithmetic among numbers alone: it always raises `ExpressionError`."""
    raise ExpressionError(f"{reference.text} is another parameter: begin with = to link to it")


def value_of(expression: Expression, *, unit: str, lookup: Lookup = no_references) -> int | float:
    """What an expression comes to, as a number of `unit`; an `int` where it is exactly whole.

    Numbers with a unit are converted to that of the parameter, empty for a pure number; numbers
    without, and parameters, count as they are. `lookup` gives the value of a parameter.
    """
    stack: list[Number] = []
    for count, function in expression.steps:
        at = len(stack) - count
        stack[at:] = [function((unit, lookup), *stack[at:])]
    value = stack[-1][0]
    if isinstance(value, Fraction) and value.denominator == 1:
        return value.numerator
    return _as_double(value, "the result") + 0.0  # −0.0 and 0.0 are one value


def _looked_up(reference: Reference, context: Context) -> Number:
    return Fraction(str(context[1](reference))), False


def _negative(_: Context, number: Number) -> Number:
    return -number[0], number[1]


def _in_unit(unit: str, angle: bool, context: Context, number: Number) -> Number:
    if number[1]:
        raise ExpressionError(f"a number has two units; the second is {unit}")
    target = "rad" if angle else context[0]
    value = converted(number[0], unit, target)
    if value is None:
        units = ", ".join(fitting(target))
        what = f"this value is in {target}: write {units}" if target else "this value has no unit"
        raise ExpressionError(f"{unit} is a unit of {kind_of(unit)}, but {what}")
    return _checked(value, f"{_short(number[0])} {unit}"), True


def _called(name: str, _: Context, *taken: Number) -> Number:
    function, _count, units = FUNCTIONS[name]
    values = [value for value, _ in taken]
    has_unit = any(has for _, has in taken)
    if units == "none" and has_unit:
        raise ExpressionError(f"{name} needs pure numbers, without a unit")
    text = f"{name}({', '.join(map(_short, values))})"
    return _attempt(text, function, *values), units == "keeps" and has_unit


_OPERATIONS: Mapping[str, Function] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "^": math.pow
}  # fmt: skip


def _combined(sign: str, _: Context, left: Number, right: Number) -> Number:
    text = f"{_short(left[0])} {sign} {_short(right[0])}"
    has_unit = left[1] or right[1]
    if sign == "*" and left[1] and right[1]:
        raise ExpressionError(
            "two numbers with units are multiplied: remove the unit from one of them"
        )
    if sign == "/" and right[1]:
        if not left[1]:
            raise ExpressionError(
                "a number is divided by a number with a unit: for 1/60 deg write (1/60) deg"
            )
        has_unit = False
    if sign == "^" and has_unit:
        raise ExpressionError(
            "^ needs pure numbers: write the unit after the parentheses, as in (2^3) mm"
        )
    values = [left[0], right[0]]
    if sign == "^" or any(isinstance(value, float) for value in values):
        values = [_as_double(value, text) for value in values]
    return _attempt(text, _OPERATIONS[sign], *values), has_unit


def _attempt(text: str, function: Function, *values: Exact) -> Exact:
    try:
        return _checked(function(*values), text)
    except ZeroDivisionError:
        raise ExpressionError(f"{text} divides by zero") from None
    except OverflowError:
        raise ExpressionError(f"{text} is too large: the largest number is 1.8e308") from None
    except ValueError:
        raise ExpressionError(f"{text} is not a real number") from None


def _checked(value: Any, text: str) -> Exact:
    """A result that is a finite double, with no more digits than can be carried on."""
    double = _as_double(value, text)
    if not isinstance(value, int | Fraction):
        return double
    value = Fraction(value)
    bits = max(value.numerator.bit_length(), value.denominator.bit_length())
    return value if bits <= _MOST_BITS else double


def _as_double(value: Exact, text: str) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ExpressionError(f"{text} is too large: the largest number is 1.8e308")
    return number


def _short(value: Exact) -> str:
    return f"{float(value):g}"
