"""Making one node of several, a macro, and several of one again; the picture stays the same."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from core.editing.backdrops import FIELD as BACKDROPS
from core.editing.backdrops import backdrops_of
from core.editing.layout import Point
from core.editing.operations import Operation, fresh_name, named
from core.editing.references import of_nodes, renamed, without_dots
from core.editing.wire_dots import dots_among, dots_of, joined_fields, shifted
from core.errors import NetworkError
from core.modules.declaration import Library
from core.names import shown, thaw
from core.network.linked_values import (
    named_nodes,
    new_name,
    resolved,
    with_names,
    with_references,
)
from core.network.macro import (
    SEPARATOR,
    End,
    Interface,
    checked_depth,
    declared_node,
    depth,
    face_of_macro,
    opened,
    unfolded,
    with_face,
)
from core.network.network import EXPRESSION, MACRO, Link, Network, Node, cycle_error, cycles


@dataclass(frozen=True)
class Group(Operation):
    """Put nodes into a new macro with this face.

    What draws noise among them and inside of them, `noisy`, draws the same afterwards. `values`
    has, by parameter of the macro that takes over an expression, the value inside from then on.
    `where` are the macros this happens in, as ``camera/``; empty in the network itself.
    """

    name: str
    members: tuple[str, ...]
    face: Interface
    noisy: frozenset[str] = frozenset()
    values: Mapping[str, Any] = field(default_factory=dict)
    where: str = ""

    def _usual_text(self) -> str:
        return f"Group {named(self.members)}"

    def apply(self, network: Network) -> Network:
        """The network with the macro in their place."""
        inner = {name: network.node(name) for name in self.members}
        if self.name in network.nodes and self.name not in inner:
            raise NetworkError(f"there is a node {shown(self.name)} already")
        moved = self.moved(network)
        lifted = {
            name: with_names(inner[node], moved).params[parameter]
            for name, (node, parameter) in self.face.parameters.items()
            if _follows_others(inner[node], parameter, inner)
        }
        body = Network(
            nodes={
                name: self._member(node, lifted)
                for name, node in network.nodes.items()
                if name in inner
            },
            links=tuple(
                link for link in network.links if {link.source, link.target} <= inner.keys()
            ),
            layout={name: at for name, at in network.layout.items() if name in inner},
            extra={**self.face.fields(), **joined_fields({}, dots_among(network, inner))},
        )
        checked_depth(1 + depth(body), self.name)
        nodes: dict[str, Node] = {}
        for name, node in network.nodes.items():
            if name not in inner:
                nodes[name] = with_names(node, moved)
            elif self.name not in nodes:
                nodes[self.name] = Node(self.name, MACRO, params=lifted, macro=body)
        layout = {name: at for name, at in network.layout.items() if name not in inner}
        if body.layout:
            layout[self.name] = _middle(body.layout)
        changed = replace(
            network,
            nodes=nodes,
            links=self._links(network),
            layout=layout,
            extra=_with_moved(without_dots(network.extra, _links_at(network, inner)), moved),
        )
        around = face_of_macro(network)
        if around != Interface():
            changed = with_face(changed, self._shown_in(around))
        loops = cycles(changed.followers)
        if loops and not cycles(network.followers):
            raise cycle_error(loops[0])
        return changed

    def moved(self, network: Network) -> dict[str, str]:
        """The names of the nodes, which lie in the macro now."""
        names = of_nodes(self.members, network.nodes)
        return {name: f"{self.name}{SEPARATOR}{name}" for name in names}

    def _member(self, node: Node, lifted: Collection[str]) -> Node:
        """A node inside, without the expressions that the macro has taken over."""
        params = dict(node.params)
        for name in lifted:
            inner, parameter = self.face.parameters[name]
            if inner == node.id:
                del params[parameter]
                if name in self.values:
                    params[parameter] = self.values[name]
        if params != node.params:
            node = replace(node, params=params)
        return _with_noise(node, self.where + node.id, self.noisy)

    def _links(self, network: Network) -> tuple[Link, ...]:
        """The links with the macro in the place of the nodes; of several that become one, one."""
        entry = {end: name for name, ends in self.face.inputs.items() for end in ends}
        exits = {end: name for name, end in self.face.outputs.items()}
        links: dict[Link, None] = {}
        for link in network.links:
            start, end = (link.source, link.output), (link.target, link.input)
            if link.source in self.members and link.target in self.members:
                continue
            if link.source in self.members:
                start = self.name, exits[start]
            if link.target in self.members:
                end = self.name, entry[end]
            links[Link(*start, *end)] = None
        return tuple(links)

    def _shown_in(self, around: Interface) -> Interface:
        """What the macro around shows, with the new one in the place of the nodes."""
        names = [
            {end: name for name, ends in self.face.inputs.items() for end in ends},
            *(
                {end: name for name, end in ends.items()}
                for ends in (self.face.outputs, self.face.parameters)
            ),
        ]

        def moved(of: Mapping[End, str]) -> Callable[[End], tuple[End]]:
            return lambda end: ((self.name, of[end]) if end in of else end,)

        face = around.mapped(*map(moved, names))
        return replace(face, inputs={n: tuple(dict.fromkeys(e)) for n, e in face.inputs.items()})


@dataclass(frozen=True)
class Ungroup(Operation):
    """Put the nodes of a macro in its place, called as `fresh` says; the rest as for `Group`."""

    name: str
    fresh: Mapping[str, str]
    noisy: frozenset[str] = frozenset()
    where: str = ""

    def _usual_text(self) -> str:
        return f"Ungroup {self.name}"

    def apply(self, network: Network) -> Network:
        """The network with the nodes."""
        body = opened(_macro(network, self.name), linked=False)
        for name in self.fresh.values():
            if name in network.nodes and name != self.name:
                raise NetworkError(f"there is a node {shown(name)} already")
        moved = self.moved(network)
        face, around = face_of_macro(body), face_of_macro(network)

        def instead(leader: str, parameter: str) -> End:
            end = face.parameters.get(parameter) if leader == self.name else None
            return (new_name(leader, moved), parameter) if end is None else self._inner(end)

        nodes: dict[str, Node] = {}
        for name, node in network.nodes.items():
            other = with_references(node, instead)
            nodes |= self._nodes(other, body, face) if name == self.name else {name: other}
        x, y = _shift(network, self.name, body)
        layout = {name: at for name, at in network.layout.items() if name != self.name}
        for name, at in body.layout.items():
            if name in body.nodes:
                layout[self.fresh[name]] = at[0] + x, at[1] + y
        extra = _with_moved(without_dots(network.extra, _links_at(network, {self.name})), moved)
        if backdrops_of(body):
            extra[BACKDROPS] = [
                *thaw(network.extra.get(BACKDROPS, [])),
                *(
                    {**entry, "x": entry["x"] + x, "y": entry["y"] + y}
                    for entry in thaw(body.extra[BACKDROPS])
                    if isinstance(entry, dict) and {"x", "y"} <= entry.keys()
                ),
            ]
        dots = {
            link.renamed(self.fresh): shifted(points, (x, y))
            for link, points in dots_of(body).items()
        }
        extra |= joined_fields(extra, dots)
        links = self._links(network, body, face)
        changed = replace(network, nodes=nodes, links=links, layout=layout, extra=extra)
        return (
            changed if around == Interface() else with_face(changed, self._shown_in(around, face))
        )

    def moved(self, network: Network) -> dict[str, str]:
        """The names of the nodes, which lie in the macro no more."""
        body = network.node(self.name).macro or Network()
        return {
            f"{self.name}{SEPARATOR}{name}": self.fresh[inner] + name.removeprefix(inner)
            for inner in body.nodes
            for name in of_nodes([inner], body.nodes)
        }

    def _inner(self, end: End) -> End:
        return self.fresh[end[0]], end[1]

    def _nodes(self, macro: Node, body: Network, face: Interface) -> dict[str, Node]:
        """The nodes inside as they stand outside, with the values that the macro gave them."""
        inner = {name: with_names(node, self.fresh) for name, node in body.nodes.items()}
        for name, (own, parameter) in face.parameters.items():
            if name in macro.linked and own in inner:
                params = {**inner[own].params, parameter: macro.params[name]}
                inner[own] = replace(inner[own], params=params)
        nodes = {}
        for name, node in inner.items():
            fresh = self.fresh[name]
            auto = node.auto if macro.auto is None else macro.auto
            outer = f"{self.where}{self.name}{SEPARATOR}{name}"
            plain = _with_noise(replace(node, id=fresh, auto=auto), outer, self.noisy)
            nodes[fresh] = _without_own(plain, self.where + fresh)
        return nodes

    def _links(self, network: Network, body: Network, face: Interface) -> tuple[Link, ...]:
        """The links with the nodes in the macro's place."""
        links = [link.renamed(self.fresh) for link in body.links]
        for link in network.links:
            starts: tuple[End, ...] = ((link.source, link.output),)
            ends: tuple[End, ...] = ((link.target, link.input),)
            if link.source == self.name:
                end = face.outputs.get(link.output)
                starts = () if end is None else (self._inner(end),)
            if link.target == self.name:
                ends = tuple(map(self._inner, face.inputs.get(link.input, ())))
            links += [Link(*start, *end) for start in starts for end in ends]
        return tuple(links)

    def _shown_in(self, around: Interface, face: Interface) -> Interface:
        """What the macro around shows, with the nodes in the place of this one."""

        def behind(of: Mapping[str, Iterable[End]]) -> Callable[[End], Iterable[End]]:
            return lambda end: (
                map(self._inner, of.get(end[1], ())) if end[0] == self.name else (end,)
            )

        outputs, parameters = (
            {name: (end,) for name, end in ends.items()} for ends in (face.outputs, face.parameters)
        )
        return around.mapped(behind(face.inputs), behind(outputs), behind(parameters))


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

    Raises `NetworkError` if there is no such node, or a way leaves the nodes and comes back.
    """
    members = tuple(dict.fromkeys(names))
    if not members:
        raise NetworkError("select the nodes that are to be grouped first")
    for member in members:
        network.node(member)
    fresh = fresh_name(name, set(network.nodes) - set(members))
    around = face_of_macro(network)
    parameters: dict[str, End] = {}
    for end in around.parameters.values():
        if end[0] in members:
            parameters[fresh_name(end[1], parameters)] = end
    # From inside of a macro nothing outside can be named: such an expression becomes one of the
    # macro's own parameter.
    for member in members:
        node = network.nodes[member]
        for parameter in node.linked:
            end = member, parameter
            if _follows_others(node, parameter, members) and end not in parameters.values():
                parameters[fresh_name(parameter, parameters)] = end
    inputs = _inputs_of(network, library, members, around)
    face = Interface(inputs, _outputs_of(network, library, members, around), parameters)
    value_of = value_of or resolved(network, library=library).value
    given = {name: thaw(value_of(*end)) for name, end in parameters.items()}
    values = {
        name: value
        for name, value in given.items()
        if value is not None and not (isinstance(value, dict) and EXPRESSION in value)
    }
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

    Raises `NetworkError` if there is no such macro, or it is disabled.
    """
    node = _macro(network, name)
    if node.disabled:
        raise NetworkError(f"{shown(name)} is disabled: enable it, then ungroup it")
    taken = set(network.nodes) - {name}
    body, fresh = node.macro or Network(), {}
    for inner in body.nodes:
        fresh[inner] = fresh_name(inner, taken)
        taken.add(fresh[inner])
    noisy = _noisy(body, library, body.nodes, f"{where}{name}{SEPARATOR}")
    return tuple(fresh.values()), Ungroup(name, fresh, noisy, where)


def _macro(network: Network, name: str) -> Node:
    node = network.node(name)
    if node.macro is None:
        raise NetworkError(f"{shown(name)} is no macro: there is nothing to ungroup")
    return node


def _follows_others(node: Node, parameter: str, members: Collection[str]) -> bool:
    """Whether a parameter has an expression that names what is no member, nor inside of one."""
    inside = dict.fromkeys(members, "")
    leaders = named_nodes(node).get(parameter, frozenset())
    return any(leader not in members and new_name(leader, inside) == leader for leader in leaders)


def _noisy(network: Network, library: Library, names: Iterable[str], where: str) -> frozenset[str]:
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


def _middle(layout: Mapping[str, Point]) -> Point:
    xs, ys = zip(*layout.values(), strict=True)
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2


def _shift(network: Network, macro: str, body: Network) -> Point:
    """How far a macro has been moved since it stood in the middle of its nodes."""
    if not body.layout or macro not in network.layout:
        return 0.0, 0.0
    middle, at = _middle(body.layout), network.layout[macro]
    return at[0] - middle[0], at[1] - middle[1]


def _with_moved(extra: Mapping[str, Any], moved: Mapping[str, str]) -> dict[str, Any]:
    """A network's fields with the nodes' new names."""
    for old, new in moved.items():
        extra = renamed(extra, old, new)
    return dict(extra)


def _links_at(network: Network, names: Collection[str]) -> set[Link]:
    return {link for link in network.links if link.source in names or link.target in names}


def _inputs_of(
    network: Network, library: Library, members: tuple[str, ...], around: Interface
) -> dict[str, tuple[End, ...]]:
    """Inputs of the macro: one for each output outside that feeds it, then those without a wire."""
    fed: dict[End, list[End]] = {}
    for name, named_ends in around.inputs.items():
        if inner := [end for end in named_ends if end[0] in members]:
            fed["", name] = inner
    place = _places(network, members)
    for link in sorted(network.links, key=lambda link: (place[link.target], link)):
        if link.target in members and link.source not in members:
            fed.setdefault((link.source, link.output), []).append((link.target, link.input))
    inputs: dict[str, tuple[End, ...]] = {}
    for ends in fed.values():
        inputs[fresh_name(ends[0][1], inputs)] = tuple(ends)
    linked = {(link.target, link.input) for link in network.links}
    linked |= {end for ends in inputs.values() for end in ends}
    for name in members:
        declared = declared_node(network.nodes[name], library)
        for port in declared.inputs if declared else ():
            if port.required and (name, port.name) not in linked:
                inputs[fresh_name(port.name, inputs)] = ((name, port.name),)
    return inputs


def _outputs_of(
    network: Network, library: Library, members: tuple[str, ...], around: Interface
) -> dict[str, End]:
    """Outputs of the macro: those that feed nodes outside, then the first of nodes that end it."""
    ends = {end: None for end in around.outputs.values() if end[0] in members}
    place = _places(network, members)
    for link in sorted(network.links, key=lambda link: (place[link.source], link)):
        if link.source in members and link.target not in members:
            ends[link.source, link.output] = None
    leading_on = {link.source for link in network.links}
    for name in members:
        declared = declared_node(network.nodes[name], library)
        if name not in leading_on and declared is not None and declared.outputs:
            ends[name, declared.outputs[0].name] = None
    outputs: dict[str, End] = {}
    for end in ends:
        outputs[fresh_name(end[1], outputs)] = end
    return outputs


def _places(network: Network, members: Collection[str]) -> Mapping[str, int]:
    """Places in the document's order; all others come last."""
    last = len(members)
    order = (name for name in network.nodes if name in members)
    return defaultdict(lambda: last, {name: number for number, name in enumerate(order)})
