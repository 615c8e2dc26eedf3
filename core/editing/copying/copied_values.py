"""A node's parameter values as text that can be read, and pasted on other nodes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from core.editing.fields import set_parameter
from core.editing.operation import ABSENT, Operation, Together, named
from core.errors import ImagechainError, NetworkError
from core.modules.declaration import Declaration
from core.modules.parameters import Parameter, plain
from core.names import shown, thaw
from core.network.json_reading import read_json
from core.network.linked_values import LinkError
from core.network.network import EXPRESSION, Network, Node

VALUES_FORMAT = "imagechain-values"
SOURCE = "the clipboard"
_MOST_NAMED = 4

Place = tuple[str, str]  # node and parameter
DeclarationOf = Callable[[str], Declaration | None]
FaultsAfter = Callable[[Operation, Iterable[Place]], Mapping[Place, LinkError]]


@dataclass(frozen=True)
class CopiedValues:
    """Values by parameter as a network file has them, and the units of those that have one."""

    values: Mapping[str, Any]
    units: Mapping[str, str]


@dataclass(frozen=True)
class PastedValues:
    """What pasting does.

    Parameters
    ----------
    operation : Operation
        The values' one step; it may change nothing.
    taken : tuple of str
        The parameters that it gives a value, as ``NODE.PARAMETER``.
    left_out : tuple of str
        The others, each with the reason.
    """

    operation: Operation
    taken: tuple[str, ...]
    left_out: tuple[str, ...]


def copied_values(node: Node, declared: Declaration | None) -> str:
    """Every value of a node's panel as JSON text, those left at their defaults too.

    Parameters
    ----------
    node : Node
        The node; expressions are copied as such.
    declared : Declaration or None
        Its module's; of an unknown module only what is set can be copied.
    """
    values: dict[str, Any] = {}
    units: dict[str, str] = {}
    for parameter in declared.parameters if declared is not None else ():
        if parameter.name in node.params:
            values[parameter.name] = thaw(node.params[parameter.name])
        elif not parameter.required:
            values[parameter.name] = plain(parameter.default)
        else:
            continue
        if parameter.param.unit:
            units[parameter.name] = parameter.param.unit
    if declared is None:
        values = thaw(node.params)
    fields: dict[str, Any] = {"format": VALUES_FORMAT, "version": 1, "module": node.module}
    fields |= {"node": node.id, "values": values}
    if units:
        fields["units"] = units
    return json.dumps(fields, ensure_ascii=False, indent=2)


def read_values(text: str) -> CopiedValues:
    """What `copied_values` gave.

    Raises
    ------
    NetworkError
        If the text holds no values, in one line.
    """
    none = NetworkError(f"{SOURCE} holds no values of a node")
    if not text.lstrip().startswith("{"):
        raise none  # most often it is just something else: no word of JSON
    document = read_json(text, SOURCE)
    if document.get("format") != VALUES_FORMAT:
        raise none
    values, units = document.get("values"), document.get("units", {})
    if not isinstance(values, dict) or not values:
        raise none
    if not isinstance(units, dict) or not all(isinstance(unit, str) for unit in units.values()):
        raise NetworkError(f"{SOURCE}: the units of values must be texts by parameter")
    return CopiedValues(values, units)


def pasted_values(
    text: str,
    names: Iterable[str],
    network: Network,
    *,
    declaration_of: DeclarationOf,
    faults_after: FaultsAfter,
) -> PastedValues:
    """What gives nodes the copied values of the parameters that they have.

    A value that is the parameter's default leaves it at its default. What a module has not, does
    not take, or has in another unit is left out.

    Parameters
    ----------
    text : str
        What `copied_values` gave.
    names : iterable of str
        The nodes.
    network : Network
        Where they are.
    declaration_of : callable
        The declaration of a node's module, None of an unknown one.
    faults_after : callable
        Of an operation and parameters the faults of those whose expressions have no value after it.

    Raises
    ------
    NetworkError
        If the text holds no values, or nothing of it fits any of the nodes.
    """
    copied, names = read_values(text), tuple(names)
    steps: dict[Place, Any] = {}
    left_out: list[str] = []
    for name in names:
        declared = declaration_of(name)
        if declared is None:
            left_out.append(f"{shown(name)} is of an unknown module")
            continue
        missing = [key for key in copied.values if declared.parameter(key) is None]
        if missing:
            left_out.append(f"{declared.title} has no {_listed(missing)}")
        for parameter in declared.parameters:
            if parameter.name in copied.values:
                try:
                    steps[name, parameter.name] = _fitting(parameter, copied)
                except ImagechainError as error:
                    left_out.append(error.message)
    for place, fault in _link_faults(steps, faults_after).items():
        del steps[place]
        left_out.append(fault.message)
    left_out = list(dict.fromkeys(left_out))
    if not steps:
        raise NetworkError(f"no value fits {named(names)}: {'; '.join(left_out[:3])}")
    changes = [
        set_parameter(name, key, value)
        for (name, key), value in steps.items()
        if value is not ABSENT or key in network.node(name).params
    ]
    number = len(copied.values)
    what = f"Paste {number} values" if number > 1 else f"Paste {next(iter(copied.values))}"
    taken = tuple(f"{name}.{key}" for name, key in steps)
    return PastedValues(Together(changes, f"{what} on {named(names)}"), taken, tuple(left_out))


def _fitting(parameter: Parameter, copied: CopiedValues) -> Any:
    """The value as a network file has it; ABSENT for the default.

    Raises
    ------
    NetworkError, ParameterError
        If the parameter is in another unit, or does not take the value.
    """
    raw, unit = copied.values[parameter.name], copied.units.get(parameter.name)
    there = parameter.param.unit
    if unit is not None and unit != there:
        raise NetworkError(f"{parameter.name} is in {there or 'no unit'} there, not in {unit}")
    if isinstance(raw, dict) and EXPRESSION in raw:
        return raw
    value = parameter.coerce(raw)
    is_default = not parameter.required and value == parameter.default
    return ABSENT if is_default else plain(value)


def _link_faults(steps: Mapping[Place, Any], faults_after: FaultsAfter) -> dict[Place, LinkError]:
    """The faults of expressions among the steps; without those, others may have no value either."""
    faults: dict[Place, LinkError] = {}
    while True:
        rest = {place: value for place, value in steps.items() if place not in faults}
        setting = Together([set_parameter(*place, value) for place, value in rest.items()])
        fresh = faults_after(setting, rest)
        if not fresh:
            return faults
        faults |= fresh


def _listed(keys: Sequence[str]) -> str:
    more = f" and {len(keys) - _MOST_NAMED} more" if len(keys) > _MOST_NAMED else ""
    return ", ".join(map(shown, keys[:_MOST_NAMED])) + more
