"""Making one node of several, a macro, and several of one again; the picture stays the same."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from core.editing.drawing.backdrops import FIELD as BACKDROPS
from core.editing.drawing.backdrops import backdrops_of
from core.editing.drawing.wire_dots import dots_among, dots_of, joined_fields, shifted
from core.editing.layout.boxes import Point
from core.editing.macros.border_links import (
    after_ungrouping,
    expressions_for_macro,
    inside_of_macro,
    values_of_lifted,
    with_lifted,
    with_moved_names,
)
from core.editing.macros.macro_wires import (
    inner_links,
    inputs_of,
    outer_links,
    outputs_of,
    with_inside_shown,
    with_macro_shown,
)
from core.editing.nodes import fresh_name
from core.editing.operation import Operation, named
from core.editing.references import of_nodes, renamed, without_dots
from core.errors import NetworkError
from core.modules.library_type import Library
from core.names import shown, thaw
from core.network.expansion import unfolded
from core.network.graph import cycles
from core.network.interface import End, Interface
from core.network.linked_values import resolved
from core.network.macro import (
    SEPARATOR,
    checked_depth,
    depth,
    face_of_macro,
    opened,
    with_face,
)
from core.network.network import MACRO, Link, Network, Node, cycle_error


@dataclass(frozen=True)
class Group(Operation):
    """Put nodes into a new macro.

    Parameters
    ----------
    name : str
        Id of the macro.
    members : tuple of str
        The nodes.
    face : Interface
        What the macro shows.
    noisy : frozenset of str
        Those of them and of the nodes inside of them that draw noise: it stays as it is.
    values : mapping
        By parameter of the macro that takes over an expression: the value inside from then on.
    where : str
        The macros this happens in, as ``camera/``; empty in the network itself.
    """

    name: str
    members: tuple[str, ...]
    face: Interface
    noisy: frozenset[str] = frozenset()
    values: Mapping[str, Any] = field(default_factory=dict)
    where: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        return f"Group {named(self.members)}"

    def apply(self, network: Network) -> Network:
        """The network with the macro in their place."""
        inner = {name: network.node(name) for name in self.members}
        if self.name in network.nodes and self.name not in inner:
            raise NetworkError(f"there is a node {shown(self.name)} already")
        moved = self.moved(network)
        lifted = expressions_for_macro(inner, self.face, moved)

        def member(node: Node) -> Node:
            node = inside_of_macro(node, self.face, lifted, self.values)
            return _with_noise(node, self.where + node.id, self.noisy)

        body = Network(
            nodes={name: member(node) for name, node in network.nodes.items() if name in inner},
            links=tuple(
                link for link in network.links if {link.source, link.target} <= inner.keys()
            ),
            layout={name: at for name, at in network.layout.items() if name in inner},
            extra={**self.face.fields(), **joined_fields({}, dots_among(network, inner))},
        )
        checked_depth(1 + depth(body), self.name)
        macro = Node(self.name, MACRO, params=lifted, macro=body)
        nodes = {}
        for name, node in with_moved_names(network.nodes.values(), moved).items():
            if name == next(name for name in network.nodes if name in inner):
                nodes[self.name] = macro
            if name not in inner:
                nodes[name] = node
        layout = {name: at for name, at in network.layout.items() if name not in inner}
        if body.layout:
            layout[self.name] = _middle(body.layout)
        extra: Mapping[str, Any] = without_dots(network.extra, _links_at(network, inner))
        for old, new in moved.items():
            extra = renamed(extra, old, new)
        changed = replace(
            network,
            nodes=nodes,
            links=outer_links(network, self.name, inner, self.face),
            layout=layout,
            extra=extra,
        )
        around = face_of_macro(network)
        if around != Interface():
            changed = with_face(changed, with_macro_shown(around, self.name, self.face))
        loops = cycles(changed.followers)
        if loops and not cycles(network.followers):
            raise cycle_error(loops[0])
        return changed

    def moved(self, network: Network) -> dict[str, str]:
        """The names of the nodes, which lie in the macro now."""
        names = of_nodes(self.members, network.nodes)
        return {name: f"{self.name}{SEPARATOR}{name}" for name in names}


@dataclass(frozen=True)
class Ungroup(Operation):
    """Put the nodes of a macro in its place.

    Parameters
    ----------
    name : str
        The macro.
    fresh : mapping of str to str
        What each of its nodes is to be called.
    noisy : frozenset of str
        Those of them and of the nodes inside of them that draw noise, as ``camera/blur``.
    where : str
        The macros this happens in, as ``camera/``; empty in the network itself.
    """

    name: str
    fresh: Mapping[str, str] = field(default_factory=dict)
    noisy: frozenset[str] = frozenset()
    where: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        return f"Ungroup {self.name}"

    def apply(self, network: Network) -> Network:
        """The network with the nodes."""
        node = network.node(self.name)
        if node.macro is None:
            raise NetworkError(f"{shown(self.name)} is no macro: there is nothing to ungroup")
        body = opened(node, linked=False)
        names = {name: self.fresh.get(name, name) for name in body.nodes}
        others = {name for name in network.nodes if name != self.name}
        for name in names.values():
            if name in others:
                raise NetworkError(f"there is a node {shown(name)} already")
        extra: Mapping[str, Any] = without_dots(network.extra, _links_at(network, {self.name}))
        moved = self.moved(network)
        for old, new in moved.items():
            extra = renamed(extra, old, new)
        shift = _shift(network, self.name, body)
        face = face_of_macro(body)
        around_it = {
            name: after_ungrouping(other, self.name, face, names, moved)
            for name, other in network.nodes.items()
        }
        inner = self._inner(around_it[self.name], body, names)
        changed = replace(
            network,
            nodes=_in_place(around_it, self.name, inner),
            links=inner_links(network, self.name, body, names),
            layout={
                **{name: at for name, at in network.layout.items() if name != self.name},
                **{
                    names[name]: (at[0] + shift[0], at[1] + shift[1])
                    for name, at in body.layout.items()
                    if name in names
                },
            },
            extra=_with_dots(body, names, shift, _with_backdrops(network, body, shift, extra)),
        )
        around = face_of_macro(network)
        if around == Interface():
            return changed
        return with_face(changed, with_inside_shown(around, self.name, body, names))

    def _inner(self, macro: Node, body: Network, names: Mapping[str, str]) -> dict[str, Node]:
        inner = {}
        followers = with_moved_names(body.nodes.values(), names)
        for name, (own, parameter) in face_of_macro(body).parameters.items():
            if name in macro.linked and own in followers:
                params = {**followers[own].params, parameter: macro.params[name]}
                followers[own] = replace(followers[own], params=params)
        for name, node in followers.items():
            auto = node.auto if macro.auto is None else macro.auto
            outer = f"{self.where}{self.name}{SEPARATOR}{name}"
            plain = _with_noise(replace(node, id=names[name], auto=auto), outer, self.noisy)
            inner[names[name]] = _without_own(plain, self.where + names[name])
        return inner

    def moved(self, network: Network) -> dict[str, str]:
        """The names of the nodes, which lie in the macro no more."""
        body = network.node(self.name).macro
        names: dict[str, str] = {}
        for inner in body.nodes if body is not None else ():
            assert body is not None
            for name in of_nodes([inner], body.nodes):
                new = self.fresh.get(inner, inner) + name.removeprefix(inner)
                names[f"{self.name}{SEPARATOR}{name}"] = new
        return names


def group(
    network: Network,
    library: Library,
    names: Iterable[str],
    name: str = "macro",
    where: str = "",
    value_of: Callable[[str, str], Any] | None = None,
) -> tuple[str, Operation]:
    """What makes one node of several, and its name; `where` as for `Group`.

    `value_of` gives the value of a node's parameter, in a macro with what is set from outside;
    None: as the network alone has it.
    The macro has an input for every wire that comes from outside and every input that still needs
    one, an output for every one that leads outside and for the pictures nothing leads on from.

    Raises
    ------
    NetworkError
        If there is no such node, or a way leaves the nodes and comes back.
    """
    members = tuple(dict.fromkeys(names))
    if not members:
        raise NetworkError("select the nodes that are to be grouped first")
    for member in members:
        network.node(member)
    taken = set(network.nodes) - set(members)
    fresh = fresh_name(name, taken)
    around = face_of_macro(network)
    parameters: dict[str, End] = {}
    for end in around.parameters.values():
        if end[0] in members:
            parameters[fresh_name(end[1], parameters)] = end
    parameters = with_lifted(network, members, parameters)
    inputs = inputs_of(network, library, members, around)
    face = Interface(inputs, outputs_of(network, library, members, around), parameters)
    value_of = value_of or resolved(network, library=library).value
    values = values_of_lifted(parameters, value_of)
    noisy = _noisy(network, library, members, where)
    operation = Group(fresh, members, face, noisy, values, where)
    try:
        operation.apply(network)
    except NetworkError as error:
        if "cycle" not in error.message:
            raise
        raise NetworkError(
            f"these nodes cannot be one: a way leads out of them and back in ({error.message})"
        ) from None
    return fresh, operation


def ungroup(
    network: Network, library: Library, name: str, where: str = ""
) -> tuple[tuple[str, ...], Operation]:
    """What puts the nodes of a macro in its place, under names that are free; and the names.

    Raises
    ------
    NetworkError
        If there is no such macro, or it is disabled.
    """
    node = network.node(name)
    if node.macro is None:
        raise NetworkError(f"{shown(name)} is no macro: there is nothing to ungroup")
    if node.disabled:
        raise NetworkError(f"{shown(name)} is disabled: enable it, then ungroup it")
    taken = set(network.nodes) - {name}
    fresh = {}
    for inner in node.macro.nodes:
        fresh[inner] = fresh_name(inner, taken)
        taken.add(fresh[inner])
    body = node.macro
    noisy = _noisy(body, library, tuple(body.nodes), f"{where}{name}{SEPARATOR}")
    return tuple(fresh.values()), Ungroup(name, fresh, noisy, where)


def _noisy(network: Network, library: Library, names: Sequence[str], where: str) -> frozenset[str]:
    chosen = {name: network.nodes[name] for name in names}
    return frozenset(
        where + name
        for name, node in unfolded(Network(nodes=chosen)).nodes.items()
        if node.macro is None
        and (node.noise or node.module not in library or library[node.module].draws_noise)
    )


def _with_noise(node: Node, name: str, noisy: frozenset[str]) -> Node:
    """The node, drawing its noise, and that of nodes inside, under the name it has until now."""
    if node.macro is None:
        return node if node.noise or name not in noisy else replace(node, noise=name)
    return _each_inside(
        node, lambda inner: _with_noise(inner, f"{name}{SEPARATOR}{inner.id}", noisy)
    )


def _without_own(node: Node, name: str) -> Node:
    """The node without the name of its noise where it is called so anyway."""
    if node.macro is None:
        return replace(node, noise="") if node.noise == name else node
    return _each_inside(node, lambda inner: _without_own(inner, f"{name}{SEPARATOR}{inner.id}"))


def _each_inside(macro: Node, change: Callable[[Node], Node]) -> Node:
    assert macro.macro is not None
    nodes = {name: change(inner) for name, inner in macro.macro.nodes.items()}
    if all(nodes[name] is inner for name, inner in macro.macro.nodes.items()):
        return macro
    return replace(macro, macro=replace(macro.macro, nodes=nodes))


def _in_place(around: Mapping[str, Node], macro: str, inner: Mapping[str, Node]) -> dict[str, Node]:
    nodes: dict[str, Node] = {}
    for name, node in around.items():
        nodes |= inner if name == macro else {name: node}
    return nodes


def _middle(layout: Mapping[str, Point]) -> Point:
    xs, ys = zip(*layout.values(), strict=True)
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2


def _shift(network: Network, macro: str, body: Network) -> Point:
    """How far a macro has been moved since it stood in the middle of its nodes."""
    if not body.layout or macro not in network.layout:
        return 0.0, 0.0
    middle, at = _middle(body.layout), network.layout[macro]
    return at[0] - middle[0], at[1] - middle[1]


def _with_backdrops(
    network: Network, body: Network, shift: Point, extra: Mapping[str, Any]
) -> Mapping[str, Any]:
    """The network's fields with the backdrops that stood inside."""
    if not backdrops_of(body):
        return extra
    inside = [
        {**entry, "x": entry["x"] + shift[0], "y": entry["y"] + shift[1]}
        for entry in thaw(body.extra[BACKDROPS])
        if isinstance(entry, dict) and {"x", "y"} <= entry.keys()
    ]
    return {**extra, BACKDROPS: [*thaw(network.extra.get(BACKDROPS, [])), *inside]}


def _links_at(network: Network, names: Collection[str]) -> set[Link]:
    """The links that begin or end at these nodes."""
    return {link for link in network.links if link.source in names or link.target in names}


def _with_dots(
    body: Network, names: Mapping[str, str], shift: Point, extra: Mapping[str, Any]
) -> Mapping[str, Any]:
    """The network's fields with the dots of the wires that lay inside."""
    dots = {
        replace(link, source=names[link.source], target=names[link.target]): shifted(points, shift)
        for link, points in dots_of(body).items()
    }
    return {**extra, **joined_fields(extra, dots)}
