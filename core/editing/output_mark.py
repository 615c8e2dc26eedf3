"""Marking which picture the network delivers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from core.editing.fields import check_value
from core.editing.operation import ABSENT, Operation, with_field
from core.errors import NetworkError
from core.modules.declaration import Declaration
from core.modules.library_type import Library
from core.names import shown
from core.network.macro import SEPARATOR, declared_node, face_of_macro
from core.network.network import Network, Node, with_marks


@dataclass(frozen=True)
class SetOutput(Operation):
    """Mark these nodes as the network's output, one at most, and no others.

    `port` is the network's own field ``final``, an older way to mark; ABSENT takes it away.
    """

    nodes: tuple[str, ...]
    port: Any = ABSENT

    @property
    def text(self) -> str:
        """What it does."""
        return f"Mark {self.nodes[0]} as the output" if self.nodes else "Unmark the output"

    def apply(self, network: Network) -> Network:
        """The network with the marks."""
        for name in self.nodes:
            if not network.has(name):
                network.node(name)
        check_value(self.port, "final")
        extra = with_field(network.extra, "final", self.port)
        return with_marks(network, self.nodes, extra)


def output_toggled(network: Network, library: Library, name: str) -> Operation:
    """What marks a node as the output, or takes its mark away.

    Raises
    ------
    NetworkError
        If it is no node of the network, or makes and takes no picture.
    """
    node = network.node(name)
    if name in network.output_nodes or (node.macro is not None and node.macro.marked):
        return SetOutput(())
    declared = declared_node(node, library)
    if declared is not None and not has_picture(declared):
        raise NetworkError(f"{shown(name)} cannot be the output: it makes no picture")
    return SetOutput((picture_node(node, library),))


def picture_node(node: Node, library: Library) -> str:
    """The node's id; of a macro that of the one inside whose picture it shows first.

    Raises
    ------
    NetworkError
        If the macro shows no picture.
    """
    if node.macro is None:
        return node.id
    declared = declared_node(node, library)
    pictures = [port.name for port in declared.outputs if "image" in port.types] if declared else []
    for name in pictures[:1]:
        inner = node.macro.nodes[face_of_macro(node.macro).outputs[name][0]]
        return f"{node.id}{SEPARATOR}{picture_node(inner, library)}"
    raise NetworkError(f"{shown(node.id)} shows no picture: mark the node inside of it")


def has_picture(declared: Declaration) -> bool:
    """Whether a module makes a picture or, making nothing, takes one."""
    ports = declared.inputs if declared.sink else declared.outputs
    return any("image" in port.types for port in ports)
