"""A trade-off: a network evaluated with one parameter at several values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from app.tradeoff.tradeoff_figures import Figure, computed
from core.chain.engine import Engine, Plan
from core.errors import NetworkError, ParameterError
from core.evaluation.work import Work
from core.modules.declaration import declaration
from core.modules.parameters import Parameter, plain
from core.network.network import Network


@dataclass(frozen=True)
class Point:
    """The figures at one value, by ``NODE.READOUT``; `reasons` has why there is none."""

    value: Any
    figures: Mapping[str, float] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)


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
        for value in self.values:
            work.check()
            try:
                network = with_value(plan.network, engine, self.node, self.parameter, value)
            except ParameterError as error:
                reason = str(error.at(self.node))
                yield Point(value, {}, {figure.text: reason for figure in self.figures})
                continue
            varied = engine.plan(network, folder=plan.folder, previous=plan)
            result = computed(self.figures, engine, varied, work, self.node)
            yield Point(value, result.values, result.reasons)


def with_value(network: Network, engine: Engine, node: str, parameter: str, value: Any) -> Network:
    """The network with a parameter at a value.

    Raises
    ------
    ParameterError
        If the value is not allowed, or stands for an empty parameter without saying so.
    """
    declared = parameter_of(network, engine, node, parameter)
    coerced = declared.coerce(value)
    if coerced is None and value is not None:
        raise ParameterError(parameter, value, "it stands for an empty parameter, as null does")
    return network.with_parameter(node, parameter, plain(coerced))


def parameter_of(network: Network, engine: Engine, node: str, parameter: str) -> Parameter:
    """The declaration of a parameter.

    Raises
    ------
    NetworkError
        If there is no such node, or its module has no such parameter.
    """
    module = engine.library.get(network.node(node).module)
    declared = declaration(module).parameter(parameter) if module is not None else None
    if declared is None:
        raise NetworkError(f"{node} has no parameter {parameter}")
    return declared
