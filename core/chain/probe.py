"""One value of a transfer function, for read-outs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.chain.realize import transfer_plane
from core.chain.wires import Transfer
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work


@dataclass(frozen=True, eq=False)
class TransferAt(Recipe):
    """MTF or PTF (rad) at one frequency pair, cycles/mrad."""

    transfer: Transfer
    xi: float
    eta: float
    node: str | None = None

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """What its laws are made of."""
        return tuple(self.transfer.recipes)

    def _content(self) -> tuple[object, ...]:
        return self.transfer.key, self.xi, self.eta

    def compute(self, work: Work) -> float:
        """Evaluate the factors at that point alone."""
        xi, eta = np.array([self.xi]), np.array([self.eta])
        return float(transfer_plane(work, self.transfer, xi, eta)[0, 0])
