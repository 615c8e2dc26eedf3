"""Operations that put nodes in, take them out, move and rename them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Container, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from core.editing.fields import set_parameter
from core.editing.layout.boxes import Point
from core.editing.links import Rewire
from core.editing.operation import Operation, Together, named
from core.editing.references import dropped, of_nodes, renamed
from core.errors import NetworkError
from core.expressions.grammar import ExpressionError
from core.names import shown, thaw
from core.network.linked_values import naming, with_names
from core.network.network import Link, Network, Node


@dataclass(frozen=True)
class Placed:
    """A node with its point of the canvas and its place in the document's order (None: last)."""

    node: Node
    at: Point | None = None
    index: int | None = None


@dataclass(frozen=True)
class Add(Operation):
    """Put nodes in, and links; a link into an input that has one takes its place.

    `extra` are fields of the network that come with them.
    """

    placed: tuple[Placed, ...]
    links: tuple[Link, ...] = ()
    label: str = ""
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """What it does."""
        return self.label or f"Add {named([placed.node.id for placed in self.placed])}"

    def apply(self, network: Network) -> Network:
        """The network with them."""
        order = list(network.nodes)
        nodes = dict(network.nodes)
        layout = dict(network.layout)
        for placed in self.placed:
            if placed.node.id in nodes:
                raise NetworkError(f"there is a node {shown(placed.node.id)} already")
            nodes[placed.node.id] = placed.node
            order.insert(len(order) if placed.index is None else placed.index, placed.node.id)
            if placed.at is not None:
                layout[placed.node.id] = _finite(placed.node.id, placed.at)
        grown = replace(
            network,
            nodes={name: nodes[name] for name in order},
            layout=layout,
            extra={**network.extra, **self.extra},
        )
        return Rewire(add=self.links).apply(grown)


@dataclass(frozen=True)
class Remove(Operation):
    """Take nodes out, with their links and every mention of them."""

    names: tuple[str, ...]
    label: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        return self.label or f"Delete {named(self.names)}"

    def apply(self, network: Network) -> Network:
        """The network without them."""
        for name in self.names:
            network.node(name)
        gone = set(self.names)
        return replace(
            network,
            nodes={name: node for name, node in network.nodes.items() if name not in gone},
            links=tuple(link for link in network.links if not {link.source, link.target} & gone),
            layout={name: at for name, at in network.layout.items() if name not in gone},
            extra=dropped(network.extra, of_nodes(gone, network.nodes)),
        )


@dataclass(frozen=True)
class Move(Operation):
    """Put nodes at points of the canvas; None takes a node's point away."""

    positions: Mapping[str, Point | None]
    label: str = ""

    @property
    def text(self) -> str:
        """What it does."""
        return self.label or f"Move {named(list(self.positions))}"

    def apply(self, network: Network) -> Network:
        """The network with them there."""
        layout: dict[str, Point] = dict(network.layout)
        for name, at in self.positions.items():
            network.node(name)
            if at is None:
                layout.pop(name, None)
            else:
                layout[name] = _finite(name, at)
        return replace(network, layout=layout)


@dataclass(frozen=True)
class Rename(Operation):
    """Give a node another id, wherever it is mentioned."""

    old: str
    new: str

    @property
    def text(self) -> str:
        """What it does."""
        return f"Rename {self.old} to {self.new}"

    def apply(self, network: Network) -> Network:
        """The network with the new name."""
        network.node(self.old)
        if self.new != self.old and self.new in network.nodes:
            raise NetworkError(f"there is a node {shown(self.new)} already")

        def name_of(name: str) -> str:
            return self.new if name == self.old else name

        def renamed_node(node: Node) -> Node:
            return replace(with_names(node, {self.old: self.new}), id=name_of(node.id))

        try:
            nodes = {name_of(name): renamed_node(node) for name, node in network.nodes.items()}
        except ExpressionError as error:
            raise NetworkError(f"{shown(self.old)} cannot be renamed: {error.message}") from None
        extra: Mapping[str, Any] = network.extra
        for old, new in self.moved(network).items():
            extra = renamed(extra, old, new)
        return replace(
            network,
            nodes=nodes,
            links=tuple(
                replace(link, source=name_of(link.source), target=name_of(link.target))
                for link in network.links
            ),
            layout={name_of(name): at for name, at in network.layout.items()},
            extra=extra,
        )

    def moved(self, network: Network) -> dict[str, str]:
        """The node's name, and those of nodes inside of it."""
        names = of_nodes([self.old], network.nodes)
        return {name: self.new + name.removeprefix(self.old) for name in names}


def keeping_values(
    *,
    network: Network,
    names: Collection[str],
    taking: Operation,
    value_of: Callable[[str, str], Any],
) -> tuple[Operation, tuple[str, ...]]:
    """What takes nodes out, with the values of parameters that follow them put in first.

    Parameters
    ----------
    network : Network
        Before.
    names : collection of str
        The nodes.
    taking : Operation
        What takes them out.
    value_of : callable
        The value of a node's parameter, as `core.network.linked_values.ResolvedNetwork.value`.

    Returns
    -------
    operation : Operation
        One step.
    kept : tuple of str
        ``NODE.PARAMETER = value`` of those that follow nothing any more.
    """
    places = [place for place in naming(network, names) if place[0] not in names]
    if not places:
        return taking, ()
    steps: list[Operation] = []
    kept = []
    for node, parameter in places:
        value = thaw(value_of(node, parameter))
        if not isinstance(value, dict):  # else it had no value, and still has none
            steps.append(set_parameter(node, parameter, value))
            kept.append(f"{shown(node)}.{parameter} = {value}")
    return Together((*steps, taking), taking.text), tuple(kept)


def _finite(name: str, at: Point) -> Point:
    x, y = float(at[0]), float(at[1])
    if not (math.isfinite(x) and math.isfinite(y)):
        raise NetworkError(f"{shown(name)} cannot lie at {x:g}, {y:g}: only at finite numbers")
    return x, y


def fresh_name(wanted: str, taken: Container[str]) -> str:
    """`wanted`, or with the first number behind it that makes it new: ``jitter``, ``jitter_2``."""
    if wanted not in taken:
        return wanted
    head, _, tail = wanted.rpartition("_")
    stem = head if head and tail.isdigit() else wanted
    numbered = (f"{stem}_{number}" for number in itertools.count(2))
    return next(name for name in numbered if name not in taken)
