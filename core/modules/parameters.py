"""Parameters of modules: what is allowed, and turning what a file or a user gives into it."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from core.errors import Cancelled, ImagechainError, ParameterError, plug_in_error, shown, with_place
from core.records import dataclass, field, replace

if TYPE_CHECKING:
    from core.evaluation.recipes import Recipe
    from core.evaluation.work import Work

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


def param(default: Any, text: str, bounds: tuple[float, float] | None = None, **more: Any) -> Any:
    """A parameter of a module with its default; `bounds`: low, high; `more` as for `Param`."""
    if bounds is not None:
        more |= {"low": bounds[0], "high": bounds[1]}
    return field(default=default, metadata={"param": Param(text, **more)})


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
        return self.default is ...

    def allowed(self) -> str:
        if self.kind == "choice":
            return "one of " + ", ".join(str(choice) for choice in self.choices)
        words = {
            "number": "a number",
            "integer": "a whole number",
            "switch": "true or false",
            "text": "text",
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
                f"{self.allowed()}, in {unit}; to convert from another unit, begin with '=': "
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
    names = [parameter.name for parameter in parameters]
    for name in values:
        if name not in names:
            known = ", ".join(names) or "none"
            allowed = f"{title} has no such parameter; its parameters: {known}"
            raise ParameterError(name, values[name], allowed, clause=True)
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


# How a module's parameters are grouped on its panel: under titles, on pages, under conditions.


@dataclass(frozen=True)
class Offer:
    """Which choices of a parameter are offered, as buttons, by the value of another.

    `choices` are those for each value of the parameter `by`; all for a value that is not there. A
    value that is not among them stays allowed, and is offered as long as it is set.
    """

    parameter: str
    by: str
    choices: tuple[tuple[Any, tuple[Any, ...]], ...]

    def of(self, value: Any, otherwise: tuple[Any, ...]) -> tuple[Any, ...]:
        return next((choices for known, choices in self.choices if known == value), otherwise)


@dataclass(frozen=True)
class Section:
    """Parameters that stand together on a panel.

    Sections of one `page` are shown together, one page at a time; those without, always.
    """

    title: str  # stands above them; may be empty
    names: str | tuple[str, ...]  # of the parameters, in order; in a text between blanks
    page: str = ""
    shown_when: tuple[str, tuple[Any, ...]] | None = None  # a parameter, and values of it
    offer: Offer | None = None  # limits the choices of one of the parameters

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(self.names.split()) if isinstance(self.names, str) else self.names

    def mentioned(self) -> tuple[str, ...]:
        offer, condition = self.offer, self.shown_when
        further = () if offer is None else (offer.parameter, offer.by)
        return (*self.parameters, *further, *(() if condition is None else condition[:1]))


def complete(sections: tuple[Section, ...], parameters: Sequence[str]) -> tuple[Section, ...]:
    """The sections, and one more with the parameters that none of them has."""
    placed = Counter(name for section in sections for name in section.parameters)
    wrong = [name for section in sections for name in section.mentioned() if name not in parameters]
    wrong += [name for name, places in placed.items() if places > 1]
    if wrong:
        allowed = f"{', '.join(parameters)}, each only once"
        raise TypeError(
            "unknown or repeated parameters in the panel's sections: "
            f"{', '.join(wrong)}; allowed: {allowed}"
        )
    left = tuple(name for name in parameters if name not in placed)
    return (*sections, Section("", left)) if left else sections


# A finding that does not keep a network from running, but may make its figures wrong.
#
# A module's method that warns returns a `Caution`, or None; or the recipe of one, where samples
# have to be looked at. A check that fails itself keeps nothing from running either: that it failed
# stands in the place of its finding.


@dataclass(frozen=True)
class Caution:
    """What a module warns of; the engine fills in the node, and the method that found it."""

    message: str  # what disagrees, with the values, in one line
    remedy: str  # what to do about it, or when it is well
    node: str = ""
    check: str = ""

    @property
    def text(self) -> str:
        return f"{self.message}. {self.remedy[:1].upper()}{self.remedy[1:]}"

    def at(self, node: str, check: str) -> Caution:
        return replace(self, node=node, check=check)

    def __str__(self) -> str:
        return f"{shown(self.node)}: {self.text}"


@dataclass(frozen=True)
class PendingCheck:
    """A warning of a node that takes samples: the recipe of a `Caution`, or of None."""

    node: str
    check: str
    recipe: Recipe

    def is_ready(self, work: Work) -> bool:
        return all(map(work.has, self.recipe.needs))

    def value(self, work: Work) -> Caution | None:
        result = checked(partial(work.value, self.recipe), node=self.node, check=self.check)
        return result if isinstance(result, Caution) else None


def checked(
    method: Callable[[], Caution | Recipe | None], *, node: str, check: str
) -> Caution | PendingCheck | None:
    """What a method warns of, placed on its node; a failure of its own is a `Caution` too."""
    from core.evaluation.recipes import Recipe  # numpy: who only reads declarations has no use

    try:
        result = method()
    except Cancelled:
        raise
    except ImagechainError as error:
        result = Caution(
            f"the check {check!r} could not run: {error.message}", "correct this error first"
        )
    except Exception as error:  # a fault of the method alone: network and other checks are sound
        fault = plug_in_error(error, node)
        what = fault.message if fault else with_place(error)
        whose = "the module's package" if fault else "Imagechain"
        result = Caution(
            f"the check {check!r} failed ({what}), so its warning may be missing",
            f"the error is in {whose}, not in the network: report it to the authors",
        )
    if isinstance(result, Recipe):
        return PendingCheck(node, check, result)
    return None if result is None else result.at(node, check)
