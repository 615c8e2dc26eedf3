"""Adding a node with another one selected: the new one goes on from it."""

from __future__ import annotations

from collections.abc import Iterator

from core.editing.layout.boxes import Point
from core.editing.links import declared
from core.editing.operation import Operation, Together
from core.editing.wiring.fitting import new_node, wired_along
from core.editing.wiring.inserting import inserted
from core.errors import NetworkError
from core.modules.declaration import Port
from core.modules.library_type import Library
from core.network.network import Link, Network

_BESIDE_THE_CHAIN = ("context", "pupil")  # a module goes on from these only for lack of others


def continued(
    network: Network, library: Library, node: str, module: str, at: Point | None
) -> tuple[str, Operation] | None:
    """A new node wired on to another one, and its name; None where the two have no wire in common.

    An output that leads to one node gives its wire: the new node comes between. Else it is a branch
    of its own. A module that takes nothing from the node, but gives what an empty input of it
    needs, feeds it.

    Parameters
    ----------
    network, library
        Where it is to be added.
    node : str
        The node to go on from.
    module : str
        Key of the new node's module.
    at : (x, y), optional
        Its point on the canvas.

    Raises
    ------
    NetworkError
        If the library has no such module.
    """
    name, adding = new_node(network, library, module, at)
    wiring = wires_behind(adding.apply(network), library, node, name)
    return None if wiring is None else (name, Together((adding, wiring), adding.text))


def wires_behind(network: Network, library: Library, node: str, new: str) -> Operation | None:
    """What wires a node without wires on to another one; None where they have none in common.

    As `continued`, for a node that is there already.
    """
    known, added = declared(network, library, node), declared(network, library, new)
    if known is None or added is None:
        return None
    for output, entry in _pairs(known.outputs, added.inputs):
        onward = [link for link in network.links if (link.source, link.output) == (node, output)]
        between = inserted(network, library, onward[0], new) if len(onward) == 1 else None
        if between is not None:
            return between
        try:
            return wired_along(network, library, Link(node, output, new, entry), new)
        except NetworkError:
            continue  # the next pair may do
    linked = {link.input for link in network.links_into(node)}
    empty = tuple(port for port in known.inputs if port.required and port.name not in linked)
    for output, entry in _pairs(added.outputs, empty):
        try:
            return wired_along(network, library, Link(new, output, node, entry), new)
        except NetworkError:
            continue
    return None


def wires_from_open_end(
    network: Network, library: Library, node: str, new: str
) -> Operation | None:
    """What wires a node without wires to the open end of another one; None where none fits.

    An output is open where no other node carries its kind of value on: a viewer or a file that
    takes it leaves it open. Nothing that is wired already changes.

    Parameters
    ----------
    network, library
        Where both are.
    node : str
        The node to go on from.
    new : str
        The node without wires.
    """
    known, added = declared(network, library, node), declared(network, library, new)
    if known is None or added is None:
        return None
    for output, entry in _pairs(known.outputs, added.inputs):
        if not _is_open(network, library, node, output):
            continue
        try:
            return wired_along(network, library, Link(node, output, new, entry), new)
        except NetworkError:
            continue  # the next pair may do
    return None


def _is_open(network: Network, library: Library, node: str, output: str) -> bool:
    known = declared(network, library, node)
    port = known.output(output) if known is not None else None
    kinds = set(port.types) if port is not None else set()
    if kinds <= set(_BESIDE_THE_CHAIN):
        return True
    for link in network.links:
        if (link.source, link.output) == (node, output):
            target = declared(network, library, link.target)
            if target is None or any(kinds & set(onward.types) for onward in target.outputs):
                return False
    return True


def _pairs(outputs: tuple[Port, ...], inputs: tuple[Port, ...]) -> Iterator[tuple[str, str]]:
    """Outputs and the inputs they fit: what every module takes last, needed inputs first."""
    fitting = [
        (output.types[0] in _BESIDE_THE_CHAIN, not entry.required, output.name, entry.name)
        for output in outputs
        for entry in inputs
        if set(output.types) & set(entry.types)
    ]
    # Sorted by the first two alone: of equal ones the order of the declaration counts.
    return ((pair[2], pair[3]) for pair in sorted(fitting, key=lambda pair: pair[:2]))
