"""Evaluating a network: plan every node in microseconds, then compute only what is requested."""

import threading
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from core.chain import wires
from core.chain.back_transformed import Delivered
from core.chain.band_stack import BandStack
from core.chain.wires import Curve, Image, SpectrumWire, Table, Transfer
from core.errors import (
    DataError,
    ImagechainError,
    NetworkError,
    ParameterError,
    UnconnectedError,
    watched,
)
from core.evaluation.recipes import Recipe, Region, Step, Store, furthest_first
from core.evaluation.work import BlockRun, Policy, Shape, Work
from core.machine import ScratchDisk, Workers, amount_text
from core.modules.declaration import Declaration, Library, Module, NodeContext, declaration
from core.modules.parameters import Caution, PendingCheck, checked
from core.network.linked_values import with_values
from core.network.network import Link, Network, Node, passed_through
from core.records import dataclass, field


@dataclass(frozen=True)
class PlannedNode:
    """A node with its module, what comes in and what goes out; or why it has none."""

    node: Node
    module: Module | None = None
    inputs: Mapping[str, Any] = field(default_factory=dict)
    outputs: Mapping[str, Any] = field(default_factory=dict)
    result: Any = None
    error: ImagechainError | None = None

    def sound(self) -> "PlannedNode":
        """Itself; what is wrong with it is raised."""
        if self.error is not None:
            raise self.error
        return self

    @property
    def declaration(self) -> Declaration:
        assert self.module is not None
        return declaration(type(self.module))

    @property
    def units(self) -> dict[str, str]:
        """Unit of each read-out, which may be that of a picture that comes in."""
        return {
            one.name: getattr(self.inputs.get(one.unit_of), "unit", "") if one.unit_of else one.unit
            for one in self.declaration.readouts
        }

    @cached_property
    def checks(self) -> tuple[Caution | PendingCheck, ...]:
        """What its module warns of, or would if it saw the samples.

        Nothing of a node that has an error or is disabled.
        """
        if self.error is not None or self.module is None or self.node.disabled:
            return ()
        known = {**self.inputs, "outputs": self.result, "given": frozenset(self.node.params)}
        results = []
        for check, _, needs in self.declaration.warnings:
            bound = partial(getattr(self.module, check), *(known[name] for name in needs))
            results.append(checked(bound, node=self.node.id, check=check))
        if not type(self.module).counts_bands:
            results.append(sum_caution(self.inputs, self.outputs, node=self.node.id))
        return tuple(result for result in results if result is not None)

    @property
    def warnings(self) -> tuple[Caution, ...]:
        return tuple(check for check in self.checks if isinstance(check, Caution))

    @cached_property
    def is_neutral(self) -> bool:
        """Whether it passes all it works on as it is, and has no data for what follows."""
        pairs = [(self.inputs.get(port), value) for port, value in self.outputs.items()]
        through = [(given, value) for given, value in pairs if given is not None]
        if any(getattr(value, "own", None) is not None for value in self.outputs.values()):
            return False  # a transfer function to look at has been made
        return bool(through) and all(
            given is value
            # The samples may be as they were; what follows takes the camera's data from it.
            or (
                getattr(given, "camera", None) == getattr(value, "camera", None)
                and getattr(given, "key", None) == getattr(value, "key", None)
            )
            for given, value in through
        )


@dataclass(frozen=True)
class Plan:
    """Every node of a network planned: recipes, no arrays."""

    network: Network
    nodes: Mapping[str, PlannedNode]
    folder: Path = Path()

    def output(self, port: str) -> Any:
        """The value on ``node.port``; a macro's port stands for one inside."""
        name, _, output = self.network.port_names.get(port, port).rpartition(".")
        planned = self.node(name).sound()
        if output not in planned.outputs:
            known = ", ".join(planned.outputs) or "none"
            raise NetworkError(f"{port}: {name} has no output {output!r}; its outputs: {known}")
        return planned.outputs[output]

    def node(self, name: str) -> PlannedNode:
        if name not in self.nodes:
            known = ", ".join(self.nodes) or "none"
            raise NetworkError(f"the network has no node {name!r}; its nodes: {known}")
        return self.nodes[name]

    def errors(self) -> list[ImagechainError]:
        errors = (planned.error for planned in self.nodes.values())
        return list(dict.fromkeys(error for error in errors if error is not None))

    def checks(self) -> list[Caution | PendingCheck]:
        """What the nodes warn of, or would if they saw the samples, in order."""
        return [check for planned in self.nodes.values() for check in planned.checks]

    def warnings(self) -> list[Caution]:
        """What the nodes warn of without looking at samples, in order."""
        return [check for check in self.checks() if isinstance(check, Caution)]

    @property
    def images(self) -> list[Image]:
        outputs = (value for node in self.nodes.values() for value in node.outputs.values())
        return [value for value in outputs if isinstance(value, Image)]

    def largest_picture(self, policy: Policy) -> tuple[Shape, int]:
        """The largest picture that is planned, and the memory it takes; empty without any."""
        shapes = {value.shape for value in self.images}
        rows, columns = max(shapes, key=lambda shape: shape[0] * shape[1], default=(0, 0))
        return (rows, columns), rows * columns * policy.dtype.itemsize * IN_MEMORY_AT_ONCE

    def blocks(self, recipes: Iterable[Recipe], disk: ScratchDisk, policy: Policy) -> BlockRun:
        """What a run in blocks keeps on disk, where it reads the values of all these recipes."""
        pictures = {value.key: value.shape for value in self.images}
        on_disk: dict[str, Shape] = {}
        for recipe in _furthest_first(recipes):
            shape = _shape(recipe, pictures)
            if shape is not None:
                pictures[recipe.key] = shape
                if disk.wants(shape, policy.dtype):
                    on_disk[recipe.key] = shape
            made_of = (*recipe.inputs, recipe)
            large = [on_disk[one.key] for one in made_of if one.key in on_disk]
            held = recipe.held_size
            if held is not None and not disk.wants(held, policy.dtype):
                continue
            if large and not recipe.in_blocks:
                raise _refusal(recipe, max(large), disk)
        return BlockRun(disk, on_disk)


class Engine:
    """Plans and evaluates networks of a library's modules; one store keeps the computed values."""

    def __init__(self, library: Library, store: Store | None = None) -> None:
        self.library = library
        self.store = store if store is not None else Store()
        self.workers = Workers()
        """The threads that its evaluations share."""

    def plan(
        self,
        network: Network,
        *,
        folder: Path | None = None,
        previous: Plan | None = None,
        held: Mapping[str, PlannedNode] | None = None,
    ) -> Plan:
        """Run every module's planning in order; an error stays on its node.

        Nodes that hang on a failed one carry that node's error. From a `previous` plan of an
        earlier state of the network, what has not changed since is taken over. Nodes in `held` are
        not planned but stay as they are there, and the nodes after them are planned on that.

        Expressions of parameters are evaluated here: planned nodes have plain values, the plan's
        network has the expressions.
        """
        planned: dict[str, PlannedNode] = {}
        folder = folder or Path()
        known = {} if previous is None or previous.folder != folder else previous.nodes
        if previous is not None and previous.network.seed != network.seed:
            known = {}
        held = held or {}

        def before(name: str) -> Node | None:
            return known[name].node if name in known else None

        resolved = with_values(network, library=self.library, known=before)
        valued = resolved.network
        for name in valued.order():
            earlier = known.get(name)
            if name in held:
                planned[name] = held[name]
            elif name in resolved.faults:
                planned[name] = PlannedNode(valued.nodes[name], error=resolved.faults[name][0])
            elif earlier is not None and _unchanged(valued, name, planned, earlier):
                planned[name] = earlier
            else:
                planned[name] = self._plan_node(valued, name, planned, folder)
        return Plan(network, planned, folder)

    def work(
        self,
        policy: Policy,
        *,
        cancel: threading.Event | None = None,
        progress: Callable[[str | None], None] | None = None,
    ) -> Work:
        return Work(policy, self.store, cancel, progress, self.workers)

    def value(self, plan: Plan, port: str, work: Work, region: Region | None = None) -> Any:
        """The computed value of one ``node.port``.

        Of an image, a `region` gives the samples that the whole picture has there, to the bit,
        and computes no more than they need.
        """
        value = plan.output(port)
        with watched(port.rpartition(".")[0]):
            return realize(value, work, region)

    def readouts(
        self, plan: Plan, node: str, work: Work, names: Collection[str] | None = None
    ) -> dict[str, Any]:
        """Values of a node's read-outs by name; of those in `names`, if given."""
        values = self.planned_readouts(plan, node, names)
        recipes = [value for value in values.values() if isinstance(value, Recipe)]
        with work.hold(recipes) as release:
            for name, value in values.items():
                if isinstance(value, Recipe):
                    with watched(node):
                        values[name] = work.value(value)
                    release([value])
        return values

    def why_none(self, plan: Plan, node: str, work: Work, name: str) -> str:
        """Why a read-out has no value, where its module gives the reason; else an empty text."""
        value = self.planned_readouts(plan, node, (name,)).get(name)
        reason = value.reason if isinstance(value, Step) else None
        return "" if reason is None else str(work.value(reason))

    def warnings(self, plan: Plan, work: Work, *, known_only: bool = False) -> list[Caution]:
        """What the nodes warn of, those warnings included for which samples are looked at.

        With `known_only` these are left out where the samples have not been computed so far.
        """
        cautions = []
        for check in plan.checks():
            if isinstance(check, Caution):
                cautions.append(check)
            elif not known_only or check.is_ready(work):
                caution = check.value(work)
                cautions += [] if caution is None else [caution]
        return cautions

    def planned_readouts(
        self, plan: Plan, node: str, names: Collection[str] | None = None
    ) -> dict[str, Any]:
        """A node's read-outs as values, or as recipes where they have to be computed."""
        planned = plan.node(node).sound()
        values: dict[str, Any] = {}
        if planned.result is None and planned.node.disabled:
            return values
        known = {**planned.inputs, "outputs": planned.result}
        for readout in planned.declaration.readouts:
            if names is not None and readout.name not in names:
                continue
            arguments = {name: known[name] for name in readout.needs}
            arguments |= {"axis": readout.axis} if readout.axis else {}
            with watched(node, planned.node.module):
                values[readout.name] = getattr(planned.module, readout.method)(**arguments)
        return values

    def _plan_node(
        self, network: Network, name: str, planned: Mapping[str, PlannedNode], folder: Path
    ) -> PlannedNode:
        node, inputs = network.nodes[name], dict[str, Any]()
        try:
            with watched(name, node.module):
                module_class = self.library.get(node.module)
                if module_class is None:
                    raise NetworkError(f"module {node.module!r} is not in the library", node=name)
                module = module_class.build(node.params)
                module.check()
                described = declaration(module_class)
                for link in network.links_into(name):
                    source = planned.get(link.source)
                    if source is not None and source.error is not None:
                        return PlannedNode(node, module, error=source.error)
                    inputs[link.input] = _brought(link, source, described, inputs)
                for port in described.inputs:
                    if port.name not in inputs:
                        if port.required:
                            raise UnconnectedError(f"input {port.name} is not connected", node=name)
                        inputs[port.name] = None
                if node.disabled:
                    return PlannedNode(node, module, inputs, _passed(described, inputs))
                here = NodeContext(name, network.seed, folder, node.noise)
                hints = module.run.__annotations__.items()
                own = (NodeContext, "NodeContext")
                result = module.run(**inputs, **{arg: here for arg, hint in hints if hint in own})
                outputs = result._asdict() if result is not None else {}
                return PlannedNode(node, module, inputs, outputs, result)
        except ImagechainError as error:
            return PlannedNode(node, inputs=inputs, error=error)


def _unchanged(
    network: Network, name: str, planned: Mapping[str, PlannedNode], earlier: PlannedNode
) -> bool:
    if earlier.node is not network.nodes[name] or earlier.module is None or earlier.error:
        return False
    if any(isinstance(value, Path) for value in vars(earlier.module).values()):
        return False  # a file may have changed meanwhile
    links = network.links_into(name)
    linked = sum(value is not None for value in earlier.inputs.values())
    return len(links) == linked and all(
        link.source in planned
        and earlier.inputs.get(link.input) is planned[link.source].outputs.get(link.output)
        and earlier.inputs.get(link.input) is not None
        for link in links
    )


def _brought(
    link: Link, source: PlannedNode | None, described: Declaration, inputs: Mapping[str, Any]
) -> Any:
    """What a link brings to its input; for networks that have not been validated."""
    port = described.input(link.input)
    if port is None:
        raise NetworkError(f"{described.title} has no input {link.input!r}")
    if link.input in inputs:
        raise NetworkError(f"the input {link.input} has two links; only one is allowed")
    if source is None or link.output not in source.outputs:
        raise NetworkError(f"the link {link} starts at an output that does not exist")
    value = source.outputs[link.output]
    if value.port_type not in port.types:
        kinds = " or ".join(port.types)
        raise NetworkError(
            f"{link.source}.{link.output} does not fit the input {link.input}, which takes {kinds}"
        )
    return value


def _passed(described: Declaration, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Outputs of a disabled node: what passes through, and transfer functions of 1 or 0."""
    through = passed_through(described)
    passed = {output: inputs[source] for output, source in through.items()}
    grids = [value.grid for value in inputs.values() if isinstance(value, SpectrumWire)]
    for port in described.outputs:
        if port.name in ("mtf", "ptf") and port.name not in passed and grids:
            passed[port.name] = Transfer(grids[0], "ptf" if port.name == "ptf" else "mtf")
    return {name: value for name, value in passed.items() if value is not None}


# The warning of a module that takes the sum of a picture's bands, as it knows none.


def bands_of(value: Any) -> BandStack | None:
    image = value.image if isinstance(value, SpectrumWire) else value
    return image.bands if isinstance(image, Image) else None


def sum_caution(
    inputs: Mapping[str, Any], outputs: Mapping[str, Any], *, node: str
) -> Caution | None:
    """What to say where a picture comes in with bands and goes on without."""
    bands = next((one for one in map(bands_of, inputs.values()) if one is not None), None)
    made = [value for value in outputs.values() if isinstance(value, Image | SpectrumWire)]
    if bands is None or not made or any(bands_of(value) is not None for value in made):
        return None
    low, high = bands.band_um
    return Caution(
        f"this node sums the picture's {bands.count} bands, {low:.4g} to {high:.4g} µm, so the "
        "nodes after it have no bands",
        "put Focal Plane or Spectral Response before this node to sum the bands as a detector "
        "does, or leave this node out",
        node,
    )


# Making arrays of what is on a wire, in the form that a viewer or a file needs.


def realize(value: Any, work: Work, region: Region | None = None) -> Any:
    """The computed form of a port's value, or a region of it if it is an image.

    Image: pixels. Transfer, magnitude and phase: full 2-D arrays in FFT order, MTF and magnitude
    real and signed, PTF and phase in radians, at Nyquist as they act. Curve:
    `CurveData`. Table: `TableData`. Context: itself. A pupil gives its samples.
    """
    if region is not None:
        if not isinstance(value, Image):
            kind = getattr(value, "port_type", type(value).__name__)
            allowed = f"only an image has regions, not a {kind}"
            raise ParameterError("region", str(region), allowed)
        if region.within(value.shape).shape != value.shape:
            return work.part(value.recipe, region)
    if isinstance(value, Image | Curve | Table):
        return work.value(value.recipe)
    if isinstance(value, Transfer | SpectrumWire):
        work.log.looked_at.add(value.key)
    if isinstance(value, Transfer):
        if value.own is not None:
            sampled: wires.SampledTransfer = work.value(value.own)
            return sampled.values
        return wires.transfer_plane(work, value).astype(work.policy.dtype)
    if isinstance(value, SpectrumWire):
        plane = wires.transfer_plane(work, value)
        if value.image is not None:
            own = work.value(_spectrum_of(value.image))
            plane = plane + np.angle(own) if isinstance(value, wires.Phase) else plane * np.abs(own)
        return plane.astype(work.policy.dtype)
    samples = getattr(value, "samples", None)
    if isinstance(samples, Recipe):
        return work.value(samples)
    return value


def asked_for(value: Any) -> tuple[Recipe, ...]:
    """The recipes whose values `realize` takes, to hold them before."""
    if isinstance(value, Image | Curve | Table):
        return (value.recipe,)
    if isinstance(value, Transfer):
        return value.recipes if value.own is None else (value.own,)
    if isinstance(value, SpectrumWire):
        bound = value.recipes if value.image is None else value.recipes[1:]
        return (*bound, *([_spectrum_of(value.image)] if value.image is not None else []))
    samples = getattr(value, "samples", None)
    return (samples,) if isinstance(samples, Recipe) else ()


def _spectrum_of(image: Image) -> Recipe:
    return Step.of(wires.spectrum, image.recipe)


# Whether a network's recipes can be made in blocks, and which of their pictures lie on disk.
#
# Found from the recipes alone, before anything is computed.

IN_MEMORY_AT_ONCE = 8
"""Pictures of the largest size that a run in memory may hold, with what its steps make besides."""


def least_scratch(recipes: Iterable[Recipe], blocks: BlockRun, policy: Policy) -> int:
    """Bytes that lie on disk at a time at least: a picture that is filtered, and its spectrum."""
    most = 0
    for recipe in _furthest_first(recipes):
        if isinstance(recipe, Delivered) and recipe.magnitude.image is not None:
            size = recipe.magnitude.grid.rows * recipe.magnitude.grid.columns
            if recipe.magnitude.image.key in blocks.shapes:
                most = max(most, 2 * size * policy.dtype.itemsize)
    return most


def _refusal(recipe: Recipe, shape: Shape, disk: ScratchDisk) -> DataError:
    return DataError(
        f"{_what(recipe)} cannot run in blocks, and the whole picture of {shape[0]} × {shape[1]} "
        f"samples does not fit in {amount_text(disk.memory_bytes)} of memory. Leave the node "
        "out, or allow more memory",
        node=recipe.node,
        hint="give a higher --memory",
    )


def _what(recipe: Recipe) -> str:
    if isinstance(recipe, Delivered):
        if not recipe.one_source:
            return "combining the magnitude of one picture with the phase of another"
        if recipe.sampled is not None and not recipe.sampled.folds:
            return "sampling with a pixel pitch that is not a whole number of samples"
        return "filtering every band at its own wavelength"
    name = recipe.in_words or type(recipe).__name__
    if isinstance(recipe, Step):
        name = getattr(recipe.function, "__name__", name)
    return name.strip("_").replace("_", " ")


def _shape(recipe: Recipe, known: Mapping[str, Shape]) -> Shape | None:
    """Size of a picture; None for all that is none. What it is made of is known."""
    if recipe.key in known:
        return known[recipe.key]
    if isinstance(recipe, Delivered):
        if recipe.sampled is not None:
            return recipe.sampled.new
        grid = recipe.magnitude.grid
        return grid.rows // recipe.factor_y, grid.columns // recipe.factor_x
    if not isinstance(recipe, Step) or not recipe.in_parts:
        return None
    how = dict(recipe.parameters)
    given = how.get("shape")
    if {"old", "factor_y", "factor_x"} <= how.keys():  # pixels combined inside a node
        given = how["old"][0] // how["factor_y"], how["old"][1] // how["factor_x"]
    if given is not None:
        return int(given[0]), int(given[1])
    sizes = [known[one.key] for one in recipe.inputs if one.key in known]
    return max(sizes, default=None)  # patterns of one line are spread over the picture


def _furthest_first(recipes: Iterable[Recipe]) -> Iterator[Recipe]:
    """All that recipes are made of, and they themselves, each after what it is made of."""
    done: set[str] = set()
    for recipe in furthest_first(recipes, lambda one: one.inputs, lambda one: one.key in done):
        done.add(recipe.key)
        yield recipe
