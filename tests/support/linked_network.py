"""Networks written as tables of nodes and links."""

from collections.abc import Iterable, Mapping
from typing import Any

from core.modules.declaration import declaration
from core.network.network import Link, Network, Node
from nodes.library import standard_library

Nodes = Mapping[str, tuple[str, Mapping[str, Any]]]


def linked_network(
    nodes: Nodes, links: Iterable[tuple[str, str]] | None = None, *, seed: int = 0
) -> Network:
    """Nodes by name as ``(key, parameters)``, links as ``(node.output, node.input)``."""
    links = in_order(nodes) if links is None else links  # by what each takes and gives
    return Network(
        seed=seed,
        nodes={name: Node(name, key, params) for name, (key, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )


def in_order(nodes: Nodes) -> list[tuple[str, str]]:
    """Links of each input to the last output of its name before; of a transfer, to a magnitude."""
    library, links = standard_library(), list[tuple[str, str]]()
    last: dict[str, str] = {}
    for name, (key, _) in nodes.items():
        declared = declaration(library[key])
        for port in declared.inputs:
            taken = "magnitude" if port.name == "transfer" else port.name
            if taken in last:
                links.append((last[taken], f"{name}.{port.name}"))
        last |= {port.name: f"{name}.{port.name}" for port in declared.outputs}
    return links


def document_of(nodes: Nodes, **fields: Any) -> dict[str, Any]:
    """The plain data of such a network's file, linked in order; `fields` are its other ones."""
    written = {
        name: {"module": key, **({"params": dict(params)} if params else {})}
        for name, (key, params) in nodes.items()
    }
    links = [list(link) for link in in_order(nodes)]
    head = {"format": "imagechain-network", "version": 1, **fields}
    return {**head, "nodes": written, "links": links}
