"""Operations on links."""

from __future__ import annotations

from dataclasses import dataclass, replace

from core.editing.operation import Operation
from core.errors import NetworkError
from core.network.network import Link, Network


@dataclass(frozen=True)
class Rewire(Operation):
    """Take links away and put links in; one into an input that has one takes its place."""

    add: tuple[Link, ...] = ()
    remove: tuple[Link, ...] = ()
    label: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        if self.label:
            return self.label
        first = next(iter((*self.add, *self.remove)), None)
        return f"{'Connect' if self.add else 'Disconnect'} {first or ''}".strip()

    def apply(self, network: Network) -> Network:
        """The network wired so."""
        for link in self.add:
            network.node(link.source)
            network.node(link.target)
        missing = [link for link in self.remove if link not in network.links]
        if missing:
            raise NetworkError(f"there is no link {missing[0]}")
        gone = {*self.remove, *displaced(network, self.add)}
        kept = [link for link in network.links if link not in gone and link not in self.add]
        return replace(network, links=(*kept, *self.add))

    def inverse(self, network: Network) -> Operation:
        """Wire as before."""
        before = set(network.links)
        pushed = [link for link in displaced(network, self.add) if link not in self.remove]
        new = tuple(link for link in self.add if link not in before)
        again = tuple(link for link in self.remove if link not in self.add)
        return Rewire(add=(*again, *pushed), remove=new, label=self.text)


def displaced(network: Network, links: tuple[Link, ...]) -> tuple[Link, ...]:
    """The links whose inputs these would take."""
    taken = {(link.target, link.input) for link in links}
    return tuple(
        link for link in network.links if (link.target, link.input) in taken and link not in links
    )
