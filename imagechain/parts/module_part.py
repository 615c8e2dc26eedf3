"""Modules with their values, not yet in a chain, and expressions in place of values."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from core.errors import ParameterError, close, shown, thaw
from core.modules.declaration import Declaration
from core.modules.parameters import Parameter, plain
from core.network.linked_values import expression as raw_expression
from core.network.network import Network
from nodes.input_output.source_file import HeldSamples


@dataclass(frozen=True)
class Expression:
    """A number that follows other parameters: ``ic.expression("init.f_number * 0.05")``.

    The expression may contain numbers, ``NODE.PARAMETER``, ``+ - * / ^ ( )``, ``pi`` and functions
    such as ``sqrt`` and ``min``. A number with a unit (``3 um``) is converted to the parameter's
    own unit.
    """

    text: str


@dataclass(frozen=True)
class Part:
    """A module with values for some of its parameters, to add to a chain.

    All other parameters keep their defaults. `samples` holds a scene from an array. `name` is the
    default name of the node; if it is empty, the module's key is used. `inside` holds the modules
    of a macro.
    """

    module: str
    params: Mapping[str, Any] = field(default_factory=dict)
    samples: HeldSamples | None = field(default=None, repr=False)
    name: str = ""
    inside: Network | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "params", MappingProxyType(dict(self.params)))

    def __reduce__(self) -> tuple[Any, ...]:
        return Part, (self.module, dict(self.params), self.samples, self.name, self.inside)


def file_values(declared: Declaration, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values as in a network file, each checked against its parameter."""
    return {name: file_value(declared, name, value) for name, value in values.items()}


def file_value(declared: Declaration, name: str, value: Any, *, node: str | None = None) -> Any:
    """A value as in a network file; errors as for `file_values`, with the node's name."""
    parameter = known_parameter(declared, name, value, node=node)
    raw = simple(value)
    numeric = parameter.kind in ("number", "integer")
    if isinstance(raw, Expression):
        raw = raw_expression(raw.text)
    elif numeric and isinstance(raw, str) and raw.lstrip().startswith("="):
        raw = raw_expression(raw.lstrip()[1:].strip())
    if isinstance(raw, dict) and numeric:  # read, and evaluated, with the network
        return raw
    try:
        return plain(parameter.coerce(raw))
    except ParameterError as error:
        raise (error if node is None else error.at(node)) from None


def known_parameter(
    declared: Declaration, name: str, value: Any, *, node: str | None = None
) -> Parameter:
    """The parameter with that name."""
    parameter = declared.parameter(name)
    if parameter is None:
        names = [candidate.name for candidate in declared.parameters]
        hint = close(name, names) or f"; it has {', '.join(names) or 'none'}"
        allowed = f"{declared.title} has no such parameter{hint}"
        raise ParameterError(shown(name), value, allowed, node=node)
    return parameter


def simple(value: Any) -> Any:
    """Convert numpy numbers, arrays, tuples and paths to plain Python values."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Path):
        return value.as_posix()
    return thaw(value)


def shown_value(value: Any) -> str:
    """A parameter's value as a short text."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)
