"""Numbers as text and back, without loss."""

from __future__ import annotations

import re
from collections.abc import Sequence

from core.errors import ParameterError
from core.modules.parameters import Parameter

DIGITS = 10  # significant ones, where that many are enough
FIGURE_DIGITS = 5  # of read-outs

_EXPONENT = re.compile(r"e\+?(-?)0*(?=\d)")
_WHOLE = re.compile(r"[+-]?\d{1,400}")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")


def shown_number(value: float) -> str:
    """The shortest text of up to ten digits, or all it takes: reading it gives the same number."""
    if isinstance(value, int):
        return str(value)
    short = f"{value:.{DIGITS}g}"
    return _brief(short if float(short) == value else repr(value))


def shown_numbers(values: Sequence[float]) -> str:
    """A list of numbers as text."""
    return ", ".join(shown_number(value) for value in values)


def shown_figure(value: object) -> str:
    """A read-out's value in five digits; a dash where there is none."""
    if value is None:
        return "—"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return str(value)
    # One digit more where that is all of the number before the point.
    whole = 10**FIGURE_DIGITS <= abs(number) < 10 ** (FIGURE_DIGITS + 1)
    return _brief(f"{number:.{FIGURE_DIGITS + whole}g}")


def _brief(text: str) -> str:
    """``3e13`` instead of ``3e+13``."""
    return _EXPONENT.sub(r"e\1", text)


def number_of(text: str, parameter: Parameter) -> float | int | str | None:
    """The number a person typed; None for nothing, the text itself where it is no number.

    A comma is a decimal point. One that might set thousands apart is refused.

    Raises
    ------
    ParameterError
        For a text such as ``1,000``.
    """
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    if not text:
        return None
    if _THOUSANDS.fullmatch(text):
        whole, _, rest = text.partition(",")
        clear = f"either {whole}{rest} or {whole}.{rest}"
        raise ParameterError(parameter.name, text, clear, unit=parameter.param.unit)
    if _WHOLE.fullmatch(text):
        return int(text)
    if text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")
    try:
        return float(text) if "_" not in text else text
    except ValueError:
        return text


def numbers_of(text: str, parameter: Parameter) -> list[float | int | str | None]:
    """The numbers of a list as a person typed it: between commas, or semicolons, or spaces.

    With semicolons, commas are decimal points.

    Raises
    ------
    ParameterError
        As for one number.
    """
    text = text.strip().strip("[]()").strip()
    if not text:
        return []
    if ";" in text:
        parts = text.split(";")
    elif "," in text:
        parts = text.split(",")
    else:
        parts = text.split()
    return [number_of(part, parameter) for part in parts]
