"""The values a parameter is to take: a range, or a list, as on the command line."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from app.run.option_values import Assignment, assignment
from app.run.overrides import behind, first_taken, from_here, named_parameter
from app.run.readout_tables import with_unit
from core.errors import ParameterError, UsageError
from core.modules.declaration import Library
from core.modules.parameters import Parameter, plain
from core.network.network import Network
from core.records import dataclass, field

OPTION = "--vary"
FORM = "NODE.PARAM=FROM:TO:COUNT, FROM:TO:COUNT:log, or a list a,b,c"
_DRAWN = "NODE.PARAM=FROM:TO, FROM:TO:log, or a list a,b,c"
MOST = 1000
_MOST_VARIED = 2
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", re.ASCII)
_COUNT = re.compile(r"[0-9]{1,9}", re.ASCII)


@dataclass(frozen=True)
class Variation:
    """A parameter and the values it takes; `log` if they are equal factors apart.

    `given` is its name as it was given, which may be that of a macro's parameter. Of a `span`,
    values are drawn later. `names` has how values that are files are shown.
    """

    node: str
    parameter: Parameter
    values: tuple[Any, ...] = ()
    log: bool = False
    given: str = ""
    span: tuple[float, float] | None = None
    names: Mapping[Any, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        return self.given or f"{self.node}.{self.parameter.name}"

    @property
    def unit(self) -> str:
        return self.parameter.param.unit

    @property
    def title(self) -> str:
        return with_unit(self.text, self.unit)

    @property
    def is_files(self) -> bool:
        return bool(self.names)

    @property
    def is_numeric(self) -> bool:
        return not self.is_files and all(is_number(value) for value in self.values)

    def shown(self, value: Any) -> Any:
        return self.names.get(value, value)

    def drawn(self, shares: Sequence[float]) -> list[Any]:
        """The values at shares of the range, from 0 to below 1."""
        if self.span is None:
            return [self.values[int(share * len(self.values))] for share in shares]
        low, high = self.span
        if self.parameter.kind == "integer":
            first, count = int(low), int(high) - int(low) + 1
            return [first + int(share * count) for share in shares]
        if self.log:
            return [float(low * (high / low) ** share) for share in shares]
        return [float(low + (high - low) * share) for share in shares]


def is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def spaced(
    low: float, high: float, count: int, *, log: bool = False, whole: bool = False
) -> tuple[float | int, ...]:
    """So many values from one to the other: equal steps, or factors; each whole one once."""
    make = np.geomspace if log else np.linspace
    values = [float(f"{value:.12g}") for value in make(low, high, count)]
    values[0], values[-1] = low, high
    if whole:
        return tuple(dict.fromkeys(round(value) for value in values))
    return tuple(values)


def variation(
    text: str, network: Network, *, library: Library, most: int = MOST, drawn: bool = False
) -> Variation:
    """The values of ``--vary``, whose range is not checked here; or a range to be `drawn` from."""
    setting = behind(assignment(OPTION, text, _DRAWN if drawn else FORM), network)
    parameter = one_value(OPTION, setting, network, library)
    if parameter.kind in ("number", "integer") and ":" in setting.text:
        return _range(setting, parameter, most, drawn=drawn)
    parts = setting.text.split(",")
    if len(parts) > most:
        raise UsageError(
            f"{OPTION} {setting.port}: {len(parts)} values; at most {most} are allowed"
        )
    values = tuple(dict.fromkeys(_value(part.strip(), parameter, setting) for part in parts))
    return Variation(setting.node, parameter, values)


def variations(
    texts: Sequence[str], network: Network, library: Library
) -> tuple[Variation, Variation | None]:
    if not 1 <= len(texts) <= _MOST_VARIED:
        raise UsageError(
            f"{OPTION} is given {len(texts)} times: give it once, or twice for a family of curves"
        )
    variations = [variation(text, network, library=library) for text in texts]
    if len(variations) == 1:
        return variations[0], None
    first, second = variations
    if first.text == second.text:
        raise UsageError(f"{OPTION} {second.text} is given twice: vary another parameter")
    if len(first.values) * len(second.values) > MOST:
        raise UsageError(
            f"{OPTION} {second.text}: {len(first.values)} × {len(second.values)} values; at most "
            f"{MOST} are allowed"
        )
    return first, second


def one_value(option: str, setting: Assignment, network: Network, library: Library) -> Parameter:
    parameter = named_parameter(option, setting, network, library=library)
    if parameter is None or parameter.kind == "numbers":
        raise UsageError(f"{option} {setting.port}: a list of numbers cannot be varied")
    return parameter


def _range(setting: Assignment, parameter: Parameter, most: int, *, drawn: bool) -> Variation:
    said = f"{OPTION} {setting.port}={setting.text:.80}"
    parts = setting.text.split(":")
    if log := parts[-1] == "log":
        del parts[-1]
    if len(parts) != (2 if drawn else 3) or not all(map(_NUMBER.fullmatch, parts[:2])):
        how = f"for random points, write {_DRAWN}" if drawn else f"write {FORM}"
        raise UsageError(f"{said}: {how}")
    low, high = float(parts[0]), float(parts[1])
    whole = parameter.kind == "integer"
    if not np.isfinite([low, high]).all() or low == high or (drawn and low > high):
        raise UsageError(
            f"{said}: FROM and TO must be different numbers{', with FROM below TO' * drawn}"
        )
    if log and (low <= 0 or high <= 0):
        raise UsageError(f"{said}: log needs FROM and TO above 0")
    if drawn:
        if whole and not (low.is_integer() and high.is_integer()):
            raise UsageError(f"{said}: FROM and TO must be whole numbers")
        span = (int(low), int(high)) if whole else (low, high)
        return Variation(setting.node, parameter, (), log, span=span)
    if not _COUNT.fullmatch(parts[2]) or not 2 <= int(parts[2]) <= most:
        raise UsageError(
            f"{OPTION} {setting.port}: COUNT = {parts[2]:.20} is not allowed: give 2 to {most}"
        )
    values = spaced(low, high, int(parts[2]), log=log, whole=whole)
    return Variation(setting.node, parameter, values, log)


def _value(text: str, parameter: Parameter, setting: Assignment) -> Any:
    def taken(reading: Any) -> Any:
        try:
            coerced = parameter.coerce(reading)
        except ParameterError:
            if parameter.kind in ("number", "integer") and _finite(reading):
                return reading
            raise
        return reading if is_number(reading) and coerced is None else plain(coerced)

    try:
        return from_here(first_taken(text, taken), parameter)
    except ParameterError as error:
        raise error.at(setting.node) from error


def taken_value(parameter: Parameter, value: Any) -> Any:
    """A value as a network file has it, once the parameter takes it, and not as none."""
    coerced = parameter.coerce(value)
    if coerced is None and value is not None:
        why = "this value leaves the parameter empty, as null does"
        raise ParameterError(parameter.name, value, why)
    return plain(coerced)


def _finite(value: object) -> bool:
    return is_number(value) and bool(np.isfinite(float(value)))  # type: ignore[arg-type]
