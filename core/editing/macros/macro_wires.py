"""The wires and ports at a macro: those a group of nodes needs, and where they lead inside."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from core.editing.nodes import fresh_name
from core.modules.library_type import Library
from core.network.interface import End, Interface
from core.network.macro import declared_node, face_of_macro
from core.network.network import Link, Network, Node


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
