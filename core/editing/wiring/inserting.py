"""Putting an unconnected node into a wire."""

from __future__ import annotations

from core.editing.links import Rewire, check_new_wires, declared
from core.editing.operation import Operation
from core.editing.wiring.partners import MAGNITUDE, PARTNER, PHASE, port_of, side_links, wire_beside
from core.errors import NetworkError
from core.modules.declaration import Port
from core.modules.library_type import Library
from core.names import shown
from core.network.network import Link, Network


def inserted(network: Network, library: Library, link: Link, node: str) -> Operation | None:
    """Lead a wire through a node; None where it does not fit.

    The node takes the wire at its first input and gives it on at its first output of the wire's
    type. It must feed nothing yet, and that input must be empty. Its empty context and pupil
    inputs are wired where there is one candidate; where it takes and gives magnitude and phase and
    the wire's partner runs beside it, that one is led through as well.
    """
    ends = _ends(network, library, link, node)
    if ends is None:
        return None
    entry, output, kind = ends
    through = [(link, entry, output)]
    partner = _partner(network, library, link, node, kind)
    if partner is not None:
        through.append(partner)
    while through:
        operation = _led(network, library, node, through)
        if _sound(network, library, operation):
            return operation
        through.pop()  # without the partner, then, before not at all
    return None


def _led(
    network: Network, library: Library, node: str, through: list[tuple[Link, Port, Port]]
) -> Operation:
    new = []
    for wire, entry, output in through:
        new += [
            Link(wire.source, wire.output, node, entry.name),
            Link(node, output.name, wire.target, wire.input),
        ]
    taken = {link.input for link in (*network.links_into(node), *new) if link.target == node}
    followers = {wire.target for wire, _, _ in through}
    new += side_links(network, library, node, taken, followers)
    return Rewire(
        add=tuple(new), remove=tuple(wire for wire, _, _ in through), label=f"Insert {shown(node)}"
    )


def _ends(
    network: Network, library: Library, link: Link, node: str
) -> tuple[Port, Port, str] | None:
    """Where the wire goes into the node and out of it, and of what type it is."""
    free = node in network.nodes and not network.followers[node]
    if not free or link not in network.links or node in (link.source, link.target):
        return None
    module = declared(network, library, node)
    if module is None:
        return None
    giving, taking = (declared(network, library, end) for end in (link.source, link.target))
    given = giving.output(link.output) if giving else None
    wanted = taking.input(link.input) if taking else None
    kinds = given.types if given else wanted.types if wanted else ()
    linked = {wire.input for wire in network.links_into(node)}
    for kind in kinds:
        entry, output = port_of(module.inputs, kind), port_of(module.outputs, kind)
        fits = wanted is None or kind in wanted.types
        if fits and entry and output and entry.name not in linked:
            return entry, output, kind
    return None


def _partner(
    network: Network, library: Library, link: Link, node: str, kind: str
) -> tuple[Link, Port, Port] | None:
    """The wire that is led through beside a magnitude or phase, and where."""
    if kind not in (MAGNITUDE, PHASE):
        return None
    other = PARTNER[kind]
    module = declared(network, library, node)
    wire = wire_beside(network, library, link, other)
    if module is None or wire is None or node in (wire.source, wire.target):
        return None
    entry, output = port_of(module.inputs, other), port_of(module.outputs, other)
    linked = {into.input for into in network.links_into(node)}
    if entry is None or output is None or entry.name in linked:
        return None
    return wire, entry, output


def _sound(network: Network, library: Library, operation: Operation) -> bool:
    try:
        check_new_wires(network, operation.apply(network), library)
    except NetworkError:
        return False
    return True
