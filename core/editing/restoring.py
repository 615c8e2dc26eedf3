"""The operation that puts a whole network in the place of the present one."""

from __future__ import annotations

from dataclasses import dataclass

from core.editing.operation import Operation
from core.network.network import Network


@dataclass(frozen=True)
class Restored(Operation):
    """The network as it was: undoes what changes nodes, links and mentions of them at once.

    Parameters
    ----------
    network : Network
        The state to go back to: nodes, wires, places, all of it.
    label : str
        Text in the undo menu.
    """

    network: Network
    label: str

    @property
    def text(self) -> str:
        """What it does."""
        return self.label

    def apply(self, network: Network) -> Network:  # noqa: ARG002 - whatever it has become
        """That network."""
        return self.network

    def inverse(self, network: Network) -> Operation:
        """Back to the one before."""
        return Restored(network, self.label)

    def joined(self, later: Operation) -> Operation | None:
        """The later network."""
        return later if isinstance(later, Restored) else None
