"""Parameters of modules: what is allowed, and turning what a file or a user gives into it."""

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar

from core.errors import ParameterError

Kind = Literal["number", "integer", "switch", "choice", "text", "path", "numbers"]
LARGEST_INTEGER = 2**63 - 1
LARGEST_NUMBER = sys.float_info.max
Number = TypeVar("Number", int, float)
_WITH_UNIT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)? *[^\W\d_]{1,40}")


@dataclass(frozen=True)
class Param:
    """A module author's description of a parameter."""

    text: str  # what it means, for panel and reference
    unit: str = ""  # where it is not the one that the parameter's name ends in
    low: float | None = None
    high: float | None = None
    above: bool = False  # `low` itself is not allowed
    below: bool = False  # `high` itself is not allowed
    slider: tuple[float, float] | None = None  # the part of the range a slider should cover
    zero_is_empty: bool = True  # for a number that may be empty: whether 0 means empty
    choices: tuple[Any, ...] = ()  # where a `Literal` would list derived ones again


@dataclass(frozen=True)
class Parameter:
    """A parameter as derived from the module's class; `...` stands for no default."""

    name: str
    kind: Kind
    default: Any
    choices: tuple[Any, ...]
    empty: bool
    param: Param

    @property
    def required(self) -> bool:
        """Whether there is no default."""
        return self.default is ...

    def allowed(self) -> str:
        """The allowed values in words."""
        if self.kind == "choice":
            return "one of " + ", ".join(str(choice) for choice in self.choices)
        words = {
            "number": "a number",
            "integer": "a whole number",
            "switch": "true or false",
            "text": "a text",
            "path": "a file name",
            "numbers": "a list of numbers",
        }[self.kind]
        low, high = self.param.low, self.param.high
        if low is not None and high is not None:
            signs = ("above" if self.param.above else "from", "below" if self.param.below else "to")
            words += f" {signs[0]} {low:g} {signs[1]} {high:g}"
        elif low is not None:
            words += f" above {low:g}" if self.param.above else f" of at least {low:g}"
        elif high is not None:
            words += f" below {high:g}" if self.param.below else f" of at most {high:g}"
        return words + (" or empty" if self.empty else "")

    def coerce(self, value: object) -> Any:
        """The value in its declared kind, so that 1 and 1.0 are the same network."""
        if self.empty and (value is None or value == ""):
            return None
        convert = getattr(self, f"_as_{self.kind}")
        return convert(value)

    def _refuse(self, value: object) -> ParameterError:
        unit = self.param.unit
        is_number = self.kind in ("number", "integer")
        if unit and is_number and isinstance(value, str) and _WITH_UNIT.fullmatch(value):
            allowed = (
                f"{self.allowed()} in {unit}; to convert from another unit, begin with '=': "
                f"'={value}'"
            )
            return ParameterError(self.name, value, allowed, unit="")
        return ParameterError(self.name, value, self.allowed(), unit=unit)

    def _in_range(self, number: float) -> bool:
        low, high = self.param.low, self.param.high
        if low is not None and (number <= low if self.param.above else number < low):
            return False
        return high is None or (number < high if self.param.below else number <= high)

    def _checked(self, value: object, largest: float) -> int | float:
        """A number that is neither too large nor NaN."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._refuse(value)
        if not abs(value) <= largest:
            raise self._refuse(value)
        return value

    def _ranged(self, number: Number, value: object) -> Number | None:
        """The number, if it is in the range; None where 0 is empty."""
        if self.empty and number == 0 and self.param.zero_is_empty:
            return None
        if not self._in_range(number):
            raise self._refuse(value)
        return number

    def _as_number(self, value: object) -> float | None:
        # −0.0 and 0.0 are one value
        return self._ranged(float(self._checked(value, LARGEST_NUMBER)) + 0.0, value)

    def _as_integer(self, value: object) -> int | None:
        number = self._checked(value, LARGEST_INTEGER)
        if number != int(number):
            raise self._refuse(value)
        return self._ranged(int(number), value)

    def _as_switch(self, value: object) -> bool:
        if not isinstance(value, bool):
            raise self._refuse(value)
        return value

    def _as_choice(self, value: object) -> Any:
        for choice in self.choices:
            if value == choice and isinstance(value, bool) == isinstance(choice, bool):
                return choice
        raise self._refuse(value)

    def _as_text(self, value: object) -> str:
        if not isinstance(value, str) or "\0" in value:
            raise self._refuse(value)
        return value

    def _as_path(self, value: object) -> Path:
        if not isinstance(value, str | Path) or "\0" in str(value) or str(value) == "":
            raise self._refuse(value)
        return Path(value)

    def _as_numbers(self, value: object) -> tuple[float, ...]:
        if not isinstance(value, list | tuple):
            raise self._refuse(value)
        for item in value:
            is_number = isinstance(item, int | float) and not isinstance(item, bool)
            if not (is_number and abs(item) <= LARGEST_NUMBER and self._in_range(item)):
                raise self._refuse(value)
        return tuple(float(item) + 0.0 for item in value)


def coerce_all(
    parameters: tuple[Parameter, ...], values: Mapping[str, object], title: str
) -> dict[str, Any]:
    """Coerce what is given and fill in the defaults."""
    names = [parameter.name for parameter in parameters]
    for name in values:
        if name not in names:
            known = ", ".join(names) or "none"
            raise ParameterError(name, values[name], f"{title} has the parameters {known}")
    result = {}
    for parameter in parameters:
        value = values.get(parameter.name)
        # An empty number is absent: it means the default, where it does not mean empty.
        absent = value is None and parameter.kind in ("number", "integer") and not parameter.empty
        if parameter.name in values and not (absent and not parameter.required):
            result[parameter.name] = parameter.coerce(value)
        elif parameter.required:
            raise ParameterError(parameter.name, None, parameter.allowed())
        else:
            result[parameter.name] = parameter.default
    return result


def plain(value: Any) -> Any:
    """The JSON form of a coerced value."""
    if isinstance(value, Path):
        return value.as_posix()
    if isinstance(value, tuple):
        return list(value)
    return value


# A formula of a module, for its page in the handbook.


@dataclass(frozen=True)
class Formula:
    """One line of what a module computes."""

    tex: str  # of the part that matplotlib typesets
    where: str = ""  # what its symbols mean, with units
    when: str = ""  # for which choice of parameters it holds; empty: always
