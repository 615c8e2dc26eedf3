"""Which wires a module needs beside the one a person draws: its context, pupil, magnitude, phase.

Only what is beyond doubt is found: one context or pupil there is, one wire that runs beside.
"""

from __future__ import annotations

from collections.abc import Iterable

from core.editing.links import declared, reached_from
from core.modules.declaration import Declaration, Port
from core.modules.library_type import Library
from core.network.network import Link, Network

End = tuple[str, str]
"""Node and port."""

MAGNITUDE, PHASE = "magnitude", "phase"
PARTNER = {MAGNITUDE: PHASE, PHASE: MAGNITUDE}
_FEW = ("context", "pupil")  # of these a network has few, and every module takes the same


def outputs_of(network: Network, library: Library, kind: str) -> list[End]:
    """Every output that gives values of a type."""
    return [
        (name, port.name)
        for name in network.nodes
        if (module := declared(network, library, name)) is not None
        for port in module.outputs
        if kind in port.types
    ]


def side_links(
    network: Network,
    library: Library,
    node: str,
    taken: Iterable[str],
    followers: Iterable[str] = (),
) -> list[Link]:
    """Links for the node's empty context and pupil inputs, where there is one candidate.

    Parameters
    ----------
    network, library
        Where it stands.
    node : str
        The node.
    taken : iterable of str
        Inputs that are not empty.
    followers : iterable of str
        Nodes that it feeds, or will: what comes after them is no candidate.
    """
    module = declared(network, library, node)
    if module is None:
        return []
    behind = reached_from(network, {node, *followers})
    links = []
    for port in module.inputs:
        if port.name in taken or not port.required or port.types[0] not in _FEW:
            continue
        every = outputs_of(network, library, port.types[0])
        sources = [end for end in every if end[0] != node]
        if len(sources) == 1 and sources[0][0] not in behind:
            links.append(Link(*sources[0], node, port.name))
    return links


def port_of(ports: Iterable[Port], kind: str) -> Port | None:
    """The first port of a type."""
    return next((port for port in ports if kind in port.types), None)


def wire_beside(network: Network, library: Library, link: Link, kind: str) -> Link | None:
    """The one wire of a type that runs beside a link: from the same node, or to the same.

    Of several, the one that does both.
    """
    candidates = [
        other
        for other in network.links
        if other != link
        and (other.source == link.source or other.target == link.target)
        and kind in _types(network, library, other)
    ]
    if len(candidates) > 1:
        candidates = [other for other in candidates if (other.source, other.target) == _nodes(link)]
    return candidates[0] if len(candidates) == 1 else None


def end_beside(network: Network, library: Library, end: End, kind: str) -> End | None:
    """The output of type `kind` that travels beside the loose output `end` of its partner type.

    Either the same node has one; or it is the open end of the wire that left the node further up
    where both were last together.
    """
    own = PARTNER[kind]
    name: str | None = end[0]
    seen: set[str] = set()
    while name is not None and name not in seen:
        seen.add(name)
        module = declared(network, library, name)
        if module is None:
            return None
        ports = [port for port in module.outputs if kind in port.types]
        if len(ports) == 1:
            start = (name, ports[0].name)
            return start if name == end[0] else _open_end(network, library, start, kind)
        if ports:
            return None
        name = _source(network, module, name, own)
    return None


def _source(network: Network, module: Declaration, name: str, kind: str) -> str | None:
    """The node a module's input of a type is linked from."""
    port = port_of(module.inputs, kind)
    links = network.links_into(name)
    return next((link.source for link in links if port and link.input == port.name), None)


def _open_end(network: Network, library: Library, start: End, kind: str) -> End | None:
    """Follow a wire of a type through the modules that pass it on, to the last one."""
    end: End | None = start
    while end is not None:
        onward = []
        for link in network.links:
            if (link.source, link.output) == end:
                module = declared(network, library, link.target)
                port = port_of(module.outputs, kind) if module else None
                if port is not None:
                    onward.append((link.target, port.name))
        if not onward:
            return end
        end = onward[0] if len(onward) == 1 else None
    return None


def _types(network: Network, library: Library, link: Link) -> tuple[str, ...]:
    """What a link brings, as its source has it; else as its target takes it."""
    source, target = (declared(network, library, name) for name in _nodes(link))
    port = source.output(link.output) if source else None
    if port is None and target:
        port = target.input(link.input)
    return port.types if port else ()


def _nodes(link: Link) -> tuple[str, str]:
    return link.source, link.target
