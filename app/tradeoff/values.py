"""The values a parameter is to take: a range, or a list, as on the command line."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.run.option_values import Assignment, assignment
from app.run.overrides import behind, from_here, named_parameter, readings
from app.run.readout_tables import with_unit
from core.errors import ParameterError, UsageError
from core.modules.declaration import Library
from core.modules.parameters import Parameter, plain
from core.network.network import Network

OPTION = "--vary"
FORM = "NODE.PARAM=FROM:TO:COUNT, FROM:TO:COUNT:log, or a list a,b,c"
MOST = 1000
_MOST_VARIED = 2
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", re.ASCII)
_COUNT = re.compile(r"[0-9]{1,9}", re.ASCII)
_RANGE_PARTS = (3, 4)


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


def variation(text: str, network: Network, *, library: Library, most: int = MOST) -> Variation:
    """The parameter and values of ``--vary``, of which there may be at most so many.

    Numbers out of the parameter's range are left for the evaluation to refuse, one by one.
    """
    setting = behind(assignment(OPTION, text, FORM), network)
    parameter = one_value(OPTION, setting, network, library)
    numeric = parameter.kind in ("number", "integer")
    if numeric and ":" in setting.text:
        return _range(setting, parameter, most)
    parts = setting.text.split(",")
    if len(parts) > most:
        raise UsageError(
            f"{OPTION} {setting.port}: {len(parts)} values, at most {most} are allowed"
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
            f"{OPTION} {second.text}: {len(first.values)} × {len(second.values)} values, "
            f"at most {MOST} are allowed"
        )
    return first, second


def one_value(option: str, setting: Assignment, network: Network, library: Library) -> Parameter:
    """The parameter that is named, which takes one value and no list of numbers."""
    parameter = named_parameter(option, setting, network, library=library)
    if parameter is None or parameter.kind == "numbers":
        raise UsageError(f"{option} {setting.port}: a list of numbers cannot be varied")
    return parameter


def _range(setting: Assignment, parameter: Parameter, most: int) -> Variation:
    parts = setting.text.split(":")
    log = len(parts) == 4 and parts[3] == "log"
    fits = len(parts) in _RANGE_PARTS and (len(parts) == 3 or log)
    if not fits or not all(_NUMBER.fullmatch(part) for part in parts[:2]):
        raise UsageError(f"{OPTION} {setting.port}={setting.text:.80}: write {FORM}")
    low, high = float(parts[0]), float(parts[1])
    if not (np.isfinite([low, high]).all() and low != high):
        raise UsageError(
            f"{OPTION} {setting.port}={setting.text:.80}: FROM and TO must be two numbers"
        )
    if not _COUNT.fullmatch(parts[2]) or not 2 <= int(parts[2]) <= most:
        raise UsageError(
            f"{OPTION} {setting.port}: COUNT = {parts[2]:.20} is not allowed: from 2 to {most}"
        )
    if log and (low <= 0 or high <= 0):
        raise UsageError(
            f"{OPTION} {setting.port}={setting.text:.80}: log needs FROM and TO above 0"
        )
    whole = parameter.kind == "integer"
    values = spaced(low, high, int(parts[2]), log=log, whole=whole)
    return Variation(setting.node, parameter, values, log)


def _value(text: str, parameter: Parameter, setting: Assignment) -> Any:
    first: ParameterError | None = None
    for reading in readings(text):
        try:
            coerced = parameter.coerce(reading)
        except ParameterError as error:
            if parameter.kind in ("number", "integer") and _finite(reading):
                return reading
            first = first or error.at(setting.node)
        else:
            value = reading if is_number(reading) and coerced is None else plain(coerced)
            return from_here(value, parameter)
    assert first is not None
    raise first


def taken_value(parameter: Parameter, value: Any) -> Any:
    """A value as a network file has it, once the parameter takes it, and not as none."""
    coerced = parameter.coerce(value)
    if coerced is None and value is not None:
        why = "this value means an empty parameter, like null"
        raise ParameterError(parameter.name, value, why)
    return plain(coerced)


def _finite(value: object) -> bool:
    return is_number(value) and bool(np.isfinite(float(value)))  # type: ignore[arg-type]
