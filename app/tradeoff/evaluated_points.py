"""A network evaluated at one point after another; what neighbours have in common is made once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from app.tradeoff.tradeoff_figures import Figure, FigureValues, computed
from core.chain.engine import Engine, Plan
from core.errors import ImagechainError, NetworkError, ParameterError
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.modules.caution import PendingCheck
from core.modules.declaration import declaration
from core.modules.parameters import Parameter, plain
from core.network.network import Network


class PointEvaluator:
    """Figures of a network as some of its parameters take other values.

    Each point is planned from the one before: nodes whose parameters are as they were keep their
    plans, and what these have computed is in the engine's store.

    Parameters
    ----------
    engine : Engine
        Plans and evaluates, over a store that keeps what points have in common.
    plan : Plan
        The network as it stands.
    targets : sequence of (node, parameter)
        What is varied.
    figures : sequence of Figure
        The figures of each point.
    """

    def __init__(
        self,
        engine: Engine,
        plan: Plan,
        targets: Sequence[tuple[str, str]],
        figures: Sequence[Figure],
    ) -> None:
        self.engine, self.figures = engine, tuple(figures)
        self._base, self._targets = plan, tuple(targets)
        self._nodes = frozenset(node for node, _ in targets)
        self._last: tuple[Plan, tuple[Any, ...]] = (plan, (_ABSENT,) * len(self._targets))

    def planned(self, values: Sequence[Any]) -> Plan:
        """The network planned with a value for each of what is varied.

        Raises
        ------
        ParameterError
            For a value that is not allowed, at its node.
        """
        before, known = self._last
        network = before.network
        for (node, name), value, old in zip(self._targets, values, known, strict=True):
            if value is not old and (type(value) is not type(old) or value != old):
                network = self._changed(network, node, name, value)
        plan = self.engine.plan(network, folder=self._base.folder, previous=before)
        self._last = (plan, tuple(values))
        return plan

    def figures_of(self, plan: Plan, work: Work) -> FigureValues:
        """The figures of a planned point, and for those that have no value, why.

        Raises
        ------
        Cancelled
            When the caller has requested a stop.
        """
        return computed(self.figures, self.engine, plan, work, self._nodes)

    def at(self, values: Sequence[Any], work: Work) -> FigureValues:
        """The figures at a point, and its warnings; a value that is refused is their reason.

        Raises
        ------
        Cancelled
            When the caller has requested a stop.
        """
        try:
            plan = self.planned(values)
        except ParameterError as error:
            return FigureValues({}, {figure.text: str(error) for figure in self.figures})
        found = self.figures_of(plan, work)
        return replace(found, warnings=self.warnings_of(plan, work))

    def warnings_of(
        self, plan: Plan, work: Work | None = None, also: Iterable[Recipe] = ()
    ) -> tuple[str, ...]:
        """What the nodes warn of at a planned point, one line each.

        Parameters
        ----------
        plan : Plan
            The point.
        work : Work, optional
            For warnings that look at samples: those are given where the figures, or what is read
            also, take the same samples, whatever the store still holds. None without it.
        also : iterable of Recipe
            What is read beside the figures.

        Raises
        ------
        Cancelled
            When the caller has requested a stop.
        """
        lines = []
        read: set[str] | None = None
        for check in plan.checks():
            if not isinstance(check, PendingCheck):
                lines.append(str(check))
            elif work is not None:
                read = self._read(plan, also) if read is None else read
                if all(recipe.key in read for recipe in check.recipe.needs):
                    caution = check.value(work)
                    lines += [] if caution is None else [str(caution)]
        for node, name in self._targets:
            module = plan.nodes[node].module
            if name == "seed" and getattr(module, "seed_mode", "") == "automatic":
                lines.append(
                    f"{node}: seed varies, and seed_mode is automatic, which does not use it: all "
                    f"points have the same noise; set {node}.seed_mode to typed"
                )
        return tuple(dict.fromkeys(lines))

    def _read(self, plan: Plan, also: Iterable[Recipe]) -> set[str]:
        """Keys of all values that the figures are made of."""
        waiting = list(also)
        for node in dict.fromkeys(figure.node for figure in self.figures if not figure.is_total):
            names = [figure.name for figure in self.figures if figure.node == node]
            with suppress(ImagechainError):  # the figure's reason says so
                values = self.engine.planned_readouts(plan, node, names).values()
                waiting += [value for value in values if isinstance(value, Recipe)]
        known: set[str] = set()
        while waiting:
            recipe = waiting.pop()
            if recipe.key not in known:
                known.add(recipe.key)
                waiting += recipe.needs
        return known

    def _changed(self, network: Network, node: str, name: str, value: Any) -> Network:
        try:
            return with_value(network, self.engine, node, name, value)
        except ParameterError as error:
            raise error.at(node) from error


_ABSENT = object()


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
