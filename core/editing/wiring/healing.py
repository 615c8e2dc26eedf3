"""Taking nodes out of the middle of a chain, with the wires led on past them."""

from __future__ import annotations

from collections.abc import Collection

from core.editing.links import Rewire, declared, misfit
from core.editing.nodes import Remove
from core.editing.operation import Operation, Together, named
from core.modules.library_type import Library
from core.names import shown
from core.network.network import Link, Network, passed_through


def dissolved(
    network: Network, library: Library, names: Collection[str], verb: str = "Delete"
) -> Operation:
    """Take nodes out; what each passed on is led past it.

    A wire that leaves them begins, afterwards, where the input came from that its output passes
    on, as it would with the nodes disabled. A wire whose output passes nothing on goes with them.
    """
    return _led_past(names, _ways(network, library, names, only_one=False), verb)


def deleted(
    network: Network, library: Library, names: Collection[str], verb: str = "Delete"
) -> Operation:
    """Take nodes out; a wire is led past them where there is one way through.

    There is none through a node that is fed several wires of the type, as one that adds two
    pictures: which of them was to go on is the user's to say.
    """
    return _led_past(names, _ways(network, library, names, only_one=True), verb)


def _led_past(names: Collection[str], new: tuple[Link, ...], verb: str) -> Operation:
    text = f"{verb} {named([shown(name) for name in names])}"
    removal = Remove(tuple(names), text)
    return Together((removal, Rewire(add=new)), text) if new else removal


def _ways(
    network: Network, library: Library, names: Collection[str], *, only_one: bool
) -> tuple[Link, ...]:
    """The links that take the place of those leaving the nodes."""
    gone = set(names)
    new = []
    for link in network.links:
        if link.source in gone and link.target not in gone:
            start = _origin(network, library, gone, (link.source, link.output), only_one=only_one)
            if start is not None and start[0] != link.target:
                past = Link(*start, link.target, link.input)
                if misfit(network, library, past) is None:
                    new.append(past)
    return tuple(new)


def _origin(
    network: Network,
    library: Library,
    gone: set[str],
    end: tuple[str, str],
    *,
    only_one: bool,
) -> tuple[str, str] | None:
    """The output outside `gone` whose value reaches an output inside; None where none does."""
    seen = set()
    while end[0] in gone:
        name, output = end
        module = declared(network, library, name)
        if name in seen or module is None:  # a cycle, which no sound network has
            return None
        seen.add(name)
        entry = passed_through(module).get(output)
        port = module.output(output)
        linked = {link.input: link for link in network.links_into(name)}
        if entry not in linked or port is None:
            return None
        alike = [
            taking.name
            for taking in module.inputs
            if taking.name in linked and set(port.types) & set(taking.types)
        ]
        if only_one and len(alike) > 1:
            return None
        end = linked[entry].source, linked[entry].output
    return end
