"""Numbers as text and back, without loss; as a person types them, with arithmetic and units."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from PySide6.QtCore import QObject, Signal

from core.errors import ParameterError
from core.modules.parameters import Parameter
from core.network.expression_arithmetic import value_of
from core.network.expression_grammar import ExpressionError, parse_expression
from core.network.network import Node

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

    A comma is a decimal point. One that might set thousands apart, as in ``1,000``, is refused.
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
    """The numbers of a list, between commas, spaces, or semicolons: then commas are decimal."""
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


# Which numbers of the network a fit is to determine, and within what limits.


@dataclass(frozen=True)
class FreeNumber:
    """A parameter that is free for a fit; a limit that is None is the parameter's own."""

    node: str
    name: str
    low: float | None = None
    high: float | None = None

    @property
    def place(self) -> tuple[str, str]:
        return self.node, self.name

    @property
    def port(self) -> str:
        return f"{self.node}.{self.name}"


class FreeNumbers(QObject):
    """The free parameters of the open document. No file holds them, and undo leaves them.

    Those of a node that is removed come back with it.
    """

    changed = Signal()  # others are free, or their limits differ

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._numbers: dict[tuple[str, str], FreeNumber] = {}
        self._removed: list[tuple[FreeNumber, Node]] = []

    @property
    def all(self) -> tuple[FreeNumber, ...]:
        return tuple(self._numbers.values())

    def has(self, node: str, name: str) -> bool:
        return (node, name) in self._numbers

    def put(self, number: FreeNumber) -> None:
        if self._numbers.get(number.place) != number:
            self._numbers[number.place] = number
            self.changed.emit()

    def fix(self, node: str, name: str) -> None:
        if self._numbers.pop((node, name), None) is not None:
            self.changed.emit()

    def clear(self) -> None:
        self._removed.clear()
        if self._numbers:
            self._numbers.clear()
            self.changed.emit()

    def follow(
        self,
        name_now: Callable[[str], str],
        before: Mapping[str, Node],
        after: Mapping[str, Node],
    ) -> None:
        """Take the names that nodes have now; what is of no node any more is free no more."""
        numbers = {}
        for one in self._numbers.values():
            now = replace(one, node=name_now(one.node))
            if now.node in after:
                numbers[now.place] = now
            elif one.node in before:
                self._removed.append((one, before[one.node]))
        back = [pair for pair in self._removed if after.get(pair[0].node) == pair[1]]
        for pair in back:
            self._removed.remove(pair)
            numbers.setdefault(pair[0].place, pair[0])
        if numbers != self._numbers:
            self._numbers = numbers
            self.changed.emit()


_ANY_THOUSANDS = re.compile(r"(?<![\d.,])[1-9]\d{0,2},\d{3}(?![\d,.])")
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
_ARITHMETIC = re.compile(r"[\d(]|\w\.\w")


def typed_number(text: str, parameter: Parameter) -> float | int | str | None:
    """The number a person typed, in the parameter's unit; the text where it is none.

    ``600 urad`` typed for mrad is 0.6, ``2*0.3`` is 0.6 in any unit. A comma is a decimal point
    except between the arguments of a function. Arithmetic without a value is refused.
    """
    number = number_of(text, parameter)
    if not isinstance(number, str) or not _ARITHMETIC.search(number):
        return number
    written = text.strip()
    if "(" not in written:
        thousands = _ANY_THOUSANDS.search(written)
        if thousands:
            whole, _, rest = thousands[0].partition(",")
            clear = f"either {whole}{rest} or {whole}.{rest}"
            raise ParameterError(parameter.name, text, clear)
        written = _DECIMAL_COMMA.sub(".", written)
    try:
        return value_of(parse_expression(written), unit=parameter.param.unit)
    except ExpressionError as error:
        raise ParameterError(parameter.name, text, error.message) from None
