"""Adding a node to a chain: where it goes on from, and its other wires."""

from __future__ import annotations

from collections.abc import Sequence

from core.editing.links import declared, reached_from
from core.editing.operations import Add, Operation, Placed, fresh_name
from core.editing.wiring import outputs_of, wires_behind, wires_from_open_end
from core.errors import NetworkError
from core.modules.library_type import Library
from core.names import shown
from core.network.macro import declared_node
from core.network.network import Link, Network, Node

_BESIDE = ("context", "pupil", "magnitude", "phase")


def added(
    network: Network,
    library: Library,
    node: Node,
    *,
    order: Sequence[str],
    after: str | None,
    wired: bool,
) -> Network:
    """The network with a node, wired.

    Parameters
    ----------
    network, library
        Where it is added.
    node : Node
        The node, of a module in the library.
    order : sequence of str
        The nodes as they were added, the last one last.
    after : str, optional
        The node to go on from; if not given, the one added last that has what the module takes.
    wired : bool
        Whether it is wired at all.

    Raises
    ------
    NetworkError
        If it does not fit there.
    """
    taken = declared_node(node, library)
    assert taken is not None
    if not wired or not network.nodes or (after is None and not taken.inputs):
        return Add((Placed(node),)).apply(network)
    grown = Add((Placed(node),)).apply(network)
    wiring = _wiring(grown, library, node.id, order, after)
    if wiring is None and taken.inputs:
        kinds = " or ".join(dict.fromkeys(kind for port in taken.inputs for kind in port.types))
        where = f"{shown(after)} gives" if after is not None else "the chain's nodes give"
        raise NetworkError(
            f"{shown(node.id)} ({taken.title}) takes {kinds}, and {where} none that leads nowhere "
            "yet: give after=, or wired=False and link it"
        )
    # A module that takes nothing, and that nothing waits for, begins something of its own.
    return grown if wiring is None else _completed(wiring.apply(grown), library, node.id, order)


def _wiring(
    network: Network, library: Library, name: str, order: Sequence[str], after: str | None
) -> Operation | None:
    if after is not None:
        return wires_behind(network, library, network.node(after).id, name)
    every = (wires_from_open_end(network, library, one, name) for one in reversed(order))
    return next((wiring for wiring in every if wiring is not None), None)


def _completed(network: Network, library: Library, name: str, order: Sequence[str]) -> Network:
    """With links for the inputs beside the picture that are still empty, from the nearest node."""
    known = declared(network, library, name)
    assert known is not None
    linked = {link.input for link in network.links_into(name)}
    behind = reached_from(network, {name})
    place = {node: index for index, node in enumerate(order)}
    links = []
    for port in known.inputs:
        if port.name in linked or not port.required or port.types[0] not in _BESIDE:
            continue
        ends = [end for end in outputs_of(network, library, port.types[0]) if end[0] not in behind]
        if ends:
            nearest = max(ends, key=lambda end: place.get(end[0], -1))
            links.append(Link(*nearest, name, port.name))
    if not links:
        return network
    return Add((), tuple(links)).apply(network)


def node_name(wanted: str | None, module: str, network: Network) -> str:
    """The name of a new node: the one that is wanted, else the module's, with a number if need be.

    Raises
    ------
    NetworkError
        If the one that is wanted is taken.
    """
    if wanted is None:
        return fresh_name(module, network.nodes)
    if wanted in network.nodes:
        raise NetworkError(f"there is a node {shown(wanted)} already")
    return wanted
