"""The operation that sets one field: of a node's parameters, of a node, of the network."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from core.editing.operation import ABSENT, Operation, check_plain, with_field
from core.errors import NetworkError
from core.names import freeze
from core.network.network import EXPRESSION, Network, Node

_OF_NODE = ("auto", "disabled")
_OF_NETWORK = ("name", "description", "seed")
# Fields that other operations change, as more than one value depends on them.
_NOT_OF_NODE = {"module", "params", "final"}
_NOT_OF_NETWORK = {"nodes", "links", "layout", "format", "version"}


@dataclass(frozen=True)
class SetField(Operation):
    """Set the field at a path of the network's file; ABSENT takes it away.

    Parameters
    ----------
    path : tuple of str
        ``("seed",)``, ``("nodes", node, "disabled")`` or ``("nodes", node, "params", parameter)``.
    value
        As a network file has it.
    label : str, optional
        Text in the undo menu.
    """

    path: tuple[str, ...]
    value: Any
    label: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        if self.label:
            return self.label
        match self.path:
            case ("nodes", node, "params", name):
                verb = "Reset" if self.value is ABSENT else "Set"
                linked = isinstance(self.value, Mapping) and EXPRESSION in self.value
                return f"{'Link' if linked else verb} {node}.{name}"
            case ("nodes", node, "disabled"):
                return f"{'Disable' if self.value else 'Enable'} {node}"
            case ("nodes", node, "auto"):
                return f"{'Hold' if self.value is False else 'Auto-generate'} {node}"
            case ("nodes", node, name):
                return f"Set {name} of {node}"
            case (name,) if name in _OF_NETWORK:
                return f"Set the network's {name}"
        return f"Set {self.path[-1]}"

    def apply(self, network: Network) -> Network:
        """The network with the field."""
        match self.path:
            case ("nodes", node, "params", name):
                check_value(self.value, f"{node}.{name}")
                return _with_parameter(network, node, name, self.value)
            case ("nodes", node, name) if name not in _NOT_OF_NODE:
                check_value(self.value, f"{node}.{name}")
                return network.with_node(_with_node_field(network.node(node), name, self.value))
            case (name,) if name not in _NOT_OF_NETWORK:
                check_value(self.value, name)
                return _with_network_field(network, name, self.value)
        raise NetworkError(f"{'.'.join(self.path)} is no field that can be set by itself")


def set_parameter(node: str, name: str, value: Any, label: str = "") -> SetField:
    """Give a parameter a value as a network file has it; ABSENT leaves it at its default."""
    return SetField(("nodes", node, "params", name), value, label)


def set_node_field(node: str, name: str, value: Any) -> SetField:
    """Set ``auto``, ``disabled`` or another field of a node, such as ``pinned``."""
    return SetField(("nodes", node, name), value)


def set_network_field(name: str, value: Any, label: str = "") -> SetField:
    """Set the network's name, description, seed or another field, such as ``backdrops``."""
    return SetField((name,), value, label)


def check_value(value: Any, what: str) -> None:
    """Refuse a value that no network file can hold; ABSENT is none.

    Raises
    ------
    NetworkError
        Naming `what` it was meant for.
    """
    if value is not ABSENT:
        check_plain(freeze(value), what)


def _with_parameter(network: Network, node: str, name: str, value: Any) -> Network:
    old = network.node(node)
    if value is not ABSENT:
        return network.with_parameter(node, name, value)
    return network.with_node(replace(old, params=with_field(old.params, name, ABSENT)))


def _with_node_field(node: Node, name: str, value: Any) -> Node:
    if name in _OF_NODE:
        changes: dict[str, Any] = {name: value}
        return replace(node, **changes)
    return replace(node, extra=with_field(node.extra, name, value))


def _with_network_field(network: Network, name: str, value: Any) -> Network:
    if name not in _OF_NETWORK:
        return replace(network, extra=with_field(network.extra, name, value))
    if name != "seed" and not isinstance(value, str):
        raise NetworkError(f"the network's {name} must be a text, not {value!r:.80}")
    changes: dict[str, Any] = {name: value}
    return replace(network, **changes)
