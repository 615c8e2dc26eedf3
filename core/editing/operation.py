"""Changes of a network as values: what gives the network after it from the one before.

An operation applied to a network it does not fit raises an error of this program and changes
nothing.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

from core.errors import NetworkError
from core.names import shown
from core.network.network import Network


class Absent(Enum):
    """The value of what is not there: a parameter left at its default, a field left out."""

    ABSENT = "absent"


ABSENT = Absent.ABSENT


class Operation(ABC):
    """A change of a network."""

    @property
    @abstractmethod
    def text(self) -> str:
        """What it does, for the undo menu."""

    @abstractmethod
    def apply(self, network: Network) -> Network:
        """The network after the change.

        Raises
        ------
        NetworkError, ParameterError
            If it does not fit the network.
        """

    def moved(self, network: Network) -> dict[str, str]:  # noqa: ARG002
        """What nodes are called afterwards that had another name before; `network` is as before."""
        return {}


@dataclass(frozen=True)
class Together(Operation):
    """Several operations, one after the other, as one."""

    operations: Sequence[Operation]
    label: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        if self.label or not self.operations:
            return self.label
        more = len(self.operations) - 1
        return self.operations[0].text + (f" and {more} more" if more else "")

    def apply(self, network: Network) -> Network:
        """The network after all of them."""
        for operation in self.operations:
            network = operation.apply(network)
        return network

    def moved(self, network: Network) -> dict[str, str]:
        """What nodes are called after all of them."""
        names: dict[str, str] = {}
        for operation in self.operations:
            step = operation.moved(network)
            names = {old: step.pop(new, new) for old, new in names.items()}
            names |= {old: new for old, new in step.items() if old not in names}
            network = operation.apply(network)
        return names


@dataclass(frozen=True)
class Restored(Operation):
    """Put a whole network in the place of the present one."""

    network: Network
    label: str

    @property
    def text(self) -> str:
        """What it does."""
        return self.label

    def apply(self, network: Network) -> Network:  # noqa: ARG002 - whatever it has become
        """That network."""
        return self.network


def with_field(fields: Mapping[str, Any], name: str, value: Any) -> dict[str, Any]:
    """The fields with one set, or taken away by ABSENT."""
    others = {key: item for key, item in fields.items() if key != name}
    return others if value is ABSENT else {**others, name: value}


def named(names: Sequence[str]) -> str:
    """One name, or how many there are."""
    return names[0] if len(names) == 1 else f"{len(names)} nodes"


def check_plain(value: Any, what: str) -> None:
    """Refuse what no network file can hold, before it is in the document and cannot be saved.

    Raises
    ------
    NetworkError
        Naming `what` it was meant for, and the value.
    """
    rest = [value]
    while rest:
        item = rest.pop()
        if isinstance(item, Mapping) and all(isinstance(key, str) for key in item):
            rest += [*item.keys(), *item.values()]
        elif isinstance(item, list | tuple):
            rest += item
        elif not _storable(item):
            raise NetworkError(
                f"{shown(what)} cannot be {item!r:.80}: only finite numbers, texts, true, false, "
                "null, lists and objects of them can be saved"
            )


def _storable(item: Any) -> bool:
    if isinstance(item, str):
        # Half a surrogate pair is a text to Python, but not to a file.
        return item.isascii() or not any("\ud800" <= c <= "\udfff" for c in item)
    if isinstance(item, float):
        return math.isfinite(item)
    return item is None or isinstance(item, bool | int)
