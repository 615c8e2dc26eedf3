"""Links: why one cannot be made, in one line, and which ways they lead."""

from collections import Counter

from core.errors import NetworkError
from core.modules.declaration import Declaration, Library, Port
from core.names import close, shown
from core.network.macro import declared_node
from core.network.network import Link, Network, cycle_error, cycles, way_round


def refusal(network: Network, library: Library, link: Link) -> str | None:
    """Why `link` cannot be made; None where it can."""
    wrong = misfit(network, library, link)
    if wrong is not None:
        return wrong
    way = way_between(network, link.target, link.source)
    if way is None:
        return None
    return f"this link would make a cycle: {way_round(way)}"


def misfit(network: Network, library: Library, link: Link) -> str | None:
    """Why the ends of a link do not fit each other; None where they do, even in a cycle."""
    for name in (link.source, link.target):
        if name not in network.nodes:
            return f"there is no node {shown(name)}{close(name, network.nodes)}"
    if link.source == link.target:
        return f"{shown(link.source)} cannot feed itself"
    giving, taking = (declared(network, library, end) for end in (link.source, link.target))
    output = giving.output(link.output) if giving else None
    entry = taking.input(link.input) if taking else None
    if giving and output is None:
        return _no_port(link.source, "output", link.output, giving.outputs)
    if taking and entry is None:
        return _no_port(link.target, "input", link.input, taking.inputs)
    if output and entry and not set(output.types) & set(entry.types):
        start, end = link.text()
        gives, takes = (" or ".join(port.types) for port in (output, entry))
        return f"{shown(start)} gives {gives}, but {shown(end)} takes {takes}"
    return None


def check_new_wires(before: Network, after: Network, library: Library) -> None:
    """Refuse a change that brings links no network may have."""
    for name, node in after.nodes.items():
        former = before.nodes.get(name)
        if node.macro is not None and node is not former:
            inside = (former.macro if former is not None else None) or Network()
            try:
                check_new_wires(inside, node.macro, library)
            except NetworkError as error:
                raise NetworkError(f"inside {shown(name)}: {error.message}") from None
    old = set(before.links)
    new = [link for link in after.links if link not in old]
    if not new:
        return
    for link in new:
        wrong = misfit(after, library, link)
        if wrong is not None:
            raise NetworkError(wrong)
    count = Counter((link.target, link.input) for link in after.links)
    for link in new:
        if count[link.target, link.input] > 1:
            raise NetworkError(f"{shown(link.text()[1])} would have more than one link")
    loops = cycles(after.followers)
    if loops and not cycles(before.followers):
        raise cycle_error(loops[0])


def way_between(network: Network, start: str, end: str) -> tuple[str, ...] | None:
    """The shortest way along links from one node to another, both included."""
    came_from = {start: start}
    for name in (border := [start]):
        fresh = [one for one in network.followers[name] if one not in came_from]
        came_from |= dict.fromkeys(fresh, name)
        border += fresh
    if end not in came_from:
        return None
    way = [end]
    while way[-1] != start:
        way.append(came_from[way[-1]])
    return tuple(reversed(way))


def declared(network: Network, library: Library, name: str) -> Declaration | None:
    """The declaration of a node's module; None of an unknown module or node."""
    node = network.nodes.get(name)
    return declared_node(node, library) if node is not None else None


def _no_port(node: str, side: str, port: str, ports: tuple[Port, ...]) -> str:
    names = [candidate.name for candidate in ports]
    listed = f"it has {', '.join(names)}" if names else "it has none"
    return f"{shown(node)} has no {side} {shown(port)}{close(port, names) or f': {listed}'}"
