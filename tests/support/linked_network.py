"""Networks written as tables of nodes and links."""

from collections.abc import Iterable, Mapping
from typing import Any

from core.network.network import Link, Network, Node

Nodes = Mapping[str, tuple[str, Mapping[str, Any]]]


def linked_network(
    nodes: Nodes, links: Iterable[tuple[str, str]] = (), *, seed: int = 0
) -> Network:
    """Nodes by name as ``(key, parameters)``, links as ``(node.output, node.input)``."""
    return Network(
        seed=seed,
        nodes={name: Node(name, key, params) for name, (key, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )
