"""What fits: whether a link can be made, where a loose wire could lead to, and adding that."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from core.editing.layout.boxes import Point
from core.editing.links import Rewire, check_new_wires, declared, misfit, reached_from, refusal
from core.editing.nodes import Add, Placed, fresh_name
from core.editing.operation import Operation, Together
from core.editing.wiring.inserting import inserted
from core.editing.wiring.partners import (
    MAGNITUDE,
    PARTNER,
    PHASE,
    end_beside,
    outputs_of,
    port_of,
    side_links,
)
from core.errors import NetworkError
from core.modules.declaration import Declaration, declaration
from core.modules.library_type import Library, local_key, where_absent
from core.names import close, shown
from core.network.network import Link, Network, Node

__all__ = [
    "Candidate",
    "End",
    "Side",
    "fitting",
    "inserted",
    "new_node",
    "refusal",
    "wired_along",
    "wired_to",
]

Side = Literal["input", "output"]
End = tuple[str, str, Side]
"""Node, port and the port's side."""


@dataclass(frozen=True)
class Candidate:
    """A module a wire could lead to or come from, and the port it would have there."""

    module: str
    port: str


def fitting(library: Library, types: Collection[str], side: Side) -> tuple[Candidate, ...]:
    """Modules with a port on that side for a wire of one of these types, in the library's order.

    Parameters
    ----------
    library : mapping
        Modules by key.
    types : collection of str
        The types of the wire's loose end.
    side : "input" or "output"
        The side of the ports looked for: inputs take a wire from an output, outputs give one.

    Returns
    -------
    tuple of Candidate
        One for each port that fits.
    """
    wanted = set(types)
    candidates = []
    for key, module in library.items():
        known = declaration(module)
        ports = known.inputs if side == "input" else known.outputs
        candidates += [Candidate(key, port.name) for port in ports if wanted & set(port.types)]
    return tuple(candidates)


def new_node(
    network: Network, library: Library, module: str, at: Point | None
) -> tuple[str, Operation]:
    """The name of a new node of a module, and what adds it.

    Raises
    ------
    NetworkError
        If the library has no such module.
    """
    if module not in library:
        absent = where_absent(module, library)
        hint = f": {absent}" if absent else close(module, library)
        raise NetworkError(f"there is no module {shown(module)}{hint}")
    name = fresh_name(local_key(module), network.nodes)
    return name, Add((Placed(Node(name, module), at),))


def wired_to(
    network: Network, library: Library, end: End, candidate: Candidate, at: Point | None
) -> tuple[str, Operation]:
    """A new node of a candidate wired to a loose end, and its other inputs where they are certain.

    Parameters
    ----------
    network, library
        Where it is to be added.
    end : (node, port, side)
        The port that the loose wire leaves from. Of an input that has a link, the new node comes
        between if it passes that on, else its link takes the place.
    candidate : Candidate
        What is added.
    at : (x, y), optional
        Its point on the canvas.

    Raises
    ------
    NetworkError
        If it does not fit.
    """
    name, adding = new_node(network, library, candidate.module, at)
    grown = adding.apply(network)
    node, port, side = end
    if side == "output":
        link = Link(node, port, name, candidate.port)
    else:
        link = Link(name, candidate.port, node, port)
        old = next((wire for wire in network.links_into(node) if wire.input == port), None)
        between = inserted(grown, library, old, name) if old else None
        if between is not None and link in between.apply(grown).links:
            return name, Together((adding, between), adding.text)
    return name, Together((adding, wired_along(grown, library, link, name)), adding.text)


def wired_along(network: Network, library: Library, link: Link, node: str) -> Rewire:
    """A link to or from a node that has no wires, and those of its other inputs that are certain.

    Raises
    ------
    NetworkError
        If it does not fit.
    """
    wrong = misfit(network, library, link)
    if wrong is not None:
        raise NetworkError(wrong)
    wiring = Rewire(add=(link, *_others(network, library, link, node)))
    check_new_wires(network, wiring.apply(network), library)
    return wiring


def _others(network: Network, library: Library, link: Link, node: str) -> list[Link]:
    """Links for the inputs of a new node beside the one drawn."""
    module = declared(network, library, node)
    if module is None:
        return []
    taken = {link.input} if link.target == node else set()
    followers = {link.target} - {node}
    links = side_links(network, library, node, taken, followers)
    behind = reached_from(network, {node, *followers})
    for kind in (MAGNITUDE, PHASE):
        port = port_of(module.inputs, kind)
        if port is None or port.name in taken or len(port.types) > 1:
            continue
        source = _spectrum(network, library, link, node, kind, required=port.required)
        if source is not None and source[0] not in behind:
            links.append(Link(*source, node, port.name))
    return links


def _spectrum(
    network: Network, library: Library, link: Link, node: str, kind: str, *, required: bool
) -> tuple[str, str] | None:
    """The output that a new node takes its magnitude or phase from."""
    if link.target == node and _brings(network, library, link, PARTNER[kind]):
        return end_beside(network, library, (link.source, link.output), kind)
    if not required:
        return None
    every = [end for end in outputs_of(network, library, kind) if end[0] != node]
    return every[0] if len(every) == 1 else None


def _brings(network: Network, library: Library, link: Link, kind: str) -> bool:
    target: Declaration | None = declared(network, library, link.target)
    port = target.input(link.input) if target else None
    return port is not None and port.types == (kind,)
