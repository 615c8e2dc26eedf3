"""One evaluation of a network for the command line: what it computes and how long it takes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.run.output import find_output, source_images
from app.run.responses import Responses, response, responses
from app.run.transfer_chain import Chain, find_chain
from core.chain.engine import Engine, Plan, asked_for, realize
from core.chain.wires import Curve, Image, Magnitude, Phase, Table, Transfer
from core.errors import ImagechainError
from core.evaluation.recipes import Recipe, Region
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work
from core.machine import Workers
from core.modules.parameters import Caution, PendingCheck
from core.network.network import Network
from core.network.validation import NetworkProblems
from nodes.files.read import check_finite

Readouts = dict[str, dict[str, Any]]


class TimedWork(Work):
    def __init__(
        self,
        policy: Policy,
        store: Store,
        progress: Callable[[str | None], None] | None = None,
        cancel: threading.Event | None = None,
        workers: Workers | None = None,
    ) -> None:
        super().__init__(policy, store, cancel, progress, workers)
        self.seconds: dict[str, float] = {}
        self._lock = threading.Lock()
        self._local = threading.local()

    def _compute(self, recipe: Recipe, region: Region | None = None) -> Any:
        inner = getattr(self._local, "inner", 0.0)
        self._local.inner = 0.0
        start = time.perf_counter()
        try:
            return super()._compute(recipe, region)
        finally:
            whole = time.perf_counter() - start
            own = whole - self._local.inner
            self._local.inner = inner + whole
            name = recipe.node or ""
            with self._lock:
                self.seconds[name] = self.seconds.get(name, 0.0) + own


@dataclass(frozen=True)
class Evaluation:
    plan: Plan
    engine: Engine
    work: TimedWork
    chain: Chain
    responses: Responses
    readouts: Readouts
    cautions: tuple[Caution, ...]
    folder: Path
    seconds: dict[str, float] = field(default_factory=dict)
    way: dict[str, Any] = field(default_factory=dict)
    """In memory or in blocks, and why; empty where nothing was chosen."""

    @property
    def network(self) -> Network:
        return self.plan.network


def planned(engine: Engine, network: Network, folder: Path) -> Plan:
    plan = engine.plan(network, folder=folder)
    errors = plan.errors()
    if errors:
        raise NetworkProblems(errors) from errors[0]
    return plan


def evaluate(engine: Engine, plan: Plan, work: TimedWork, folder: Path) -> Evaluation:
    """Compute inputs, unlinked outputs and read-outs; each recipe is held until its last use."""
    start = time.perf_counter()
    chain = find_chain(plan)
    sources, outputs, figures, checks = _read(engine, plan)
    with work.hold(_recipes(plan, chain.final, sources, outputs, figures, checks)) as held:
        for port, recipes in sources.items():
            _check_source(plan, port, work)
            held.release(recipes)
        checked = time.perf_counter()
        cautions = tuple(engine.warnings(plan, work))
        held.release(checks[""])
        for port, recipes in outputs.items():
            _evaluate_output(plan, port, work)
            held.release(recipes)
        readouts = {}
        for name, recipes in figures.items():
            readouts[name] = engine.readouts(plan, name, work)
            held.release(recipes)
        chain_responses = responses(chain, work)
        if chain.final is not None:
            engine.value(plan, chain.final, work)
    end = time.perf_counter()
    seconds = {"sources": checked - start, "evaluation": end - checked, "total": end - start}
    return Evaluation(
        plan, engine, work, chain, chain_responses, readouts, cautions, folder, seconds
    )


Read = dict[str, tuple[Recipe, ...]]


def _read(engine: Engine, plan: Plan) -> tuple[Read, Read, Read, Read]:
    """What is read: of sources, of unlinked outputs, by read-outs of nodes, and by checks."""
    sources = {port: asked_for(plan.output(port)) for port in source_images(plan)}
    checks = (check.recipe for check in plan.checks() if isinstance(check, PendingCheck))
    outputs = {
        f"{node}.{output}": asked_for(plan.nodes[node].outputs.get(output))
        for node, output in plan.network.unlinked_outputs(engine.library)
    }
    figures = {
        name: tuple(
            value
            for value in engine.planned_readouts(plan, name).values()
            if isinstance(value, Recipe)
        )
        for name, node in plan.nodes.items()
        if not node.node.disabled and node.declaration.readouts
    }
    return sources, outputs, figures, {"": tuple(checks)}


def _recipes(plan: Plan, final: str | None, *groups: Read) -> list[Recipe]:
    read = [recipe for group in groups for recipes in group.values() for recipe in recipes]
    return [*read, *(asked_for(plan.output(final)) if final is not None else ())]


def read_by_evaluation(engine: Engine, plan: Plan) -> list[Recipe]:
    return _recipes(plan, find_output(plan).port, *_read(engine, plan))


def needed_later(
    plan: Plan, ports: Iterable[str], *, report: bool, in_blocks: bool = False
) -> list[Recipe]:
    """What is needed after the evaluation; noises are not followed through pictures on disk."""
    values = [plan.output(port) for port in ports]
    if (final := find_output(plan).port) is not None:
        values.append(plan.output(final))
    for node in plan.nodes.values():
        if hasattr(node.module, "target") and not node.node.disabled:
            values += node.inputs.values()
        shown = Transfer | Image | Curve | Table if report else Transfer
        values += [value for value in node.outputs.values() if isinstance(value, shown)]
    recipes = [recipe for value in values for recipe in asked_for(value)]
    if report and final is not None and not in_blocks:
        from nodes.analysis.lineage import NoiseOf

        recipes.append(NoiseOf(plan.output(final)))
    return recipes


def _check_source(plan: Plan, port: str, work: Work) -> None:
    value: Image = plan.output(port)
    node = port.rpartition(".")[0]
    try:
        check_finite(work.value(value.recipe), port)
    except ImagechainError as error:
        raise error.at(node) from error


def _evaluate_output(plan: Plan, port: str, work: Work) -> None:
    name, _, output = port.rpartition(".")
    value = plan.nodes[name].outputs.get(output)
    sampled = isinstance(value, Transfer) and value.own is not None
    try:
        if isinstance(value, Transfer | Magnitude | Phase) and not sampled:
            # The plane is not used: its factors on two lines show whether it can be made.
            response(work, value.factors, value.grid.xi_half(), "x")
            response(work, value.factors, value.grid.eta(), "y")
        elif value is not None:
            realize(value, work)
    except ImagechainError as error:
        raise error.at(name) from error
