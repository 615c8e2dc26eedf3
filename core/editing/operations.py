"""Changes of a network as values: what gives the network after it from the one before."""

import itertools
import json
from collections.abc import Callable, Collection, Container, Iterable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any, TypeVar

from core.editing.layout import Point
from core.errors import NetworkError, freeze, shown, thaw
from core.modules.declaration import Declaration, Library
from core.network.linked_values import naming, with_names
from core.network.macro import (
    FIELDS,
    SEPARATOR,
    End,
    Interface,
    checked_depth,
    declared_node,
    depth,
    face_of_macro,
    interface_of,
    path_of,
    unfolded,
    with_face,
)
from core.network.network import EXPRESSION, Link, Network, Node, with_marks
from core.records import dataclass, replace

ABSENT: Any = object()
"""The value of what is not there: a parameter left at its default, a field left out."""


@dataclass(frozen=True)
class Operation:
    """A change of a network, a function, and its text for the undo menu.

    `moved` gives, of the network before, the new names of nodes by the old ones. `path` is that of
    the one field that is set, `marks` what is marked as the output.
    """

    apply: Callable[[Network], Network]
    text: str = ""
    moved: Callable[[Network], Mapping[str, str]] = lambda _: {}
    path: tuple[str, ...] = ()
    marks: tuple[str, ...] | None = None


def together(operations: Sequence[Operation], label: str = "") -> Operation:
    more = len(operations) - 1
    if operations and not label:
        label = operations[0].text + (f" and {more} more" if more else "")

    def apply(network: Network) -> Network:
        for operation in operations:
            network = operation.apply(network)
        return network

    def moved(network: Network) -> dict[str, str]:
        names: dict[str, str] = {}
        for operation in operations:
            step = dict(operation.moved(network))
            names = {old: step.pop(new, new) for old, new in names.items()}
            names |= {old: new for old, new in step.items() if old not in names}
            network = operation.apply(network)
        return names

    return Operation(apply, label, moved)


def restored(network: Network, label: str, names: Mapping[str, str] | None = None) -> Operation:
    """Put a whole network in the place of the present one, whatever that has become."""
    return Operation(lambda _: network, label, lambda _: names or {})


def with_field(fields: Mapping[str, Any], name: str, value: Any) -> dict[str, Any]:
    """The fields with one set, or taken away by ABSENT."""
    if value is ABSENT:
        return {key: item for key, item in fields.items() if key != name}
    return {**fields, name: value}


def named(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{len(names)} nodes"


def check_plain(value: Any, what: str) -> None:
    """Refuse what no network file can hold, before it is in the document and cannot be saved."""
    try:
        # Half a surrogate pair is a text to Python, but not to a file.
        json.dumps(thaw(value), ensure_ascii=False, allow_nan=False).encode()
    except (TypeError, ValueError):
        raise NetworkError(
            f"{shown(what)} cannot be {value!r:.80}: only finite numbers, strings, true, false, "
            "null, and lists and objects of these values can be saved"
        ) from None


_OF_NODE = ("auto", "disabled")
_OF_NETWORK = ("name", "description", "seed")
# Fields that other operations change, as more than one value depends on them.
_NOT_OF_NODE = {"module", "params", "final"}
_NOT_OF_NETWORK = {"nodes", "links", "layout", "format", "version"}
_Fielded = TypeVar("_Fielded", Node, Network)


def set_field(path: tuple[str, ...], value: Any, label: str = "") -> Operation:
    """Set the field at a path of the network's file; ABSENT takes it away.

    ``("seed",)``, ``("nodes", node, "disabled")`` or ``("nodes", node, "params", parameter)``.
    """
    text = label or _text_of_setting(path, value)
    return Operation(partial(_with_field_set, path, value, text), text, path=path)


def _text_of_setting(path: tuple[str, ...], value: Any) -> str:
    match path:
        case ("nodes", node, "params", name):
            verb = "Reset" if value is ABSENT else "Set"
            linked = isinstance(value, Mapping) and EXPRESSION in value
            return f"{'Link' if linked else verb} {node}.{name}"
        case ("nodes", node, "disabled"):
            return f"{'Disable' if value else 'Enable'} {node}"
        case ("nodes", node, "auto"):
            return f"{'Hold' if value is False else 'Auto-generate'} {node}"
        case ("nodes", node, name):
            return f"Set {name} of {node}"
        case (name,) if name in _OF_NETWORK:
            return f"Set the network's {name}"
    return f"Set {path[-1]}"


def _with_field_set(path: tuple[str, ...], value: Any, text: str, network: Network) -> Network:
    match path:
        case ("nodes", node, *rest) if (step := network.step_inside(node)) is not None:
            inner = set_field(("nodes", step[1], *rest), value, text)
            network = inside(step[0], inner).apply(network)
            while rest[0] == "params" and (name := exposed_as(network, node, rest[-1])):
                # A macro that shows it sets it no longer: what was set last holds.
                node, rest = SEPARATOR.join(path_of(network, node)[:-1]), ["params", name]
                network = set_parameter(node, name, ABSENT).apply(network)
            return network
        case ("nodes", node, "params", name):
            _check_value(value, f"{node}.{name}")
            old = network.node(node)
            return network.with_node(replace(old, params=with_field(old.params, name, value)))
        case ("nodes", node, name) if name not in _NOT_OF_NODE:
            _check_value(value, f"{node}.{name}")
            return network.with_node(_with(network.node(node), name, value, _OF_NODE))
        case (name,) if name not in _NOT_OF_NETWORK:
            _check_value(value, name)
            if name in ("name", "description") and not isinstance(value, str):
                raise NetworkError(f"the network's {name} must be a string, not {value!r:.80}")
            return _with(network, name, value, _OF_NETWORK)
    raise NetworkError(f"{'.'.join(path)} cannot be set by itself")


def _with(target: _Fielded, name: str, value: Any, own: tuple[str, ...]) -> _Fielded:
    """With one of its own fields, or else one of the others of its file."""
    others = {"extra": with_field(target.extra, name, value)}
    changes: dict[str, Any] = {name: value} if name in own else others
    return replace(target, **changes)


def _check_value(value: Any, what: str) -> None:
    if value is not ABSENT:
        check_plain(freeze(value), what)


def set_parameter(node: str, name: str, value: Any, label: str = "") -> Operation:
    """Give a parameter a value as a network file has it; ABSENT leaves it at its default."""
    return set_field(("nodes", node, "params", name), value, label)


def set_node_field(node: str, name: str, value: Any) -> Operation:
    """Set ``auto``, ``disabled`` or another field of a node, such as ``pinned``."""
    return set_field(("nodes", node, name), value)


def set_network_field(name: str, value: Any, label: str = "") -> Operation:
    """Set the network's name, description, seed or another field, such as ``backdrops``."""
    return set_field((name,), value, label)


def inside(macro: str, operation: Operation) -> Operation:
    """Carry an operation out inside of a macro.

    Ports and parameters that the macro shows follow the nodes they stand for; where these are gone,
    the wires to the macro's port and its value of the parameter go too.
    """

    def apply(network: Network) -> Network:
        node = network.node(macro)
        if node.macro is None:
            raise NetworkError(f"{shown(macro)} is not a macro, so there are no nodes inside it")
        after = operation.apply(node.macro)
        if after is node.macro:
            return network
        checked_depth(1 + depth(after), macro)
        return _with_body(network, node, after, operation.moved(node.macro))

    def moved(network: Network) -> dict[str, str]:
        body = network.node(macro).macro
        names = operation.moved(body) if body is not None else {}
        head = f"{macro}{SEPARATOR}"
        return {head + old: head + new for old, new in names.items()}

    return Operation(apply, operation.text, moved)


def _with_body(network: Network, node: Node, body: Network, moved: Mapping[str, str]) -> Network:
    """The network with another inside of a macro, and without what this does not show any more."""
    assert node.macro is not None
    face, outer, head = face_of_macro(body), face_of_macro(network), f"{node.id}{SEPARATOR}"
    params = {name: value for name, value in node.params.items() if name in face.parameters}
    changed = network.with_node(replace(node, params=params, macro=body))
    names = {head + old: head + new for old, new in moved.items()}
    if names and naming(changed, names):
        nodes = {name: with_names(other, names) for name, other in changed.nodes.items()}
        changed = changed.with_nodes(nodes)
    extra: Mapping[str, Any] = renamed(network.extra, names) if names else network.extra
    gone = set(unfolded(node.macro).nodes) - set(unfolded(body).nodes) - moved.keys()
    if gone:
        extra = dropped(extra, {head + name for name in gone})
    links = tuple(
        link
        for link in network.links
        if (link.source != node.id or link.output in face.outputs)
        and (link.target != node.id or link.input in face.inputs)
    )
    changed = replace(changed, links=links, extra=extra)

    def kept(end: End, still: Container[str]) -> tuple[End, ...]:
        return (end,) if end[0] != node.id or end[1] in still else ()

    sides = (partial(kept, still=s) for s in (face.inputs, face.outputs, face.parameters))
    shown_still = outer.mapped(*sides)
    if shown_still != outer:
        changed = with_face(changed, shown_still)
    return changed


def exposed_as(network: Network, node: str, parameter: str) -> str:
    """What the macro around an inner node calls its parameter; empty where it is not shown."""
    *macros, inner = path_of(network, node)
    if not macros:
        return ""
    parameters = face_of_macro(body_of(network, macros)).parameters
    return next((name for name, end in parameters.items() if end == (inner, parameter)), "")


def body_of(network: Network, macros: Sequence[str]) -> Network:
    for macro in macros:
        body = network.node(macro).macro
        if body is None:
            raise NetworkError(f"{shown(macro)} is not a macro")
        network = body
    return network


def rewire(
    *, add: Sequence[Link] = (), remove: Collection[Link] = (), label: str = ""
) -> Operation:
    """Take links away and put links in; one into an input that has one takes its place."""
    first = next(iter((*add, *remove)), None)
    text = label or f"{'Connect' if add else 'Disconnect'} {first or ''}".strip()

    def apply(network: Network) -> Network:
        for link in add:
            network.node(link.source)
            network.node(link.target)
        missing = [link for link in remove if link not in network.links]
        if missing:
            raise NetworkError(f"there is no link {missing[0]}")
        new, taken = set(add), {(link.target, link.input) for link in add}
        gone = {link for link in network.links if (link.target, link.input) in taken}
        gone = (gone | set(remove)) - new
        unchanged = [link for link in network.links if link not in gone and link not in new]
        extra = without_dots(network.extra, gone)
        return replace(network, links=(*unchanged, *add), extra=extra)

    return Operation(apply, text)


def add_nodes(
    placed: Sequence[tuple[Node, Point | None]],
    links: Sequence[Link] = (),
    label: str = "",
    extra: Mapping[str, Any] = MappingProxyType({}),
) -> Operation:
    """Put nodes in at points, and links; a link into an input that has one takes its place."""

    def apply(network: Network) -> Network:
        nodes, layout = dict(network.nodes), dict(network.layout)
        for node, at in placed:
            if node.id in nodes:
                raise NetworkError(f"there is already a node {shown(node.id)}")
            nodes[node.id] = node
            if at is not None:
                layout[node.id] = at
        fields = {**network.extra, **extra}
        grown = replace(network, nodes=nodes, layout=layout, extra=fields)
        return rewire(add=links).apply(grown)

    return Operation(apply, label or f"Add {named([node.id for node, _ in placed])}")


def remove_nodes(names: Sequence[str], label: str = "") -> Operation:
    def apply(network: Network) -> Network:
        for name in names:
            network.node(name)
        gone = set(names)
        return replace(
            network,
            nodes={name: node for name, node in network.nodes.items() if name not in gone},
            links=tuple(link for link in network.links if not {link.source, link.target} & gone),
            layout={name: at for name, at in network.layout.items() if name not in gone},
            extra=dropped(network.extra, of_nodes(gone, network.nodes)),
        )

    return Operation(apply, label or f"Delete {named(names)}")


def move_nodes(positions: Mapping[str, Point], label: str = "") -> Operation:
    def apply(network: Network) -> Network:
        for name in positions:
            network.node(name)
        return replace(network, layout={**network.layout, **positions})

    return Operation(apply, label or f"Move {named(list(positions))}")


def rename_node(old: str, new: str) -> Operation:
    """Give a node another id, wherever it is mentioned."""

    def within(network: Network) -> Operation | None:
        step = network.step_inside(old)
        return inside(step[0], rename_node(step[1], new)) if step else None

    def moved(network: Network) -> Mapping[str, str]:
        if inner := within(network):
            return inner.moved(network)
        names = of_nodes([old], network.nodes)
        return {name: new + name.removeprefix(old) for name in names}

    def apply(network: Network) -> Network:
        if inner := within(network):
            return inner.apply(network)
        network.node(old)
        if new != old and new in network.nodes:
            raise NetworkError(f"there is already a node {shown(new)}")
        names = {old: new}
        try:
            nodes = {name: with_names(node, names) for name, node in network.nodes.items()}
        except NetworkError as error:
            raise NetworkError(f"{shown(old)} cannot be renamed: {error.message}") from None
        nodes[old] = replace(nodes[old], id=new)
        return replace(
            network,
            nodes={names.get(name, name): node for name, node in nodes.items()},
            links=tuple(link.renamed(names) for link in network.links),
            layout={names.get(name, name): at for name, at in network.layout.items()},
            extra=renamed(network.extra, moved(network)),
        )

    return Operation(apply, f"Rename {old} to {new}", moved)


def keeping_values(
    *,
    network: Network,
    names: Collection[str],
    taking: Operation,
    value_of: Callable[[str, str], Any],
) -> tuple[Operation, tuple[str, ...]]:
    """`taking` nodes out, with the values of parameters that follow them put in; and which."""
    places = [place for place in naming(network, names) if place[0] not in names]
    if not places:
        return taking, ()
    steps: list[Operation] = []
    kept = []
    for node, parameter in places:
        value = thaw(value_of(node, parameter))
        if not isinstance(value, dict):  # else it had no value, and still has none
            steps.append(set_parameter(node, parameter, value))
            kept.append(f"{shown(node)}.{parameter} = {value}")
    return together((*steps, taking), taking.text), tuple(kept)


def fresh_name(wanted: str, taken: Container[str]) -> str:
    """`wanted`, or with the first number behind it that makes it new: ``jitter``, ``jitter_2``."""
    if wanted not in taken:
        return wanted
    head, _, tail = wanted.rpartition("_")
    stem = head if head and tail.isdigit() else wanted
    numbered = (f"{stem}_{number}" for number in itertools.count(2))
    return next(name for name in numbered if name not in taken)


def mark_output(nodes: tuple[str, ...]) -> Operation:
    """Mark these nodes as the network's output, one at most; its older field ``final`` goes."""

    def apply(network: Network) -> Network:
        for name in nodes:
            if not network.has(name):
                network.node(name)
        return with_marks(network, nodes, with_field(network.extra, "final", ABSENT))

    text = f"Mark {nodes[0]} as the output" if nodes else "Unmark the output"
    return Operation(apply, text, marks=nodes)


def output_toggled(network: Network, library: Library, name: str) -> Operation:
    node = network.node(name)
    if name in network.output_nodes or (node.macro is not None and node.macro.marked):
        return mark_output(())
    declared = declared_node(node, library)
    if declared is not None and not has_picture(declared):
        raise NetworkError(f"{shown(name)} cannot be the output: it has no picture")
    return mark_output((picture_node(node, library),))


def picture_node(node: Node, library: Library) -> str:
    """The node's id; of a macro that of the one inside whose picture it shows first."""
    if node.macro is None:
        return node.id
    declared = declared_node(node, library)
    pictures = [port.name for port in declared.outputs if "image" in port.types] if declared else []
    for name in pictures[:1]:
        inner = node.macro.nodes[face_of_macro(node.macro).outputs[name][0]]
        return f"{node.id}{SEPARATOR}{picture_node(inner, library)}"
    raise NetworkError(f"{shown(node.id)} has no picture: mark a node inside this macro")


def has_picture(declared: Declaration) -> bool:
    """Whether a module makes a picture or, making nothing, takes one."""
    ports = declared.inputs if declared.sink else declared.outputs
    return any("image" in port.types for port in ports)


# Where a network's other fields mention its nodes: output, figures, dots of wires, ports.

WIRE_DOTS = "wire_dots"  # points that wires are bent through


def of_nodes(names: Iterable[str], nodes: Mapping[str, Node]) -> set[str]:
    """These nodes and, as ``MACRO/NODE``, those inside of the macros among them."""
    chosen = {name: nodes[name] for name in names if name in nodes}
    return {*names, *unfolded(Network(nodes=chosen)).nodes}


def renamed(extra: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """The fields with nodes' new names, by the old ones."""
    fields = dict(extra)
    if _of(fields.get("final")) in names:
        fields["final"] = _moved(fields["final"], names)
    if any(_of(row.get("from")) in names for row in _rows(fields)):
        fields["published"] = [
            {**row, "from": _moved(row["from"], names)} if _of(row.get("from")) in names else row
            for row in thaw(fields["published"])
        ]
    links = _links_of_dots(fields)
    if any(names.keys() & {link.source, link.target} for link in links if link is not None):
        fields[WIRE_DOTS] = [
            entry if link is None else {**entry, "link": link.renamed(names).text()}
            for entry, link in zip(thaw(fields[WIRE_DOTS]), links, strict=True)
        ]
    return _with_face_of(extra, fields, lambda face: face.renamed(names))


def dropped(extra: Mapping[str, Any], gone: set[str]) -> dict[str, Any]:
    """The fields without entries that name these nodes."""
    fields = dict(extra)
    if _of(fields.get("final")) in gone:
        del fields["final"]
    if any(_of(row.get("from")) in gone for row in _rows(fields)):
        rows = thaw(fields["published"])
        fields["published"] = [row for row in rows if _of(row.get("from")) not in gone]
    links = (link for link in _links_of_dots(fields) if link is not None)
    fields = without_dots(fields, {link for link in links if {link.source, link.target} & gone})
    return _with_face_of(extra, fields, lambda face: face.without(gone))


def without_dots(extra: Mapping[str, Any], gone: Collection[Link]) -> dict[str, Any]:
    fields, links = dict(extra), _links_of_dots(extra)
    if any(link in gone for link in links if link is not None):
        entries = zip(thaw(fields[WIRE_DOTS]), links, strict=True)
        fields[WIRE_DOTS] = [entry for entry, link in entries if link is None or link not in gone]
        if not fields[WIRE_DOTS]:
            del fields[WIRE_DOTS]
    return fields


def _with_face_of(
    extra: Mapping[str, Any], fields: dict[str, Any], change: Callable[[Interface], Interface]
) -> dict[str, Any]:
    if not any(isinstance(extra.get(name), Mapping) for name in FIELDS):
        return fields
    try:
        face = interface_of(extra)
    except NetworkError:  # of another form: left as it is
        return fields
    new = change(face)
    if new == face:
        return fields
    return {name: value for name, value in fields.items() if name not in FIELDS} | new.fields()


def dots_entry_link(entry: Any) -> Link | None:
    ends = entry.get("link") if isinstance(entry, Mapping) else None
    if not isinstance(ends, tuple | list) or len(ends) != 2:
        return None
    try:
        return Link.between(*ends)
    except (NetworkError, AttributeError):  # no port, or no text
        return None


def _links_of_dots(fields: Mapping[str, Any]) -> list[Link | None]:
    entries = fields.get(WIRE_DOTS)
    if not isinstance(entries, tuple | list):
        return []  # of another form: left as it is
    return [dots_entry_link(entry) for entry in entries]


def _rows(fields: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    rows = fields.get("published")
    if not isinstance(rows, tuple | list) or not all(isinstance(row, Mapping) for row in rows):
        return []  # of another form: left as it is
    return list(rows)


def _of(port: Any) -> str | None:
    return port.rpartition(".")[0] if isinstance(port, str) else None


def _moved(port: str, names: Mapping[str, str]) -> str:
    node, _, name = port.rpartition(".")
    return f"{names[node]}.{name}"
