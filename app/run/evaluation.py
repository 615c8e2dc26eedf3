"""One evaluation of a network: in memory or in blocks, how long it takes, and its main figures."""

import contextlib
import shutil
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from app.run import transfer_chain
from app.run.terminal import four_digits, number_text, sized, without_rounding
from core.arrays import Array
from core.chain.engine import Engine, Plan, asked_for, least_scratch, realize
from core.chain.wires import Curve, Image, Magnitude, Phase, SpectrumWire, Table, Transfer
from core.errors import DataError, FileError, ImagechainError, UsageError, placed, several
from core.evaluation.recipes import Recipe, Region
from core.evaluation.work import BlockRun, Policy, Shape, Work
from core.machine import ScratchDisk, amount_text, is_for_disk, usable_bytes
from core.modules.parameters import Caution, PendingCheck
from core.network.network import Network
from core.network.validation import NetworkProblems
from core.records import dataclass, field
from nodes.files.file_format import ENVI_FRAMES, ZARR
from nodes.files.formats import NPY, TIFF, check_finite
from nodes.input_output.sample_unit import statistics

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
    chain: transfer_chain.Chain
    responses: transfer_chain.Responses
    readouts: Readouts
    cautions: tuple[Caution, ...]
    seconds: dict[str, float] = field(default_factory=dict)
    way: dict[str, Any] = field(default_factory=dict)
    """In memory or in blocks, and why; empty where nothing was chosen."""

    @property
    def network(self) -> Network:
        return self.plan.network


def planned(engine: Engine, network: Network, folder: Path) -> Plan:
    return refuse_faults(engine.plan(network, folder=folder))


def refuse_faults(plan: Plan) -> Plan:
    if errors := plan.errors():
        raise NetworkProblems(errors) from errors[0]
    return plan


def evaluate(engine: Engine, plan: Plan, work: TimedWork) -> Evaluation:
    """Compute inputs, unlinked outputs and read-outs; each recipe is held until its last use."""
    start = time.perf_counter()
    chain = transfer_chain.find_chain(plan)
    sources, outputs, figures, checks = _read(engine, plan)
    with work.hold(_recipes(plan, chain.final, sources, outputs, figures, checks)) as release:
        for port, recipes in sources.items():
            with placed(port.rpartition(".")[0]):
                check_finite(work.value(plan.output(port).recipe), port)
            release(recipes)
        checked = time.perf_counter()
        cautions = tuple(engine.warnings(plan, work))
        release(checks[""])
        for port, recipes in outputs.items():
            _evaluate_output(plan, port, work)
            release(recipes)
        readouts = {}
        for name, recipes in figures.items():
            readouts[name] = engine.readouts(plan, name, work)
            release(recipes)
        chain_responses = transfer_chain.responses(chain, work)
        if chain.final is not None:
            engine.value(plan, chain.final, work)
    end = time.perf_counter()
    seconds = {"sources": checked - start, "evaluation": end - checked, "total": end - start}
    found = chain_responses, readouts, cautions
    return Evaluation(plan, engine, work, chain, *found, seconds)


Read = dict[str, tuple[Recipe, ...]]


def _read(engine: Engine, plan: Plan) -> tuple[Read, Read, Read, Read]:
    """What is read: of sources, of unlinked outputs, by read-outs of nodes, and by checks."""
    sources = {port: asked_for(plan.output(port)) for port in transfer_chain.source_images(plan)}
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


def needed_later(
    plan: Plan, ports: Iterable[str], *, report: bool, in_blocks: bool = False
) -> list[Recipe]:
    """What is needed after the evaluation; noises are not followed through pictures on disk."""
    values = [plan.output(port) for port in ports]
    if (final := transfer_chain.find_output(plan).port) is not None:
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


def _evaluate_output(plan: Plan, port: str, work: Work) -> None:
    name, _, output = port.rpartition(".")
    value = plan.nodes[name].outputs.get(output)
    sampled = isinstance(value, Transfer) and value.own is not None
    with placed(name):
        if isinstance(value, Transfer | Magnitude | Phase) and not sampled:
            # The plane is not used: its factors on two lines show whether it can be made.
            transfer_chain.response(work, value.factors, value.grid.axes("periodic")[0], "x")
            transfer_chain.response(work, value.factors, value.grid.eta(), "y")
        elif value is not None:
            realize(value, work)


# Whether a run holds its pictures in memory or makes them in blocks, on disk: a choice by size.

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

    @property
    def store_bytes(self) -> int | None:
        """What values may take in the store; None where the store's own limit holds."""
        if not self.in_blocks or self.memory_bytes is None:
            return None
        return self.memory_bytes // _SHARE_KEPT

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
    largest = plan.largest_picture(policy)
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
        f"{allowed}; {several(facts['scratch_arrays'], 'temporary array')} took up to "
        f"{amount_text(facts['scratch_bytes'])} on disk"
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
        final = transfer_chain.find_output(plan).port
        recipes = [*_recipes(plan, final, *_read(engine, plan)), *later]
        try:
            blocks = plan.blocks(recipes, disk, policy)
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
    return (
        samples[::step, ::step] if min(samples.shape) < step else block_means(samples, step, step)
    )


def block_means(samples: Array, down: int, across: int) -> Array:
    made = np.empty((samples.shape[0] // down, samples.shape[1] // across), samples.dtype)
    for row in range(len(made)):  # one after the other: the picture may be larger than memory
        lines = samples[row * down : (row + 1) * down, : made.shape[1] * across]
        made[row] = lines.reshape(down, -1, across).mean(axis=(0, 2), dtype=np.float64)
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
            f"needs at least {amount_text(needed)}. Choose another folder",
            hint="name the folder with --scratch",
        )


ELECTRONICS_FIGURES = (
    ("g_number", "G#"),
    ("bandwidth_Hz", "Bandwidth"),
    ("ner", "NER"),
    ("netd_detector_K", "NETD detector"),
    ("netd_system_K", "NETD system"),
    ("snr", "SNR"),
    ("quantization_rms", "Quantization"),
)
SENSOR_FIGURES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "electronics_noise": ELECTRONICS_FIGURES,
    "focal_plane": (
        ("well_fill_percent", "Well fill"),
        ("signal_e", "Signal"),
        ("temporal_noise_e", "Noise"),
        ("fixed_pattern_e", "Fixed pattern"),
        ("netd_K", "NETD"),
        ("snr", "SNR"),
        ("dynamic_range_dB", "Dynamic range"),
    ),
    "microbolometer": (
        ("netd_K", "NETD"),
        ("white_netd_K", "White noise"),
        ("flicker_K", "1/f noise"),
        ("fixed_pattern_K", "Fixed pattern"),
        ("noise_radiance", "NER"),
        ("snr", "SNR"),
        ("lag_percent", "Lag"),
    ),
}
"""Read-outs and captions by the key of the detector's or the electronics' module."""

_MERITS: Mapping[str, tuple[tuple[tuple[str, ...], str], ...]] = {
    "measured_mtf": ((("mtf50",), "MTF50, measured"),),
    "noise_3d": ((("temporal", "fixed"), "Noise: temporal, fixed"),),
    "compare_images": ((("rmse",), "RMS difference"), (("max_error",), "Largest difference")),
    "line_by_line": ((("rms_percent",), "RMS difference"),),
    "camera_geometry": ((("swath_m",), "Swath"), (("gsd_x_m", "gsd_y_m"), "GSD")),
    "figures_of_merit": (
        (
            ("detection_range_km", "recognition_range_km", "identification_range_km"),
            "Range: detect, recognise, identify",
        ),
        (("ttp_range_km",), "TTP range"),
    ),
    "dual_gain": (
        (("dynamic_range_dB",), "Dynamic range, combined"),
        (("low_percent",), "Samples taken at low gain"),
    ),
    "image_quality": ((("gsd_m",), "GSD"), (("giqe5",), "NIIRS by GIQE 5")),
}
"""Read-outs in one line and their caption, of the modules that measure and judge."""


Figure = dict[str, Any]
"""One line of the summary: `caption`, `values` of one `unit`, and the `node` that they are of."""


def _figure(caption: str, values: tuple[Any, ...], unit: str, node: str) -> Figure:
    return {"caption": caption, "values": values, "unit": unit, "node": node}


def main_figures(evaluation: Evaluation) -> list[Figure]:
    """What an engineer looks for first: about ten lines; what a network lacks is left out."""
    plan = evaluation.plan
    figures = _output_figures(evaluation)
    sensor = sensor_node(plan)
    if sensor is not None:
        declared = SENSOR_FIGURES[plan.nodes[sensor].node.module]
        figures += _of_node(evaluation, sensor, [((name,), text) for name, text in declared])
    figures += _mtf_figures(evaluation)
    for module, wanted in _MERITS.items():
        for name, node in plan.nodes.items():
            if node.node.module == module:
                figures += _of_node(evaluation, name, wanted)
    return figures


def figure_rows(
    figures: Iterable[Figure], text: Callable[[Any], str] = number_text
) -> list[tuple[str, str, str, str]]:
    """Caption, values, unit and node of each figure as text, in the sizes that data sheets use."""
    rows = []
    for figure in figures:
        shown = [sized(value, figure["unit"]) for value in figure["values"]]
        units = {unit for value, unit in shown if value}
        if len(units) > 1:  # no size suits all
            shown = [(four_digits(value), figure["unit"]) for value in figure["values"]]
            units = {figure["unit"]}
        values = [text(value) for value, _ in shown]
        if len(set(values)) == 1:
            del values[1:]
        unit = next(iter(units), figure["unit"])
        rows.append((figure["caption"], ", ".join(values), unit, figure["node"]))
    return rows


class ReadoutRow(NamedTuple):
    """One read-out; `value` is None if the read-out has no value."""

    node: str
    name: str
    value: Any
    unit: str
    meaning: str

    @property
    def texts(self) -> tuple[str, str, str, str]:
        """Node, name, value and unit as people read them."""
        value = number_text(without_rounding(self.value, self.unit))
        return self.node, self.name, value, self.unit


def each_readout(evaluation: Evaluation) -> Iterator[ReadoutRow]:
    for node, values in evaluation.readouts.items():
        planned = evaluation.plan.nodes[node]
        units = planned.units
        for one in planned.declaration.readouts:
            if one.name in values:
                value, unit = values[one.name], units[one.name]
                yield ReadoutRow(node, one.name, value, unit, one.meaning)


def sensor_node(plan: Plan, preferred: str | None = None) -> str | None:
    """The node whose figures are shown: the preferred, else the last that leads to the output."""
    nodes, links = plan.network.nodes, plan.network.links
    named = [name for name, node in nodes.items() if node.module in SENSOR_FIGURES]
    # Budgets behind a Dual Gain count the noise of its high gain: so do these figures.
    ends = ((one.source, nodes[one.target].module, one.input) for one in links)
    low = {source for source, *end in ends if end == ["dual_gain", "low"]}
    named = [name for name in named if name not in low] or named
    if not named or preferred in named:
        return preferred if named else None
    leading = set(named)
    try:
        output = transfer_chain.find_output(transfer_chain.sound_part(plan))
    except ImagechainError:
        output = transfer_chain.Output(None)
    if output.choices and len(named) > 1:
        return None
    if output.port is not None:
        last = output.port.rpartition(".")[0]
        leading = transfer_chain.ancestors(plan.network, last) | {last}
    order = [name for name in plan.nodes if name in named]
    return next((name for name in reversed(order) if name in leading), order[-1])


def _of_node(
    evaluation: Evaluation, name: str, wanted: Iterable[tuple[tuple[str, ...], str]]
) -> list[Figure]:
    units, found = evaluation.plan.nodes[name].units, evaluation.readouts.get(name, {})
    return [
        _figure(caption, tuple(found[each] for each in names), units[names[0]], name)
        for names, caption in wanted
        if all(found.get(each) is not None for each in names)
    ]


def _output_figures(evaluation: Evaluation) -> list[Figure]:
    port = evaluation.chain.final
    if port is None:
        return []
    image: Image = evaluation.plan.output(port)
    seen = statistics(realize(image, evaluation.work), for_each=evaluation.work.for_each)
    values = (seen.minimum, seen.mean, seen.maximum)
    return [_figure("Output: minimum, mean, maximum", values, image.unit, port)]


def _mtf_figures(evaluation: Evaluation) -> list[Figure]:
    chain, work = evaluation.chain, evaluation.work
    if chain.grid is None or not chain.cascade or not chain.stages:
        return []
    caption, places = "MTF at Nyquist", (chain.grid.nyquist_x, chain.grid.nyquist_y)
    of_pixels = chain.pixel_nyquist
    if of_pixels[0] is not None and of_pixels[1] is not None:
        caption, places = "MTF at the pixels' Nyquist", (of_pixels[0], of_pixels[1])
    axes: tuple[transfer_chain.Axis, transfer_chain.Axis] = ("x", "y")
    pairs = zip(axes, places, strict=True)
    values = tuple(transfer_chain.mtf_at(work, chain.factors, place, axis) for axis, place in pairs)
    at = " × ".join(dict.fromkeys(f"{place:.4g}" for place in places))
    return [_figure(f"{caption} ({at} cyc/mrad)", values, "", "all stages")]
