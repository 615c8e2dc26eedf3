"""The operation that puts an earlier state of the whole network in the place of the present one."""

from __future__ import annotations

from dataclasses import dataclass

from core.editing.operation import Operation
from core.network.network import Network


@dataclass(frozen=True)
class GoBack(Operation):
    """Give the document a network that was kept.

    Parameters
    ----------
    network : Network
        The state to go back to: nodes, wires, places, all of it.
    name : str
        What the state is called, for the undo menu.
    """

    network: Network
    name: str

    @property
    def text(self) -> str:
        """What it does."""
        return f"Go back to {self.name}"

    def apply(self, network: Network) -> Network:  # noqa: ARG002 - whatever it has become
        """The network that was kept."""
        return self.network

    def inverse(self, network: Network) -> Operation:
        """Back to the one before."""
        return GoBack(network, self.name)
