"""Adding a node with another one selected: the new one goes on from it."""

from __future__ import annotations

from collections.abc import Iterator

from core.editing.layout.boxes import Point
from core.editing.links import declared
from core.editing.operation import Operation, together
from core.editing.wiring.fitting import Candidate, End, new_node, wired_to
from core.editing.wiring.inserting import inserted
from core.errors import NetworkError
from core.modules.declaration import Port, declaration
from core.modules.library_type import Library
from core.network.network import Network

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
    known = declared(network, library, node)
    if known is None:
        return None
    grown = adding.apply(network)
    new = declaration(library[module])
    for output, entry in _pairs(known.outputs, new.inputs):
        onward = [link for link in network.links if (link.source, link.output) == (node, output)]
        between = inserted(grown, library, onward[0], name) if len(onward) == 1 else None
        if between is not None:
            return name, together((adding, between), adding.text)
        end: End = (node, output, "output")
        try:
            return wired_to(network, library, end, Candidate(module, entry), at)
        except NetworkError:
            continue  # the next pair may do
    linked = {link.input for link in network.links_into(node)}
    empty = tuple(port for port in known.inputs if port.required and port.name not in linked)
    for output, entry in _pairs(new.outputs, empty):
        end = (node, entry, "input")
        try:
            return wired_to(network, library, end, Candidate(module, output), at)
        except NetworkError:
            continue
    return None


def branched(
    network: Network, library: Library, node: str, module: str
) -> tuple[str, Operation] | None:
    """A new node wired to the open end of another one, and its name; None where none fits.

    An output is open where no other node carries its kind of value on: a viewer or a file that
    takes it leaves it open. Nothing that is wired already changes.

    Parameters
    ----------
    network, library
        Where it is to be added.
    node : str
        The node to go on from.
    module : str
        Key of the new node's module.
    """
    known = declared(network, library, node)
    if known is None or module not in library:
        return None
    new = declaration(library[module])
    for output, entry in _pairs(known.outputs, new.inputs):
        if not _is_open(network, library, node, output):
            continue
        try:
            return wired_to(
                network, library, (node, output, "output"), Candidate(module, entry), None
            )
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
