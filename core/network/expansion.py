"""Writing macros out: the plain network that a network with macros stands for.

Whatever computes works on the plain network: a node inside of ``camera`` is called ``camera/blur``
there, in expressions too; wires go from inner node to inner node, and of the macros nothing is left
but other names for their ports and parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from core.expressions.grammar import rewritten
from core.modules.library_type import Library
from core.network.interface import End, text
from core.network.macro import SEPARATOR, face_of_macro, opened, passing_input, under
from core.network.network import EXPRESSION, Link, Network, Node


def expanded(network: Network, library: Library) -> Network:
    """The plain network; a network without macros is given back as it is.

    What a macro's fields name that is not there is left out: `core.network.validation` finds it.

    Parameters
    ----------
    network : Network
        The document.
    library : mapping
        Modules by key: a disabled macro passes on by the types of its ports.
    """
    if not has_macros(network):
        return network
    level = _level(network, library)
    sources = {end: level.source(end) for end in level.outputs}
    ports = {text(end): text(source) for end, source in sources.items() if source != ("", "")}
    return Network(
        name=network.name,
        description=network.description,
        seed=network.seed,
        nodes=level.nodes,
        links=tuple(level.links),
        layout={name: at for name, at in network.layout.items() if name in level.nodes},
        extra=_with_final(network.extra, ports),
        port_names=ports,
        parameter_names={text(end): text(inner) for end, inner in level.parameters.items()},
        aside=level.aside,
    )


def has_macros(network: Network) -> bool:
    """Whether a node of the network is a macro."""
    return any(node.macro is not None for node in network.nodes.values())


def unfolded(network: Network) -> Network:
    """The network with the nodes inside of macros beside them, for what shows and edits them all.

    Links inside come along. The macros stay, and expressions are as they were written inside, so
    this is no network to compute.
    """
    if not has_macros(network):
        return network
    nodes = dict(_all_nodes(network.nodes.values()))
    links = [*network.links, *_inner_links(network)]
    return replace(network, nodes=nodes, links=tuple(links))


def _all_nodes(nodes: Any) -> Iterator[tuple[str, Node]]:
    for node in nodes:
        yield node.id, node
        if node.macro is not None:
            yield from _all_nodes(under(node, inner) for inner in opened(node).nodes.values())


def _inner_links(network: Network, prefix: str = "") -> Iterator[Link]:
    for name, node in network.nodes.items():
        if node.macro is not None:
            here = f"{prefix}{name}{SEPARATOR}"
            yield from (_prefixed(link, here) for link in node.macro.links)
            yield from _inner_links(node.macro, here)


def _prefixed(link: Link, prefix: str) -> Link:
    return Link(prefix + link.source, link.output, prefix + link.target, link.input)


@dataclass
class _Level:
    """A network with its macros written out, and what their ports stand for."""

    nodes: dict[str, Node] = field(default_factory=dict)
    links: list[Link] = field(default_factory=list)
    inputs: dict[End, tuple[End, ...]] = field(default_factory=dict)
    outputs: dict[End, End] = field(default_factory=dict)
    parameters: dict[End, End] = field(default_factory=dict)
    aside: dict[str, Node] = field(default_factory=dict)

    def source(self, end: End) -> End:
        """The output of a plain node that an output stands for; an empty end where it has none."""
        seen = set()
        while end in self.outputs and end not in seen:
            seen.add(end)
            end = self.outputs[end]
        return end if end not in self.outputs and end[0] in self.nodes else ("", "")

    def targets(self, end: End) -> tuple[End, ...]:
        """The inputs of plain nodes that an input stands for."""
        itself = (end,) if end[0] in self.nodes else ()
        return self.inputs.get(end, itself)


def _level(network: Network, library: Library) -> _Level:
    level = _Level()
    for name, node in network.nodes.items():
        if node.macro is None:
            level.nodes[name] = node
        elif node.disabled:
            _add_disabled(level, network, node, library)
        else:
            _add_macro(level, node, library)
    for link in network.links:
        source = level.source((link.source, link.output))
        if source == ("", ""):
            if link.source in network.nodes:
                continue
            source = link.source, link.output  # of no node: that is reported as it stands
        end = (link.target, link.input)
        for target in level.targets(end) if link.target in network.nodes else (end,):
            level.links.append(Link(*source, *target))
    return level


def _add_macro(level: _Level, node: Node, library: Library) -> None:
    body = opened(node, linked=False)
    face, inside = face_of_macro(body), _level(body, library)

    def outer(end: End) -> End:
        return f"{node.id}{SEPARATOR}{end[0]}", end[1]

    prefix = f"{node.id}{SEPARATOR}"
    for inner in inside.nodes.values():
        plain = _within(node, inner)
        level.nodes[plain.id] = plain
    level.links += [_prefixed(link, prefix) for link in inside.links]
    for name, ends in face.inputs.items():
        level.inputs[node.id, name] = tuple(
            outer(target) for end in ends for target in inside.targets(end)
        )
    for name, end in face.outputs.items():
        if (source := inside.source(end)) != ("", ""):
            level.outputs[node.id, name] = outer(source)
    for end in inside.outputs:  # names of macros inside stay names
        if (source := inside.source(end)) != ("", ""):
            level.outputs[outer(end)] = outer(source)
    _add_parameters(level, node, inside)


def _add_parameters(level: _Level, node: Node, inside: _Level) -> None:
    """What a macro's parameters stand for; its expressions name what lies around it."""

    def outer(end: End) -> End:
        return f"{node.id}{SEPARATOR}{end[0]}", end[1]

    for inner in inside.aside.values():
        plain = _within(node, inner)
        level.aside[plain.id] = plain
    for name, end in face_of_macro(opened(node)).parameters.items():
        level.parameters[node.id, name] = outer(inside.parameters.get(end, end))
    for end, behind in inside.parameters.items():
        level.parameters[outer(end)] = outer(behind)
    for name in node.linked:
        place, parameter = level.parameters.get((node.id, name), ("", ""))
        for nodes in (level.nodes, level.aside):
            if place in nodes:
                params = {**nodes[place].params, parameter: node.params[name]}
                nodes[place] = replace(nodes[place], params=params)


def _within(macro: Node, inner: Node) -> Node:
    """A node of a macro's inside as `under` has it, with the names in its expressions changed too.

    The same object each time.
    """
    plain = under(macro, inner)
    if not plain.linked:
        return plain
    made: dict[str, Node] = vars(plain).setdefault("_within", {})
    if macro.id not in made:

        def moved(node: str, parameter: str) -> End:
            return f"{macro.id}{SEPARATOR}{node}", parameter

        expressions = {}
        for name in plain.linked:
            raw = plain.params[name]
            if isinstance(raw[EXPRESSION], str):
                text = rewritten(raw[EXPRESSION], moved, refuse_long=False)
                expressions[name] = {**raw, EXPRESSION: text}
        made[macro.id] = replace(plain, params={**plain.params, **expressions})
    return made[macro.id]


def _add_disabled(level: _Level, network: Network, node: Node, library: Library) -> None:
    """A disabled macro is gone, and what would come out of it is what goes in."""
    inside = _level(opened(node, linked=False), library)
    inside.aside |= inside.nodes
    _add_parameters(level, node, inside)
    feeding: Mapping[str, Link] = {link.input: link for link in network.links_into(node.id)}
    for name in face_of_macro(opened(node)).outputs:
        link = feeding.get(passing_input(node, name, library) or "")
        level.outputs[node.id, name] = (link.source, link.output) if link else ("", "")
    for name in face_of_macro(opened(node)).inputs:
        level.inputs[node.id, name] = ()


def _with_final(extra: Mapping[str, Any], ports: Mapping[str, str]) -> Mapping[str, Any]:
    final = extra.get("final")
    if isinstance(final, str) and final in ports:
        return {**extra, "final": ports[final]}
    return extra
