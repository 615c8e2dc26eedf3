"""The values a parameter is to take as a person types them: a range, or a list."""

from __future__ import annotations

from typing import Any

from app.editor.typed_number import typed_number
from app.tradeoff.values import MOST, is_number, spaced
from core.errors import ParameterError, UsageError
from core.modules.parameters import Parameter, plain

FORM = "FROM:TO:COUNT, or :log after it, or a list a, b, c"
_EQUAL_STEPS, _EQUAL_FACTORS = 3, 4


def typed_values(text: str, parameter: Parameter) -> tuple[tuple[Any, ...], bool]:
    """The values, and whether they are equal factors apart.

    Each number is typed as in the parameter's field, in any unit. Between the numbers of a list
    are commas; with semicolons, commas are decimal points.

    Raises
    ------
    UsageError, ParameterError
        If it is neither range nor list, or a value is not allowed.
    """
    if not text.strip():
        raise UsageError(f"no values: {FORM}")
    if ":" in text:
        values, log = _range(text, parameter)
    else:
        parts = text.split(";" if ";" in text else ",")
        values, log = [_number(part, parameter) for part in parts], False
    allowed = dict.fromkeys(_allowed(value, parameter) for value in values)
    if len(allowed) > MOST:
        raise UsageError(f"{len(allowed)} values, at most {MOST} are allowed")
    return tuple(allowed), log


def _range(text: str, parameter: Parameter) -> tuple[list[Any], bool]:
    parts = [part.strip() for part in text.split(":")]
    log = len(parts) == _EQUAL_FACTORS and parts[-1] == "log"
    if len(parts) != _EQUAL_STEPS and not log:
        raise UsageError(f"{text.strip()!r:.60} is no range: {FORM}")
    low, high = (_number(part, parameter) for part in parts[:2])
    count = parts[2]
    if not (count.isascii() and count.isdigit() and len(count) < 10 and 2 <= int(count) <= MOST):
        raise UsageError(f"COUNT = {count or 'nothing'!s:.20} is not allowed: from 2 to {MOST}")
    if low == high:
        raise UsageError(f"FROM and TO are both {low:g}: two different numbers make a range")
    if log and (low <= 0 or high <= 0):
        raise UsageError("log needs FROM and TO above 0")
    whole = parameter.kind == "integer"
    return list(spaced(low, high, int(count), log=log, whole=whole)), log


def _number(text: str, parameter: Parameter) -> Any:
    number = typed_number(text, parameter)
    if number is None:
        raise UsageError(f"a number is missing: {FORM}")
    if not is_number(number):
        raise UsageError(f"{text.strip()!r:.40} is no number: {FORM}")
    return number


def _allowed(value: Any, parameter: Parameter) -> Any:
    coerced = parameter.coerce(value)
    if coerced is None:
        allowed = "it stands for an empty parameter"
        raise ParameterError(parameter.name, value, allowed, unit=parameter.param.unit)
    return plain(coerced)
