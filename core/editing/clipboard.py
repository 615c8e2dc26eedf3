"""Nodes, and values of their parameters, as text that can be copied and pasted."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from core.editing.backdrops import dots_along, dots_among, joined_fields
from core.editing.layout import Point, Sizes, arranged, box_of, free_places, hull, shifted
from core.editing.operations import (
    ABSENT,
    WIRE_DOTS,
    Operation,
    add_nodes,
    fresh_name,
    named,
    set_parameter,
    together,
)
from core.editing.wiring import check_new_wires
from core.errors import ImagechainError, NetworkError, shown, thaw
from core.modules.declaration import Declaration, Library
from core.modules.parameters import Parameter, plain
from core.network.file import FORMAT, format_network, parse_network, read_json
from core.network.linked_values import with_names
from core.network.network import EXPRESSION, Link, Network, Node
from core.records import replace

NODES_FORMAT, VALUES_FORMAT = "imagechain-nodes", "imagechain-values"
SOURCE = "the clipboard"
_FARTHEST = 1e6  # a point beyond is none that a canvas could show


def copied(network: Network, names: Iterable[str], library: Library) -> str:
    """Nodes, the links among them and where they lie, as JSON text."""
    document = json.loads(format_network(_part(network, names), library=library))
    copied_fields = ("version", "nodes", "links", "layout", WIRE_DOTS)
    fields = {key: document[key] for key in copied_fields if key in document}
    return json.dumps({"format": NODES_FORMAT, **fields}, ensure_ascii=False, indent=2)


def pasted(
    text: str,
    network: Network,
    library: Library,
    at: Point | None = None,
    sizes: Sizes = MappingProxyType({}),
) -> tuple[tuple[str, ...], Operation]:
    """What puts copied nodes, or those of a network file, in; and their names, which are free.

    `at` is the middle of where they are to lie; None: where they lay when they were copied.
    """
    part = _read(text, library)
    points = _points(part)
    if at is not None:
        left, top, right, bottom = hull(box_of(point, (0.0, 0.0)) for point in points.values())
        by = round(at[0] - (left + right) / 2), round(at[1] - (top + bottom) / 2)
        points = {name: shifted(point, by) for name, point in points.items()}
    return _adding(network, part, points, "Paste", {}, sizes)


def duplicated(
    network: Network,
    names: Iterable[str],
    library: Library,  # noqa: ARG001 - same arguments as `copied` and `pasted`
    sizes: Sizes = MappingProxyType({}),
) -> tuple[tuple[str, ...], Operation]:
    """What puts a copy of nodes on free ground near them, fed by the same wires; and its names."""
    part = _part(network, names)
    points = {name: at for name, at in part.layout.items() if name in part.nodes}
    feeding = [
        link
        for link in network.links
        if link.target in part.nodes and link.source not in part.nodes
    ]
    return _adding(network, part, points, "Duplicate", sizes, sizes, feeding)


def _part(network: Network, names: Iterable[str]) -> Network:
    chosen = {name: network.node(name) for name in names}
    dots = dots_among(network, chosen)
    return Network(
        extra=joined_fields({}, dots),
        nodes={name: node for name, node in network.nodes.items() if name in chosen},
        links=tuple(link for link in network.links if {link.source, link.target} <= chosen.keys()),
        layout={name: at for name, at in network.layout.items() if name in chosen},
    )


def _read(text: str, library: Library) -> Network:
    strange = "contains neither copied nodes nor a network"
    document = _read_format(text, (NODES_FORMAT, FORMAT), strange)
    document["format"] = FORMAT
    part = parse_network(json.dumps(document), library=library, name_of_source=SOURCE)
    if not part.nodes:
        raise NetworkError(f"{SOURCE} contains no nodes")
    try:
        check_new_wires(replace(part, links=()), part, library)
    except NetworkError as error:
        raise NetworkError(f"{SOURCE}: {error.message}") from None
    return part


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
        (replace(as_new(node), id=fresh[name]), points.get(name)) for name, node in renamed.items()
    )
    links = [link.renamed(fresh) for link in part.links]
    links += [replace(link, target=fresh[link.target]) for link in feeding]
    names = tuple(fresh.values())
    label = f"{verb} {named([shown(name) for name in part.nodes])}"
    dots = {link.renamed(fresh): at for link, at in dots_along(part, points).items()}
    return names, add_nodes(placed, tuple(links), label, joined_fields(network.extra, dots))


def copied_values(node: Node, declared: Declaration | None) -> str:
    """Every value of a node's panel as JSON text, defaults too; expressions as such."""
    usual = declared.parameters if declared is not None else ()
    values = {one.name: plain(one.default) for one in usual if not one.required}
    fields = {"format": VALUES_FORMAT, "version": 1, "values": values | thaw(node.params)}
    return json.dumps(fields, ensure_ascii=False, indent=2)


def read_values(text: str) -> dict[str, Any]:
    """What `copied_values` gave; a `NetworkError` if the text holds no values, in one line."""
    strange = "contains no parameter values"
    values = _read_format(text, (VALUES_FORMAT,), strange).get("values")
    if not isinstance(values, dict) or not values:
        raise NetworkError(f"{SOURCE} {strange}")
    return values


def pasted_values(
    text: str, names: Sequence[str], declaration_of: Callable[[str], Declaration | None]
) -> tuple[Operation, tuple[str, ...]]:
    """What gives nodes the copied values that their parameters take, and why not the others."""
    values = read_values(text)
    steps: list[Operation] = []
    left_out = []
    for name in names:
        declared = declaration_of(name)
        title = declared.title if declared is not None else shown(name)
        for key, raw in values.items():
            parameter = declared.parameter(key) if declared is not None else None
            if parameter is None:
                left_out.append(f"{title} has no parameter {shown(key)}")
                continue
            try:
                steps.append(set_parameter(name, key, _fitting(parameter, raw)))
            except ImagechainError as error:
                left_out.append(error.message)
    if not steps:
        raise NetworkError(f"no copied value fits {named(names)}: {'; '.join(left_out[:3])}")
    return together(steps, f"Paste values on {named(names)}"), tuple(dict.fromkeys(left_out))


def _fitting(parameter: Parameter, raw: Any) -> Any:
    if isinstance(raw, dict) and EXPRESSION in raw:
        return raw
    value = parameter.coerce(raw)
    return ABSENT if not parameter.required and value == parameter.default else plain(value)
