"""The outputs of a network that a view can show, and where they go when nodes are renamed."""

from __future__ import annotations

from collections.abc import Collection, Hashable
from dataclasses import dataclass, replace

from core.modules.library_type import Library
from core.network.macro import declared_node
from core.network.network import Network, Node, passed_through

PICTURE_TYPES = ("image", "magnitude", "phase", "transfer", "pupil")
"""Types of ports that are shown in the viewers of pictures."""

PLOT_TYPES = ("curve", "table")
"""Types of ports that are shown in the viewer of curves."""

VIEWER_NUMBERS = tuple(range(1, 10))
"""Of the viewers of pictures there may be."""

HOW_TO_MARK = "select the node of the one that is the output and press O"


@dataclass(frozen=True)
class NodePorts:
    """Outputs of one node: its id, its module's title, and its ports as ``NODE.PORT``."""

    node: str
    title: str
    ports: tuple[str, ...]


def ports_by_node(
    network: Network, library: Library, types: Collection[str]
) -> tuple[NodePorts, ...]:
    """Outputs of these port types by node, in the document's order.

    Of a disabled node, only what it passes on.
    """
    node_ports = []
    for node in network.nodes.values():
        declared = declared_node(node, library)
        if declared is None:
            continue
        through = passed_through(declared)
        ports = tuple(
            f"{node.id}.{port.name}"
            for port in declared.outputs
            if port.types[0] in types and (port.name in through or not node.disabled)
        )
        if ports:
            node_ports.append(NodePorts(node.id, declared.title, ports))
    return tuple(node_ports)


def ports_depend_on(network: Network) -> Hashable:
    """What `ports_by_node` depends on: cheap to compare after each change."""
    return tuple(
        (node.id, node.module, node.disabled, node.macro and node.macro.extra.get("outputs"))
        for node in network.nodes.values()
    )


def followed(port: str, before: Network, after: Network) -> str | None:
    """Where the port is after a change: under its node's new name, or None if that is gone."""
    name, _, output = port.rpartition(".")
    if name in after.nodes:
        return port
    come = [new for new in after.nodes if new not in before.nodes]
    old = before.nodes.get(name)
    for new in come:
        if old is not None and _alike(old, after.nodes[new]):
            return f"{new}.{output}"
    return None


def _alike(old: Node, new: Node) -> bool:
    """Whether it is the same node under another name, or grouped, or no longer so."""
    return replace(old, id=new.id, noise=new.noise) == new
