"""The Kodak KIR-310 network with its scene in memory."""

from __future__ import annotations

import time
from typing import Any

from app.shipped import find_network
from core.engine import Engine, Plan
from core.network import Network
from core.network_file import load_network
from core.policy import Policy, Precision
from core.store import Store
from nodes.library import standard_library

NAME = "kodak_kir310"
SCENE, PIXELS, FINAL = "scene.image", "pixels.image", "frame_grabber.image"
SHIPPED_SIZE, GRABBER_LINES = 1024, 486


class SceneStore(Store):
    """A store that keeps one value whatever happens: the picture a run starts with."""

    def __init__(self) -> None:
        super().__init__()
        self._held: dict[str, Any] = {}

    def hold(self, key: str, value: Any) -> None:
        """Keep a value for ever."""
        self._held[key] = value

    def peek(self, key: str, default: Any = None) -> Any:
        """As the store's own, with what is held."""
        found = self._held.get(key)
        return super().peek(key, default) if found is None else found

    def keys(self) -> set[str]:
        """What is there now."""
        with self._lock:
            return set(self._values)

    def forget_all_but(self, keys: set[str]) -> None:
        """Forget what has come since."""
        with self._lock:
            for key in [key for key in self._values if key not in keys]:
                self._bytes -= self._values.pop(key)[1]


def kodak_network(size: int, **scene: Any) -> Network:
    """The shipped network at another size of its scene, its frame grabber in proportion."""
    network = load_network(find_network(NAME).path, library=standard_library())
    for name, value in {"width": size, "height": size, **scene}.items():
        network = network.with_parameter("scene", name, value)
    network = network.with_parameter("frame_grabber", "width", size // 2)
    lines = max(1, round(size * GRABBER_LINES / SHIPPED_SIZE))
    return network.with_parameter("frame_grabber", "height", lines)


class Kodak:
    """An engine, a network and its scene; whatever is timed tells its own seconds.

    Parameters
    ----------
    size : int
        Samples along each side.
    precision : "single" or "double"
        Of the pictures.
    """

    def __init__(self, size: int, precision: Precision = "single") -> None:
        self.network = kodak_network(size)
        self.policy = Policy(precision=precision)
        self.store = SceneStore()
        self.engine = Engine(standard_library(), self.store)
        self.work = self.engine.work(self.policy)
        self.scene = self.value(self.network, SCENE)
        plan = self.engine.plan(self.network)
        self.store.hold(f"{plan.output(SCENE).recipe.key}/{self.policy.key}", self.scene)
        self.store.clear()
        self._edits = 0

    def without_photons(self) -> Network:
        """The network without photon noise."""
        return self.network.with_parameter("photons", "percent", 0.0)

    def value(self, network: Network, port: str) -> Any:
        """What a port gives."""
        return self.engine.value(self.engine.plan(network), port, self.work)

    def looked_at_again(self, before: Plan) -> float:
        """Seconds to plan an unchanged network from its plan and look at the final picture."""
        start = time.perf_counter()
        plan = self.engine.plan(self.network, previous=before)
        self.engine.value(plan, FINAL, self.work)
        return time.perf_counter() - start

    def cold(self, network: Network, port: str, readouts: tuple[str, ...] = ()) -> float:
        """Seconds from an empty store to the value of a port, and the read-outs of nodes."""
        self.store.clear()
        start = time.perf_counter()
        plan = self.engine.plan(network)
        self.engine.value(plan, port, self.work)
        for node in readouts:
            self.engine.readouts(plan, node, self.work)
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
