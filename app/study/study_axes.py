"""What a study varies: parameters over values or ranges, and files that match a pattern."""

from __future__ import annotations

import glob
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from app.options.option_values import Assignment, assignment
from app.options.overrides import behind, from_here, named_parameter
from app.tradeoff.values import FORM, OPTION, Variation, is_number, variation
from core.errors import FileError, ParameterError, UsageError
from core.modules.library_type import Library
from core.modules.parameters import Parameter, plain
from core.names import shown
from core.network.network import Network

OVER = "--over"
MOST_VALUES = 1_000_000
_OVER_FORM = "NODE.PARAM=PATTERN, such as scene.path='scenes/*.img'"
_SPAN = "NODE.PARAM=FROM:TO, or :log after it, or a list a,b,c"


@dataclass(frozen=True)
class Axis:
    """A parameter that a study varies.

    Parameters
    ----------
    label : str
        ``NODE.PARAM`` as it was given, which may be a macro's.
    node : str
        The node behind it.
    parameter : Parameter
        Its declaration.
    values : tuple
        The values it takes, as a network file has them; those of a span are drawn later.
    span : (low, high), optional
        Where values are drawn from.
    log : bool
        Whether equal factors count as equal steps.
    names : mapping
        How the rows show values that are files, by value.
    """

    label: str
    node: str
    parameter: Parameter
    values: tuple[Any, ...] = ()
    span: tuple[float, float] | None = None
    log: bool = False
    names: Mapping[Any, str] = field(default_factory=dict)

    @property
    def unit(self) -> str:
        """Unit of the values, empty for a pure number or a name."""
        return self.parameter.param.unit

    @property
    def is_files(self) -> bool:
        """Whether the values are files."""
        return bool(self.names)

    @property
    def is_numeric(self) -> bool:
        """Whether all values lie on one line."""
        return not self.is_files and all(is_number(value) for value in self.values)

    def shown(self, value: Any) -> Any:
        """A value as the rows show it."""
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


def grid_axis(text: str, network: Network, *, library: Library) -> Axis:
    """The axis of ``--vary NODE.PARAM=FROM:TO:COUNT`` or of a list; every value is allowed.

    Raises
    ------
    UsageError, ParameterError
        If it does not fit the network, or a value is not allowed.
    """
    varied = variation(text, network, library=library, most=MOST_VALUES)
    return _axis(assignment(OPTION, text, FORM).port, varied)


def span_axis(text: str, network: Network, *, library: Library) -> Axis:
    """The axis of ``--vary NODE.PARAM=FROM:TO``, from which values are drawn.

    Raises
    ------
    UsageError, ParameterError
        As of `grid_axis`.
    """
    setting = assignment(OPTION, text, _SPAN)
    inner = behind(setting, network)
    parameter = named_parameter(OPTION, inner, network, library=library)
    parts = setting.text.split(":")
    if parameter is None or parameter.kind not in ("number", "integer") or len(parts) == 1:
        return grid_axis(text, network, library=library)
    log = len(parts) == 3 and parts[2] == "log"
    try:
        low, high = float(parts[0]), float(parts[1])
    except ValueError:
        low = high = np.nan
    if (len(parts) > 2 and not log) or not low < high:
        raise UsageError(
            f"{OPTION} {setting.port}={setting.text:.80}: for values that are drawn write {_SPAN}, "
            "FROM below TO"
        )
    if log and low <= 0:
        raise UsageError(f"{OPTION} {setting.port}={setting.text:.80}: log needs FROM above 0")
    whole = parameter.kind == "integer"
    if whole and (int(low) != low or int(high) != high):
        raise UsageError(
            f"{OPTION} {setting.port}={setting.text:.80}: FROM and TO must be whole numbers"
        )
    ends: tuple[Any, Any] = (int(low), int(high)) if whole else (low, high)
    for end in ends:
        allowed(parameter, end, inner.node)
    return Axis(setting.port, inner.node, parameter, (), ends, log)


def values_axis(
    label: str, values: Sequence[Any], network: Network, *, library: Library, option: str = OPTION
) -> Axis:
    """The axis of a parameter over values that are known one by one.

    Raises
    ------
    UsageError, ParameterError
        As of `grid_axis`.
    """
    node, parameter = target(option, label, network, library=library)
    items = (value.item() if isinstance(value, np.generic) else value for value in values)
    taken = tuple(dict.fromkeys(_plain_value(parameter, item, node) for item in items))
    if not taken:
        raise UsageError(f"{option} {label}: there are no values")
    return of_files(Axis(label, node, parameter, taken))


def target(option: str, label: str, network: Network, *, library: Library) -> tuple[str, Parameter]:
    """The node and parameter that ``NODE.PARAM`` stands for.

    Raises
    ------
    UsageError
        If there is none, or it is a list of numbers.
    """
    inner = behind(assignment(option, f"{label}=", "NODE.PARAM"), network)
    return inner.node, _named(option, inner, network, library)


def files_axis(text: str, network: Network, *, library: Library) -> Axis:
    """The axis of ``--over NODE.PARAM=PATTERN``: the files that match, 2 before 10.

    The pattern is of the current folder, as that of a shell.

    Raises
    ------
    UsageError, FileError
        If it does not fit the network, or no file matches.
    """
    setting = assignment(OVER, text, _OVER_FORM)
    inner = behind(setting, network)
    parameter = _named(OVER, inner, network, library)
    if parameter.kind != "path":
        raise UsageError(f"{OVER} {setting.port}: {parameter.allowed()}, no file name")
    matching = glob.glob(setting.text, recursive=True)  # noqa: PTH207, as Path's needs a folder
    names = [name for name in matching if Path(name).is_file()]
    if not names:
        raise FileError(f"{OVER} {setting.port}={shown(setting.text)}: no file matches")
    names.sort(key=natural)
    by_value = {Path(name).absolute().as_posix(): Path(name).as_posix() for name in names}
    return Axis(setting.port, inner.node, parameter, tuple(by_value), names=by_value)


def natural(name: str) -> tuple[tuple[int, int, str], ...]:
    """A key that sorts names as people do: 2 before 10."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return tuple((0, int(p), p) if "0" <= p[0] <= "9" else (1, 0, p) for p in parts)


def allowed(parameter: Parameter, value: Any, node: str) -> None:
    """Refuse a value that the parameter cannot take.

    Raises
    ------
    ParameterError
        At the node.
    """
    try:
        coerced = parameter.coerce(value)
    except ParameterError as error:
        raise error.at(node) from error
    if coerced is None and value is not None:
        why = "it stands for an empty parameter, as null does"
        raise ParameterError(parameter.name, value, why, node=node)


def _axis(label: str, varied: Variation) -> Axis:
    for value in varied.values:
        allowed(varied.parameter, value, varied.node)
    return of_files(Axis(label, varied.node, varied.parameter, varied.values, log=varied.log))


def of_files(axis: Axis) -> Axis:
    """The axis with its values' names as they were typed, where they are files."""
    if axis.parameter.kind != "path":
        return axis
    here = Path().absolute()
    files = [Path(value) for value in axis.values if value]
    names = {
        file.as_posix(): (file.relative_to(here) if file.is_relative_to(here) else file).as_posix()
        for file in files
    }
    return replace(axis, names=names)


def _named(option: str, setting: Assignment, network: Network, library: Library) -> Parameter:
    parameter = named_parameter(option, setting, network, library=library)
    if parameter is None or parameter.kind == "numbers":
        raise UsageError(f"{option} {setting.port}: a list of numbers cannot be varied")
    return parameter


def _plain_value(parameter: Parameter, value: Any, node: str) -> Any:
    allowed(parameter, value, node)
    return from_here(plain(parameter.coerce(value)), parameter)
