"""The value of an expression: exact where it can be, always finite.

Sums, products and quotients of decimal numbers are made of fractions and rounded once, at the end:
``3 * 0.1`` is 0.3. What a function or a power gives is a double.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from core.network.expression_grammar import (
    FUNCTIONS,
    Expression,
    ExpressionError,
    Reference,
    Step,
    converted,
    fitting,
    kind_of,
)

Exact = Fraction | float
Lookup = Callable[[Reference], float]
_Number = tuple[Exact, bool]  # the value, and whether it was written with a unit
_MOST_BITS = 4096  # of a fraction: beyond, its next double is taken


def no_references(reference: Reference) -> float:
    """For arithmetic among numbers alone: it always raises `ExpressionError`."""
    raise ExpressionError(f"{reference.text} is another parameter: begin with = to follow it")


def value_of(expression: Expression, *, unit: str, lookup: Lookup = no_references) -> int | float:
    """What an expression comes to, as a number of `unit`; an `int` where it is exactly whole.

    Numbers written with a unit are converted to that of the parameter, empty for a pure number;
    numbers without, and parameters, count as they are. `lookup` gives the value of a parameter, in
    its own unit.
    """
    stack: list[_Number] = []
    for step in expression.steps:
        taken = stack[len(stack) - step.count :]
        del stack[len(stack) - step.count :]
        if step.kind == "number":
            stack.append((step.value, False))
        elif step.kind == "reference":
            assert step.reference is not None
            stack.append((Fraction(str(lookup(step.reference))), False))
        elif step.kind == "unit":
            stack.append((_in_unit(stack.pop(), step, unit), True))
        else:
            stack.append(_computed(step, taken))
    value = stack[-1][0]
    if isinstance(value, Fraction) and value.denominator == 1:
        return value.numerator
    return _as_double(value, "the result") + 0.0  # −0.0 and 0.0 are one value


def _as_double(value: Exact, text: str) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ExpressionError(f"{text} is too large for a number")
    return number


def _checked(value: Any, text: str) -> Exact:
    """A result that is a finite double, with no more digits than can be carried on."""
    double = _as_double(value, text)
    if not isinstance(value, int | Fraction):
        return double
    value = Fraction(value)
    bits = max(value.numerator.bit_length(), value.denominator.bit_length())
    return value if bits <= _MOST_BITS else double


def _short(value: Exact) -> str:
    return f"{float(value):g}"


def _in_unit(number: _Number, step: Step, wanted: str) -> Exact:
    if number[1]:
        raise ExpressionError(f"a number has two units, the second {step.name}")
    target = "rad" if step.angle else wanted
    value = converted(number[0], step.name, target)
    if value is None:
        units = ", ".join(fitting(target))
        what = f"this is in {target}: write {units}" if target else "this has no unit"
        raise ExpressionError(f"{step.name} is a unit of {kind_of(step.name)}, but {what}")
    return _checked(value, f"{_short(number[0])} {step.name}")


def _computed(step: Step, taken: list[_Number]) -> _Number:
    values = [number for number, _ in taken]
    with_units = [has for _, has in taken]
    if step.kind == "sign":
        return -values[0], with_units[0]
    if step.kind == "function":
        function, _, units = FUNCTIONS[step.name]
        if units == "none" and any(with_units):
            raise ExpressionError(f"{step.name} needs pure numbers, without a unit")
        text = f"{step.name}({', '.join(map(_short, values))})"
        return _attempt(text, function, values), units == "keeps" and any(with_units)
    operation, has_unit = _OPERATIONS[step.name]
    text = f"{_short(values[0])} {step.name} {_short(values[1])}"
    has = has_unit(*with_units)
    if step.name == "^" or any(isinstance(value, float) for value in values):
        values = [_as_double(value, text) for value in values]
    return _attempt(text, operation, values), has


def _attempt(text: str, function: Callable[..., Any], values: list[Exact]) -> Exact:
    try:
        return _checked(function(*values), text)
    except ZeroDivisionError:
        raise ExpressionError(f"{text} divides by zero") from None
    except OverflowError:
        raise ExpressionError(f"{text} is too large for a number") from None
    except ValueError:
        raise ExpressionError(f"{text} is not a real number") from None


def _either(left: bool, right: bool) -> bool:
    return left or right


def _of_product(left: bool, right: bool) -> bool:
    if left and right:
        raise ExpressionError(
            "two numbers with units are multiplied: remove the unit from one of them"
        )
    return left or right


def _of_quotient(left: bool, right: bool) -> bool:
    if right and not left:
        raise ExpressionError(
            "a number is divided by a number with a unit: for 1/60 deg write (1/60) deg"
        )
    return left and not right


def _of_power(left: bool, right: bool) -> bool:
    if left or right:
        raise ExpressionError(
            "^ needs pure numbers: write the unit after the parentheses, as in (2^3) mm"
        )
    return False


_Operation = tuple[Callable[[Any, Any], Any], Callable[[bool, bool], bool]]
_OPERATIONS: Mapping[str, _Operation] = MappingProxyType(
    {
        "+": (operator.add, _either),
        "-": (operator.sub, _either),
        "*": (operator.mul, _of_product),
        "/": (operator.truediv, _of_quotient),
        "^": (math.pow, _of_power),
    }
)
