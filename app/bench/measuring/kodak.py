"""The Kodak KIR-310 network with its scene in memory."""

from __future__ import annotations

import time
from typing import Any

from app.bench.measuring.loaded_network import Chain
from app.run.shipped import find_network
from core.chain.engine import Plan
from core.evaluation.policy import Policy, Precision
from core.network.file import load_network
from core.network.network import Network
from nodes.library import standard_library

NAME = "kodak_kir310"
PIXELS, FINAL = "pixels.image", "frame_grabber.image"
SHIPPED_SIZE, GRABBER_LINES = 1024, 486


def kodak_network(size: int, **scene: Any) -> Network:
    """The shipped network at another size of its scene, its frame grabber in proportion."""
    network = load_network(find_network(NAME).path, library=standard_library())
    for name, value in {"width": size, "height": size, **scene}.items():
        network = network.with_parameter("scene", name, value)
    network = network.with_parameter("frame_grabber", "width", size // 2)
    lines = max(1, round(size * GRABBER_LINES / SHIPPED_SIZE))
    return network.with_parameter("frame_grabber", "height", lines)


class Kodak(Chain):
    """The network, and edits of it.

    Parameters
    ----------
    size : int
        Samples along each side.
    precision : "single" or "double"
        Of the pictures.
    scene : ndarray, optional
        As for a `Chain`.
    threads : int
        Of the evaluation; 0 for all.
    """

    def __init__(
        self, size: int, precision: Precision = "single", scene: Any = None, threads: int = 0
    ) -> None:
        super().__init__(kodak_network(size), Policy(precision, threads=threads), scene)
        self._edits = 0

    def without_photons(self) -> Network:
        """The network without photon noise."""
        return self.network.with_parameter("photons", "percent", 0.0)

    def looked_at_again(self, before: Plan) -> float:
        """Seconds to plan an unchanged network from its plan and look at the final picture."""
        start = time.perf_counter()
        plan = self.engine.plan(self.network, previous=before)
        self.engine.value(plan, FINAL, self.work)
        return time.perf_counter() - start

    def warm(self) -> set[str]:
        """Evaluate the final picture; gives the keys of what that leaves in the store."""
        self.value(self.network, FINAL)
        return self.store.keys()

    def edited(self, node: str, parameter: str, values: tuple[Any, ...], warm: set[str]) -> float:
        """Seconds from an edit to the final picture, with what was known before it.

        Parameters
        ----------
        node, parameter : str
            What is edited.
        values : tuple
            Values to take in turn.
        warm : set of str
            From `warm`: the edited values' own results are forgotten each time.
        """
        self.store.forget_all_but(warm)
        self._edits += 1
        value = values[self._edits % len(values)]
        before = self.engine.plan(self.network)
        network = self.network.with_parameter(node, parameter, value)
        start = time.perf_counter()
        plan = self.engine.plan(network, previous=before)
        self.engine.value(plan, FINAL, self.work)
        return time.perf_counter() - start
