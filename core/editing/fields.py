"""Operations that set one field: of a node's parameters, of a node, of the network."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from core.editing.operation import ABSENT, Operation, check_plain, with_field
from core.errors import NetworkError
from core.names import freeze, thaw
from core.network.network import Network

NodeField = Literal["auto", "disabled"]
NetworkField = Literal["name", "description", "seed"]


@dataclass(frozen=True)
class SetParameter(Operation):
    """Give a parameter a value as a network file has it; ABSENT leaves it at its default."""

    sets: ClassVar[bool] = True

    node: str
    name: str
    value: Any

    @property
    def text(self) -> str:
        """What it does."""
        return f"{'Reset' if self.value is ABSENT else 'Set'} {self.node}.{self.name}"

    def apply(self, network: Network) -> Network:
        """The network with the value."""
        old = network.node(self.node)
        if self.value is not ABSENT:
            check_value(self.value, f"{self.node}.{self.name}")
            return network.with_parameter(self.node, self.name, self.value)
        params = {name: value for name, value in old.params.items() if name != self.name}
        return network.with_node(replace(old, params=params))

    def inverse(self, network: Network) -> Operation:
        """Give it the value it had."""
        had = network.node(self.node).params.get(self.name, ABSENT)
        return SetParameter(self.node, self.name, thaw(had))

    def joined(self, later: Operation) -> Operation | None:
        """The later value, if it is of the same parameter."""
        if not isinstance(later, SetParameter):
            return None
        return later if (later.node, later.name) == (self.node, self.name) else None


@dataclass(frozen=True)
class SetNode(Operation):
    """Set whether a node is generated automatically, or disabled."""

    sets: ClassVar[bool] = True

    node: str
    name: NodeField
    value: bool | None

    @property
    def text(self) -> str:
        """What it does."""
        if self.name == "disabled":
            return f"{'Disable' if self.value else 'Enable'} {self.node}"
        return f"{'Hold' if self.value is False else 'Auto-generate'} {self.node}"

    def apply(self, network: Network) -> Network:
        """The network with the field set."""
        changes: dict[str, Any] = {self.name: self.value}
        return network.with_node(replace(network.node(self.node), **changes))

    def inverse(self, network: Network) -> Operation:
        """Set it as it was."""
        return SetNode(self.node, self.name, getattr(network.node(self.node), self.name))

    def joined(self, later: Operation) -> Operation | None:
        """The later value, if it is of the same field."""
        if not isinstance(later, SetNode):
            return None
        return later if (later.node, later.name) == (self.node, self.name) else None


@dataclass(frozen=True)
class SetNodeExtra(Operation):
    """Set another field of a node, such as ``pinned``; ABSENT takes it away."""

    sets: ClassVar[bool] = True

    node: str
    name: str
    value: Any

    @property
    def text(self) -> str:
        """What it does."""
        return f"Set {self.name} of {self.node}"

    def apply(self, network: Network) -> Network:
        """The network with the field."""
        check_value(self.value, f"{self.node}.{self.name}")
        old = network.node(self.node)
        return network.with_node(replace(old, extra=with_field(old.extra, self.name, self.value)))

    def inverse(self, network: Network) -> Operation:
        """Set it as it was."""
        had = network.node(self.node).extra.get(self.name, ABSENT)
        return SetNodeExtra(self.node, self.name, thaw(had))

    def joined(self, later: Operation) -> Operation | None:
        """The later value, if it is of the same field."""
        if not isinstance(later, SetNodeExtra):
            return None
        return later if (later.node, later.name) == (self.node, self.name) else None


@dataclass(frozen=True)
class SetNetwork(Operation):
    """Set the network's name, description or seed."""

    sets: ClassVar[bool] = True

    name: NetworkField
    value: Any

    @property
    def text(self) -> str:
        """What it does."""
        return f"Set the network's {self.name}"

    def apply(self, network: Network) -> Network:
        """The network with it."""
        check_value(self.value, self.name)
        if self.name != "seed" and not isinstance(self.value, str):
            raise NetworkError(f"the network's {self.name} must be a text, not {self.value!r:.80}")
        changes: dict[str, Any] = {self.name: self.value}
        return replace(network, **changes)

    def inverse(self, network: Network) -> Operation:
        """Set it as it was."""
        return SetNetwork(self.name, getattr(network, self.name))

    def joined(self, later: Operation) -> Operation | None:
        """The later value, if it is of the same field."""
        return later if isinstance(later, SetNetwork) and later.name == self.name else None


@dataclass(frozen=True)
class SetExtra(Operation):
    """Set another field of the network, such as ``backdrops``; ABSENT takes it away."""

    sets: ClassVar[bool] = True

    name: str
    value: Any
    label: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        return self.label or f"Set {self.name}"

    def apply(self, network: Network) -> Network:
        """The network with the field."""
        check_value(self.value, self.name)
        return replace(network, extra=with_field(network.extra, self.name, self.value))

    def inverse(self, network: Network) -> Operation:
        """Set it as it was."""
        return SetExtra(self.name, thaw(network.extra.get(self.name, ABSENT)), self.text)

    def joined(self, later: Operation) -> Operation | None:
        """The later value, if it is of the same field."""
        if not isinstance(later, SetExtra) or later.name != self.name:
            return None
        return replace(later, label=self.text)


def check_value(value: Any, what: str) -> None:
    """Refuse a value that no network file can hold; ABSENT is none.

    Raises
    ------
    NetworkError
        Naming `what` it was meant for.
    """
    if value is not ABSENT:
        check_plain(freeze(value), what)
