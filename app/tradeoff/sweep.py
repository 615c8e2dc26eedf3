"""A trade-off: a network evaluated with one parameter at several values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from app.tradeoff.evaluated_points import PointEvaluator
from app.tradeoff.tradeoff_figures import Figure
from core.chain.engine import Engine, Plan
from core.evaluation.work import Work


@dataclass(frozen=True)
class Point:
    """The figures at one value, by ``NODE.READOUT``; `reasons` has why there is none.

    `warnings` has what the nodes warn of there.
    """

    value: Any
    figures: Mapping[str, float] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class TradeOff:
    """Figures of merit as a parameter moves.

    Parameters
    ----------
    node, parameter : str
        What is varied.
    values : tuple
        The values it takes, as a network file has them.
    figures : tuple of Figure
        Figures of the network at each of them.
    """

    node: str
    parameter: str
    values: tuple[Any, ...]
    figures: tuple[Figure, ...]

    def points(self, engine: Engine, plan: Plan, work: Work) -> Iterator[Point]:
        """Evaluate value by value; what the parameter does not touch is made once.

        A value at which the network, or a figure, cannot be evaluated leaves a gap with its reason.

        Parameters
        ----------
        engine : Engine
            Plans and evaluates.
        plan : Plan
            The network as it stands.
        work : Work
            The evaluation, over a store that keeps what the values have in common.

        Raises
        ------
        Cancelled
            When the caller has requested a stop.
        """
        evaluator = PointEvaluator(engine, plan, [(self.node, self.parameter)], self.figures)
        for value in self.values:
            work.check()
            result = evaluator.at((value,), work)
            yield Point(value, result.values, result.reasons, result.warnings)
