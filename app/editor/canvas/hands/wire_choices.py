"""Which wires some nodes could have, for the list that wires by the keyboard. Without Qt."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from core.editing.links import refusal
from core.modules.declaration import Port, declaration
from core.modules.library_type import Library
from core.network.network import Link, Network


@dataclass(frozen=True)
class Possible:
    """A link that could be made, and what it would replace; empty inputs come first."""

    link: Link
    remark: str
    rank: int


def possible_links(network: Network, library: Library, names: Collection[str]) -> list[Possible]:
    """Every link that fits: of one node to all others, of several nodes among themselves.

    First those into empty inputs that need one, then into other empty ones, then those that would
    take another link's place.
    """
    among = names if len(names) > 1 else network.nodes
    ours = set(names)
    possible = []
    for source in among:
        for target in among:
            if source != target and ours & {source, target}:
                possible += list(_between(network, library, source, target))
    return sorted(possible, key=lambda possibility: possibility.rank)


def _between(network: Network, library: Library, source: str, target: str) -> Iterator[Possible]:
    taken = {link.input: link for link in network.links_into(target)}
    for output in _ports(network, library, source, "output"):
        for entry in _ports(network, library, target, "input"):
            link = Link(source, output.name, target, entry.name)
            old = taken.get(entry.name)
            if old == link or not set(output.types) & set(entry.types):
                continue
            if refusal(network, library, link) is not None:
                continue
            remark = f"instead of {old.source}.{old.output}" if old is not None else ""
            yield Possible(link, remark, 2 if old is not None else 0 if entry.required else 1)


def _ports(network: Network, library: Library, name: str, side: str) -> tuple[Port, ...]:
    module = library.get(network.nodes[name].module)
    if module is None:
        return ()
    known = declaration(module)
    return known.inputs if side == "input" else known.outputs
