"""A network with its scene in memory, evaluated from nothing any number of times."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import Any

from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.evaluation.store import Store
from core.network.network import Link, Network, Node
from nodes.library import standard_library

SCENE = "scene.image"
Described = Mapping[str, tuple[str, Mapping[str, Any]]]


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
        held = self._held.get(key)
        return super().peek(key, default) if held is None else held

    def keys(self) -> set[str]:
        """What is there now."""
        with self._lock:
            return set(self._values)

    def forget_all_but(self, keys: set[str]) -> None:
        """Drop what has come since."""
        with self._lock:
            for key in [key for key in self._values if key not in keys]:
                self._bytes -= self._values.pop(key)[1]


class Chain:
    """An engine, a network and its scene; whatever is timed returns its own seconds.

    Parameters
    ----------
    network : Network
        With a node `scene`.
    policy : Policy
        Precision and tolerance.
    scene : ndarray, optional
        Samples to take in place of the node's own, so that two policies start from the same.
    """

    def __init__(self, network: Network, policy: Policy, scene: Any = None) -> None:
        self.network = network
        self.policy = policy
        self.store = SceneStore()
        self.engine = Engine(standard_library(), self.store)
        self.work = self.engine.work(policy)
        self.scene = self.value(network, SCENE) if scene is None else scene.astype(policy.dtype)
        self.store.hold(self.key(SCENE), self.scene)
        self.store.clear()

    def key(self, port: str) -> str:
        """Where the store keeps a port's picture."""
        recipe = self.engine.plan(self.network).output(port).recipe
        return f"{recipe.key}/{self.policy.key}"

    def value(self, network: Network, port: str) -> Any:
        """What a port gives."""
        return self.engine.value(self.engine.plan(network), port, self.work)

    def cold(self, network: Network, port: str, readouts: tuple[str, ...] = ()) -> float:
        """Seconds from an empty store to the value of a port, and the read-outs of nodes."""
        self.store.clear()
        start = time.perf_counter()
        plan = self.engine.plan(network)
        self.engine.value(plan, port, self.work)
        for node in readouts:
            self.engine.readouts(plan, node, self.work)
        return time.perf_counter() - start


def network_of(nodes: Described, links: Iterable[tuple[str, str]]) -> Network:
    """A network from modules with their parameters, and ports linked to ports."""
    return Network(
        nodes={name: Node(name, key, dict(params)) for name, (key, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )


def stages_in_turn(stages: Iterable[str]) -> list[tuple[str, str]]:
    """Links from `init` through stages of an MTF each, in that order, to `back`."""
    links, before = [("init.phase", "back.phase")], "init"
    for stage in stages:
        links += [("init.context", f"{stage}.context")]
        links += [(f"{before}.magnitude", f"{stage}.magnitude")]
        before = stage
    return [*links, (f"{before}.magnitude", "back.magnitude")]
