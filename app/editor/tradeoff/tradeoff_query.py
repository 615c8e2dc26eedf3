"""The query of the trade-off dock: figures at some values of a parameter."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from app.editor.evaluation.queries import Passing, Query
from app.editor.tradeoff.side_work import SideWork
from app.run.output import ancestors
from app.tradeoff.evaluated_points import parameter_of
from app.tradeoff.sweep import Point, TradeOff
from app.tradeoff.tradeoff_figures import Figure
from core.chain.engine import Plan


@dataclass(frozen=True)
class Part:
    """Points of a trade-off; parts of the same `state` of the network belong together."""

    state: Hashable
    points: tuple[Point, ...]


@dataclass(frozen=True)
class TradeOffQuery(Query):
    """Figures at these values; the whole trade-off takes several queries, the coarsest first.

    Nodes that are held back count as generated.
    """

    waits: ClassVar[bool] = True

    node: str
    parameter: str
    values: tuple[Any, ...]
    figures: tuple[Figure, ...]

    def key(self, plan: Plan) -> Hashable:
        """The question, and all that the figures depend on but the parameter that is varied."""
        return self, self._state(plan)

    def answer(self, passing: Passing) -> Part:
        """The points."""
        parameter_of(passing.plan.network, passing.engine, self.node, self.parameter)
        sweep = TradeOff(self.node, self.parameter, self.values, self.figures)
        points = sweep.points(passing.engine, passing.plan, SideWork(passing.work))
        return Part(self._state(passing.plan), tuple(points))

    def _state(self, plan: Plan) -> Hashable:
        network = plan.network
        names = {figure.node for figure in self.figures if not figure.is_total}
        # A parameter that follows others hangs on nodes that no wire leads from.
        linked = any(node.linked for node in network.nodes.values())
        everything = linked or any(f.is_total for f in self.figures)
        asked = {*network.nodes} if everything else set(names)
        for name in names & {*network.nodes}:
            asked |= ancestors(network, name)
        nodes = []
        for name in sorted({*asked, self.node} & {*network.nodes}):
            node = network.nodes[name]
            params = {n: v for n, v in node.params.items() if (name, n) != self._varied}
            values = repr(sorted(params.items()))
            nodes.append((name, node.module, node.disabled, values, _files(plan, name)))
        links = tuple(link for link in network.links if link.target in asked)
        return tuple(nodes), links, network.seed, network.marked, repr(network.extra.get("final"))

    @property
    def _varied(self) -> tuple[str, str]:
        return self.node, self.parameter


def _files(plan: Plan, name: str) -> Hashable:
    """What a node that reads a file has found there: it may have changed meanwhile."""
    planned = plan.nodes.get(name)
    if planned is None or planned.module is None:
        return None
    if not any(isinstance(value, Path) for value in planned.module.values().values()):
        return None
    return tuple(getattr(value, "key", None) for value in planned.outputs.values())
