"""Making one node of several, a macro, and several of one again; the picture stays the same."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from core.editing.backdrops import FIELD as BACKDROPS
from core.editing.backdrops import backdrops_of
from core.editing.layout import Point
from core.editing.macros import with_moved_names, with_names_or_refused
from core.editing.operations import Operation, fresh_name, named
from core.editing.references import of_nodes, renamed, without_dots
from core.editing.wire_dots import dots_among, dots_of, joined_fields, shifted
from core.errors import NetworkError
from core.modules.declaration import Library
from core.names import shown, thaw
from core.network.expression_grammar import ExpressionError
from core.network.linked_values import named_nodes, new_name, resolved, with_references
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


def inputs_of(
    network: Network, library: Library, members: tuple[str, ...], around: Interface
) -> dict[str, tuple[End, ...]]:
    """Inputs of the macro: one for each output outside that feeds it, then those without a wire."""
    fed: dict[End, list[End]] = {}
    for name, named_ends in around.inputs.items():
        if inner := [end for end in named_ends if end[0] in members]:
            fed["", name] = inner
    for link in sorted(network.links, key=_place(network, members, "target")):
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


def outputs_of(
    network: Network, library: Library, members: tuple[str, ...], around: Interface
) -> dict[str, End]:
    """Outputs of the macro: those that feed nodes outside, then the first of nodes that end it."""
    ends = {end: None for end in around.outputs.values() if end[0] in members}
    for link in sorted(network.links, key=_place(network, members, "source")):
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


def _place(network: Network, members: tuple[str, ...], side: str) -> Callable[[Link], Any]:
    place = {name: number for number, name in enumerate(network.nodes) if name in members}

    def of(link: Link) -> tuple[int, Link]:
        return place.get(getattr(link, side), len(place)), link

    return of


def outer_links(
    network: Network, macro: str, inner: Mapping[str, Node], face: Interface
) -> tuple[Link, ...]:
    """The links of the network with a macro in the place of the nodes."""
    entry = {end: name for name, ends in face.inputs.items() for end in ends}
    exit_of = {end: name for name, end in face.outputs.items()}
    links: dict[Link, None] = {}
    for link in network.links:
        start, end = (link.source, link.output), (link.target, link.input)
        if link.source in inner and link.target in inner:
            continue
        if link.source in inner:
            start = macro, exit_of[start]
        if link.target in inner:
            end = macro, entry[end]
        links[Link(*start, *end)] = None
    return tuple(links)


def inner_links(
    network: Network, macro: str, body: Network, names: Mapping[str, str]
) -> tuple[Link, ...]:
    """The links of the network with the nodes of a macro in its place."""
    face = face_of_macro(body)
    links = [
        replace(link, source=names[link.source], target=names[link.target]) for link in body.links
    ]
    for link in network.links:
        starts: tuple[End, ...] = ((link.source, link.output),)
        ends: tuple[End, ...] = ((link.target, link.input),)
        if link.source == macro:
            end = face.outputs.get(link.output)
            starts = () if end is None else ((names[end[0]], end[1]),)
        if link.target == macro:
            ends = tuple((names[name], port) for name, port in face.inputs.get(link.input, ()))
        links += [Link(*start, *end) for start in starts for end in ends]
    return tuple(links)


def with_macro_shown(around: Interface, macro: str, face: Interface) -> Interface:
    """What the macro around shows, with a macro in the place of nodes inside of it."""
    entry = {end: name for name, ends in face.inputs.items() for end in ends}
    exits = {end: name for name, end in face.outputs.items()}
    shown_as = {end: name for name, end in face.parameters.items()}

    def moved(end: End, names: Mapping[End, str]) -> End:
        return (macro, names[end]) if end in names else end

    return Interface(
        {
            name: tuple(dict.fromkeys(moved(end, entry) for end in ends))
            for name, ends in around.inputs.items()
        },
        {name: moved(end, exits) for name, end in around.outputs.items()},
        {name: moved(end, shown_as) for name, end in around.parameters.items()},
    )


def with_inside_shown(
    around: Interface, macro: str, body: Network, names: Mapping[str, str]
) -> Interface:
    """What the macro around shows, with the nodes of a macro in its place."""
    face = face_of_macro(body)

    def inner(end: End, ends: Mapping[str, End]) -> tuple[End, ...]:
        if end[0] != macro:
            return (end,)
        behind = ends.get(end[1])
        return () if behind is None else ((names[behind[0]], behind[1]),)

    inputs = {}
    for name, ends in around.inputs.items():
        several: list[End] = []
        for end in ends:
            behind = face.inputs.get(end[1], ())
            own = [(names[node], port) for node, port in behind]
            several += own if end[0] == macro else [end]
        if several:
            inputs[name] = tuple(several)
    outputs, parameters = (
        {name: ends[0] for name, end in entries.items() if (ends := inner(end, shown_ends))}
        for entries, shown_ends in (
            (around.outputs, face.outputs),
            (around.parameters, face.parameters),
        )
    )
    return Interface(inputs, outputs, parameters)


def with_lifted(
    network: Network, members: Collection[str], parameters: Mapping[str, End]
) -> dict[str, End]:
    """Parameters for a macro of these nodes to show: also those that follow nodes outside of it.

    From inside of a macro nothing outside can be named: such an expression becomes one of the
    macro's own parameter.
    """
    shown_ends = dict(parameters)
    for name in members:
        for parameter, leaders in named_nodes(network.nodes[name]).items():
            outside = any(not _lies_in(leader, members) for leader in leaders)
            if outside and (name, parameter) not in shown_ends.values():
                shown_ends[fresh_name(parameter, shown_ends)] = (name, parameter)
    return shown_ends


def expressions_for_macro(
    members: Mapping[str, Node], face: Interface, names: Mapping[str, str]
) -> dict[str, Any]:
    """The expressions that a macro's own parameters take over from the nodes inside of it.

    Parameters
    ----------
    members : mapping
        The nodes by id, as they were.
    face : Interface
        What the macro shows.
    names : mapping of str to str
        What the nodes are called from now on.
    """
    params = {}
    for name, (inner, parameter) in face.parameters.items():
        leaders = named_nodes(members[inner]).get(parameter, frozenset())
        if any(not _lies_in(leader, members) for leader in leaders):
            params[name] = with_names_or_refused(members[inner], names).params[parameter]
    return params


def inside_of_macro(
    node: Node, face: Interface, lifted: Collection[str], values: Mapping[str, Any]
) -> Node:
    """A node that goes into a macro, without the expressions that the macro has taken over.

    Parameters
    ----------
    node : Node
        The node.
    face : Interface
        What the macro shows.
    lifted : collection of str
        Those of the macro's parameters that have taken over an expression.
    values : mapping
        By parameter of the macro: the value that the inner one has from then on.
    """
    params = dict(node.params)
    for name in lifted:
        inner, parameter = face.parameters[name]
        if inner == node.id:
            del params[parameter]
            if name in values:
                params[parameter] = values[name]
    return node if params == node.params else replace(node, params=params)


def values_of_lifted(
    parameters: Mapping[str, End], value_of: Callable[[str, str], Any]
) -> dict[str, Any]:
    """The present values of parameters, by the name that the macro shows them under."""
    values = {name: thaw(value_of(*end)) for name, end in parameters.items()}
    return {
        name: value
        for name, value in values.items()
        if value is not None and not (isinstance(value, dict) and EXPRESSION in value)
    }


def after_ungrouping(
    node: Node, macro: str, face: Interface, names: Mapping[str, str], moved: Mapping[str, str]
) -> Node:
    """A node whose expressions name the nodes that lay in a macro, no longer the macro.

    Parameters
    ----------
    node : Node
        A node around the macro.
    macro : str
        The macro's id.
    face : Interface
        What it showed.
    names : mapping of str to str
        What the nodes inside are called from now on, by their own ids.
    moved : mapping of str to str
        The same by their whole names, and those of nodes inside of them.

    Raises
    ------
    NetworkError
        If an expression would become too long.
    """

    def instead(leader: str, parameter: str) -> End:
        end = face.parameters.get(parameter) if leader == macro else None
        if end is not None:
            return names[end[0]], end[1]
        return new_name(leader, moved), parameter

    try:
        return with_references(node, instead)
    except ExpressionError as error:
        raise NetworkError(error.message) from None


def _lies_in(name: str, members: Collection[str]) -> bool:
    return name in members or new_name(name, dict.fromkeys(members, "")) != name
