"""One evaluation of a network: what it computes, in memory or in blocks, and how long it takes."""

import contextlib
import shutil
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.run.transfer_chain import (
    Chain,
    Responses,
    find_chain,
    find_output,
    response,
    responses,
    source_images,
)
from core.chain.engine import (
    Engine,
    Plan,
    asked_for,
    largest_picture,
    least_scratch,
    planned_blocks,
    realize,
)
from core.chain.wires import Curve, Image, Magnitude, Phase, SpectrumWire, Table, Transfer
from core.errors import DataError, FileError, ImagechainError, UsageError, several
from core.evaluation.recipes import Recipe, Region
from core.evaluation.store import Store
from core.evaluation.work import BlockRun, Policy, Shape, Work
from core.machine import ScratchDisk, amount_text, is_for_disk, usable_bytes
from core.modules.parameters import Caution, PendingCheck
from core.network.network import Network
from core.network.validation import NetworkProblems
from core.records import dataclass, field
from nodes.files.file_format import ENVI_FRAMES, ZARR
from nodes.files.formats import NPY, TIFF, check_finite

Readouts = dict[str, dict[str, Any]]


class TimedWork(Work):
    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
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
    found = chain_responses, readouts, cautions
    return Evaluation(plan, engine, work, chain, *found, folder, seconds)


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
            v for v in engine.planned_readouts(plan, name).values() if isinstance(v, Recipe)
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


# Whether a run holds its pictures in memory or makes them in blocks, on disk: a choice by size.

Array = NDArray[Any]
STREAMED = (NPY, TIFF, ENVI_FRAMES, ZARR)
"""Formats that are written row after row, or chunk after chunk."""
_PREVIEW_PX = 2048
_SHARE = 0.5  # of what the process may use
_SHARE_KEPT = 8  # of the budget, that values of a run in blocks may take


@dataclass(frozen=True)
class WayOfRunning:
    memory_bytes: int | None  # what pictures may take; None where no limit is known
    largest: Shape = (0, 0)  # of the network's pictures
    needed_bytes: int = 0  # what it takes in memory
    # what they may take after all where a node cannot work in blocks: all memory there is, unless
    # an amount was given
    at_most_bytes: int = 0

    @property
    def in_blocks(self) -> bool:
        return self.memory_bytes is not None and self.needed_bytes > self.memory_bytes

    def on_disk(self, value: Any, policy: Policy) -> bool:
        if not self.in_blocks or self.memory_bytes is None or not isinstance(value, Image):
            return False
        return is_for_disk(value.shape, policy.dtype, self.memory_bytes)

    def store(self, otherwise: Store | None) -> Store | None:
        if not self.in_blocks or self.memory_bytes is None:
            return otherwise
        return Store(self.memory_bytes // _SHARE_KEPT)

    def facts(self, blocks: BlockRun | None) -> dict[str, Any]:
        way = "in memory" if blocks is None else "in blocks"
        facts: dict[str, Any] = {"way": way, "memory_bytes": self.memory_bytes}
        if self.needed_bytes:
            facts |= {"largest_rows": self.largest[0], "largest_columns": self.largest[1]}
            facts["in_memory_bytes"] = self.needed_bytes
        if blocks is not None:
            disk = blocks.disk
            facts |= {"scratch_bytes": disk.most_bytes, "scratch_arrays": disk.files}
        return facts


def way_of_running(plan: Plan, policy: Policy, memory_bytes: int | None) -> WayOfRunning:
    """The way for a network under a budget, by default half of what the process may use."""
    largest = largest_picture(plan, policy)
    if memory_bytes is not None:
        return WayOfRunning(memory_bytes, *largest)
    usable = usable_bytes()
    if usable is None:
        return WayOfRunning(None, *largest)
    return WayOfRunning(int(usable * _SHARE), *largest, usable)


def way_in_words(facts: dict[str, Any]) -> str:
    largest = f"{facts['largest_rows']} × {facts['largest_columns']} samples"
    needed, allowed = amount_text(facts["in_memory_bytes"]), amount_text(facts["memory_bytes"])
    if facts["way"] == "in memory":
        return f"in memory: pictures of {largest} take up to {needed}; the limit is {allowed}"
    return (
        f"in blocks: pictures of {largest} would take up to {needed} in memory, but the limit is "
        f"{allowed}; up to {amount_text(facts['scratch_bytes'])} were on disk in "
        f"{several(facts['scratch_arrays'], 'array')}, transformed by rows and columns"
    )


@contextlib.contextmanager
def blocks_of(
    way: WayOfRunning,
    engine: Engine,
    plan: Plan,
    policy: Policy,
    *,
    ports: Sequence[str],
    report: bool,
    scratch: Path,
) -> Iterator[BlockRun | None]:
    """What a run in blocks keeps on disk, as long as it is open; None for a run in memory."""
    if not way.in_blocks or way.memory_bytes is None:
        yield None
        return
    with ScratchDisk(scratch, way.memory_bytes) as disk:
        _refuse_planes(plan, ports, disk, policy)
        later = needed_later(plan, ports, report=report, in_blocks=True)
        recipes = [*read_by_evaluation(engine, plan), *later]
        try:
            blocks = planned_blocks(plan, recipes, disk, policy)
        except DataError:
            if way.needed_bytes > way.at_most_bytes:
                raise
            yield None
            return
        _refuse_without_room(least_scratch(recipes, blocks, policy), scratch)
        yield blocks


def is_streamed(image: Image, path: Path, *, on_disk: bool) -> bool:
    if ENVI_FRAMES.matches(path):
        return image.bands is None
    return on_disk and TIFF.matches(path)


def reduced(samples: Array, work: Work) -> Array:
    """A picture as it is; one that is made in blocks as means of as many samples as shows it."""
    if work.blocks is None or not work.blocks.disk.wants(samples.shape, samples.dtype):
        return samples
    step = -(-max(samples.shape) // _PREVIEW_PX)
    rows, columns = (size // step for size in samples.shape)
    if not rows or not columns:
        return samples[::step, ::step]
    made = np.empty((rows, columns), samples.dtype)
    for row in range(rows):
        lines = samples[row * step : (row + 1) * step, : columns * step]
        made[row] = lines.reshape(step, columns, step).mean(axis=(0, 2), dtype=np.float64)
    return made


def check_streamed(port: str, image: Image, path: Path, frames: int | None) -> None:
    """Refuse a format in which a picture on disk cannot be written row after row, and frames."""
    if frames is not None and frames > 1:
        raise UsageError(
            f"{frames} frames: a picture of {image.rows} × {image.columns} samples is "
            "computed in blocks and can have only one frame. Save 1 frame, or run "
            "again with another seed"
        )
    if not any(kind.matches(path) for kind in STREAMED):
        words = ", ".join(suffix for kind in STREAMED for suffix in kind.suffixes)
        raise UsageError(
            f"--save {port}={path}: a picture of {image.rows} × {image.columns} samples that is "
            f"computed in blocks must be written as {words}"
        )


def _refuse_planes(plan: Plan, ports: Iterable[str], disk: ScratchDisk, policy: Policy) -> None:
    for port in ports:
        value: Any = plan.output(port)
        plane = isinstance(value, SpectrumWire | Transfer)
        if plane and disk.wants(value.grid.shape, policy.dtype):
            raise UsageError(
                f"--save {port}: a {value.port_type} of {value.grid.rows} × {value.grid.columns} "
                "samples must be computed all at once but does not fit in --memory "
                f"{amount_text(disk.memory_bytes)}"
            )


def _refuse_without_room(needed: int, scratch: Path) -> None:
    try:
        free = shutil.disk_usage(scratch).free
    except OSError as error:
        reason = error.strerror or error
        raise FileError(f"cannot write to the scratch folder {scratch}: {reason}") from error
    if needed > free:
        raise FileError(
            f"the scratch folder {scratch} has {amount_text(free)} free, and a run in blocks "
            f"needs at least {amount_text(needed)}: choose another folder",
            hint="name the folder with --scratch",
        )
