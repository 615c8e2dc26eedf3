"""Nodes, and values of their parameters, as text that can be copied and pasted."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from core.editing.layout import Point, Sizes, arranged, free_places
from core.editing.links import check_new_wires
from core.editing.operations import (
    ABSENT,
    Add,
    Operation,
    Placed,
    Together,
    fresh_name,
    named,
    set_parameter,
)
from core.editing.references import WIRE_DOTS
from core.editing.wire_dots import dots_along, dots_among, joined_fields
from core.errors import ImagechainError, NetworkError
from core.modules.declaration import Declaration, Library
from core.modules.parameters import Parameter, plain
from core.names import shown, thaw
from core.network.file import format_network
from core.network.linked_values import LinkError, named_nodes, naming, resolved, with_names
from core.network.network import EXPRESSION, Link, Network, Node
from core.network.parsing import FORMAT, parse_network, read_json

NODES_FORMAT = "imagechain-nodes"
_VALUES = "values"  # of parameters that follow nodes which are not copied: the network pasted into
# may not have them
SOURCE = "the clipboard"

ValueOf = Callable[[str, str], Any]

_FARTHEST = 1e6  # a point beyond is none that a canvas could show


def copied(
    network: Network, names: Iterable[str], library: Library, value_of: ValueOf | None = None
) -> str:
    """Nodes, the links among them and where they lie, as JSON text.

    `value_of` gives the value of a node's parameter; where the network is the inside of a macro,
    with what is set from outside.

    Raises `NetworkError` if there is no such node, or one holds what JSON cannot.
    """
    part = _part(network, names)
    document = json.loads(format_network(part, library=library))
    copied_fields = ("version", "nodes", "links", "layout", WIRE_DOTS)
    fields = {
        "format": NODES_FORMAT,
        **{key: document[key] for key in copied_fields if key in document},
    }
    value_of = value_of or resolved(network, library=library).value
    if values := _values_of_outer_links(network, part, value_of):
        fields[_VALUES] = values
    return json.dumps(fields, ensure_ascii=False, indent=2)


def pasted(
    text: str,
    network: Network,
    library: Library,
    at: Point | None = None,
    sizes: Sizes = MappingProxyType({}),
) -> tuple[tuple[str, ...], Operation]:
    """What puts copied nodes in, under names that are free; and those names.

    The text is what `copied` gave, or a whole network file. `at` is the middle of where they are to
    lie; None: where they lay when they were copied. Where there is no room they lie as near as
    there is. A copy is not marked as the output.

    Raises `NetworkError` if the text holds no nodes, or what is wrong with them, in one line.
    """
    part, values = _read(text, library)
    part = _with_values_for(part, values, network)
    points = _points(part)
    if at is not None:
        points = _centred(points, at)
    return _adding(network, part, points, "Paste", {}, sizes)


def duplicated(
    network: Network,
    names: Iterable[str],
    library: Library,  # noqa: ARG001 - same arguments as `copied` and `pasted`
    sizes: Sizes = MappingProxyType({}),
) -> tuple[tuple[str, ...], Operation]:
    """What puts a copy of nodes on free ground near them, fed by the same wires; and its names.

    Raises `NetworkError` if there is no such node.
    """
    part = _part(network, names)
    points = {name: at for name, at in part.layout.items() if name in part.nodes}
    feeding = [
        link
        for link in network.links
        if link.target in part.nodes and link.source not in part.nodes
    ]
    return _adding(network, part, points, "Duplicate", sizes, sizes, feeding)


def _part(network: Network, names: Iterable[str]) -> Network:
    """A network of these nodes, in the network's order."""
    chosen = {name: network.node(name) for name in names}
    dots = dots_among(network, chosen)
    return Network(
        extra=joined_fields({}, dots),
        nodes={name: node for name, node in network.nodes.items() if name in chosen},
        links=tuple(link for link in network.links if {link.source, link.target} <= chosen.keys()),
        layout={name: at for name, at in network.layout.items() if name in chosen},
    )


def _values_of_outer_links(
    network: Network, part: Network, value_of: ValueOf
) -> dict[str, dict[str, Any]]:
    """Values of the part's parameters that follow nodes outside it, by node and parameter."""
    values: dict[str, dict[str, Any]] = {}
    for name, parameter in naming(part, network.nodes.keys() - part.nodes.keys()):
        value = value_of(name, parameter)
        if type(value) in (int, float):
            values.setdefault(name, {})[parameter] = value
    return values


def _with_values_for(part: Network, values: Any, network: Network) -> Network:
    """The part with values for parameters that follow what is neither in it nor in the network."""
    for name, node in part.nodes.items():
        given = values.get(name) if isinstance(values, dict) else None
        for parameter, leaders in named_nodes(node).items():
            value = given.get(parameter) if isinstance(given, dict) else None
            known = all(network.has(leader) or part.has(leader) for leader in leaders)
            if not known and type(value) in (int, float):
                part = part.with_parameter(name, parameter, value)
    return part


def _read(text: str, library: Library) -> tuple[Network, Any]:
    """The nodes, and the values of parameters that follow what was not copied."""
    strange = "contains no copied nodes and no network"
    document = _read_format(text, (NODES_FORMAT, FORMAT), strange)
    document["format"] = FORMAT
    values = document.pop(_VALUES, None)
    part = parse_network(json.dumps(document), library=library, name_of_source=SOURCE)
    if not part.nodes:
        raise NetworkError(f"{SOURCE} contains no nodes")
    try:
        check_new_wires(replace(part, links=()), part, library)
    except NetworkError as error:
        raise NetworkError(f"{SOURCE}: {error.message}") from None
    return part, values


def _read_format(text: str, formats: Sequence[str], strange: str) -> dict[str, Any]:
    # Most often it is just something else: then no word of JSON.
    if text.lstrip("\ufeff \t\r\n").startswith("{"):
        document: dict[str, Any] = read_json(text, SOURCE)
        if document.get("format") in formats:
            return document
    raise NetworkError(f"{SOURCE} {strange}")


def as_new(node: Node) -> Node:
    """The node, and those inside of it, neither the output nor with another's noise."""
    if node.macro is not None:
        nodes = {name: as_new(inner) for name, inner in node.macro.nodes.items()}
        node = replace(node, macro=replace(node.macro, nodes=nodes))
    return replace(node, final=False, noise="")


def _points(part: Network) -> dict[str, Point]:
    """Points of the copied nodes; laid out anew where not all have one."""
    points = {name: part.layout[name] for name in part.nodes if name in part.layout}
    if len(points) < len(part.nodes) or any(
        max(abs(x), abs(y)) > _FARTHEST for x, y in points.values()
    ):
        return arranged(replace(part, layout={}), {})
    return points


def _centred(points: Mapping[str, Point], at: Point) -> dict[str, Point]:
    xs, ys = zip(*points.values(), strict=True)
    x = round(at[0] - (min(xs) + max(xs)) / 2)
    y = round(at[1] - (min(ys) + max(ys)) / 2)
    return {name: (px + x, py + y) for name, (px, py) in points.items()}


def _adding(
    network: Network,
    part: Network,
    points: Mapping[str, Point],
    verb: str,
    sizes: Sizes,
    sizes_there: Sizes,
    feeding: Iterable[Link] = (),
) -> tuple[tuple[str, ...], Operation]:
    points = free_places(points, sizes, network, sizes_there)
    taken = set(network.nodes)
    fresh: dict[str, str] = {}
    for name in part.nodes:
        fresh[name] = fresh_name(name, taken)
        taken.add(fresh[name])
    try:
        renamed = {name: with_names(node, fresh) for name, node in part.nodes.items()}
    except NetworkError as error:
        raise NetworkError(f"{verb.lower()}: {error.message}") from None
    placed = tuple(
        Placed(replace(as_new(node), id=fresh[name]), points.get(name))
        for name, node in renamed.items()
    )
    links = [link.renamed(fresh) for link in part.links]
    links += [replace(link, target=fresh[link.target]) for link in feeding]
    names = tuple(fresh.values())
    label = f"{verb} {named([shown(name) for name in part.nodes])}"
    dots = {link.renamed(fresh): at for link, at in dots_along(part, points).items()}
    return names, Add(placed, tuple(links), label, joined_fields(network.extra, dots))


VALUES_FORMAT = "imagechain-values"
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
    """The values' one step, which may change nothing; the parameters it sets; why not others."""

    operation: Operation
    taken: tuple[str, ...]
    left_out: tuple[str, ...]


def copied_values(node: Node, declared: Declaration | None) -> str:
    """Every value of a node's panel as JSON text, those left at their defaults too.

    Expressions are copied as such. Of an unknown module only what is set can be copied.
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
    """What `copied_values` gave; a `NetworkError` if the text holds no values, in one line."""
    strange = "contains no parameter values"
    document = _read_format(text, (VALUES_FORMAT,), strange)
    values, units = document.get("values"), document.get("units", {})
    if not isinstance(values, dict) or not values:
        raise NetworkError(f"{SOURCE} {strange}")
    if not isinstance(units, dict) or not all(isinstance(unit, str) for unit in units.values()):
        raise NetworkError(f"{SOURCE}: units must be an object with a string for each parameter")
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
    not take, or has in another unit is left out. `faults_after` gives, of an operation and
    parameters, the faults of those whose expressions have no value after it.

    Raises `NetworkError` if the text holds no values, or nothing of it fits any of the nodes.
    """
    copied, names = read_values(text), tuple(names)
    steps: dict[Place, Any] = {}
    left_out: list[str] = []
    for name in names:
        declared = declaration_of(name)
        if declared is None:
            left_out.append(f"{shown(name)} belongs to an unknown module")
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

    Raises `NetworkError` or `ParameterError` if the parameter is in another unit, or does not take
    the value.
    """
    raw, unit = copied.values[parameter.name], copied.units.get(parameter.name)
    there = parameter.param.unit
    if unit is not None and unit != there:
        raise NetworkError(
            f"{parameter.name} is in {there or 'no unit'} in this node, not in {unit}"
        )
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
