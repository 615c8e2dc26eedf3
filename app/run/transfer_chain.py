"""Which picture a network delivers, and the transfer functions that lead to it."""

from collections.abc import Collection, Iterable, Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Vector
from core.chain import back_transformed, step_lineage
from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Image, Transfer
from core.errors import FAULTS, ImagechainError, NetworkError, shown, thaw
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.modules.declaration import Library, declaration
from core.network.network import Network, Node, marked_twice, reached
from core.network.validation import NetworkProblems
from core.records import dataclass, field, replace
from core.transfer.factors import Factor, Grid, Part
from nodes.analysis.lineage import HORIZONTAL, VERTICAL, Line, stage_along
from nodes.analysis.lineage import Stage as LineStage
from nodes.files.table_cells import csv_columns

ANALYSIS = "Analysis"  # the group whose modules compare and measure: their pictures are no output
HOW_TO_MARK = "select the node whose picture is the output and press O"
HOW_TO_NAME = "or give --final NODE.PORT"
_MOST_NAMED = 8


@dataclass(frozen=True)
class Output:
    port: str | None  # ``NODE.PORT``; None where there is none, or several could be meant
    choices: tuple[str, ...] = ()  # pictures that could be meant, if none is marked

    @property
    def missing(self) -> str:
        """Why there is none, in one line; empty where there is one."""
        if self.port is not None:
            return ""
        if not self.choices:
            return "the network has no picture"
        named = ", ".join(map(shown, self.choices[:_MOST_NAMED]))
        more = len(self.choices) - _MOST_NAMED
        named += f" and {more} more" if more > 0 else ""
        return (
            f"this network ends in {len(self.choices)} pictures ({named}) and none is marked as "
            "the output"
        )


def find_output(plan: Plan) -> Output:
    """The picture that is marked as the output, else the one in which the network ends.

    A mark is the field `final` of a node, else of the network. Without one, it is the first picture
    of the only node at the end; analysis modules count if there are no others, pictures without
    inputs if there are none of both.
    """
    marked = plan.network.marked
    if len(marked) > 1:
        raise marked_twice(marked)
    if marked:
        return Output(_picture_of(plan, marked[0]))
    named = plan.network.extra.get("final")
    if named is not None:
        if not isinstance(named, str) or not _is_image(plan, named):
            raise NetworkError(
                f"final = {thaw(named)!r:.80} is not allowed: must be NODE.PORT of an image"
            )
        return Output(named)
    ends = _ends(plan)
    return Output(ends[0]) if len(ends) == 1 else Output(None, tuple(ends))


def how_to_choose(output: Output) -> str:
    """Which pictures there are and how to mark one, in one line; empty where none is to choose."""
    if not output.choices:
        return ""
    return f"{output.missing}: {HOW_TO_MARK}, {HOW_TO_NAME}"


def ending_images(plan: Plan) -> list[str]:
    return _leaves(plan, _seen_or_open(plan) or list(ports_of_images(plan)))


def sound_part(plan: Plan) -> Plan:
    """The plan without its failed nodes and what would name them; itself where none has failed."""
    failed = {name for name, node in plan.nodes.items() if node.error is not None}
    if not failed:
        return plan
    network = plan.network
    final = network.extra.get("final")
    lost = isinstance(final, str) and final.rpartition(".")[0] in failed
    sound = replace(
        network,
        nodes={name: node for name, node in network.nodes.items() if name not in failed},
        links=tuple(link for link in network.links if not {link.source, link.target} & failed),
        layout={},
        extra={} if lost else network.extra,
    )
    nodes = {name: node for name, node in plan.nodes.items() if name not in failed}
    return Plan(sound, nodes, plan.folder)


def ancestors(network: Network, *nodes: str) -> set[str]:
    """Every node that one of these hangs on."""
    upstream: set[str] = set()
    waiting = list(nodes)
    while waiting:
        for link in network.links_into(waiting.pop()):
            if link.source not in upstream:
                upstream.add(link.source)
                waiting.append(link.source)
    return upstream


def source_images(plan: Plan) -> list[str]:
    return [port for port in ports_of_images(plan) if not plan.nodes[_node(port)].inputs]


def _picture_of(plan: Plan, name: str) -> str:
    """A node's first picture; of a node that only takes one, that."""
    planned = plan.nodes.get(name)
    own = _first_image(planned, name) if planned is not None else None
    if own is not None:
        return own
    taken = [port for port in _sink_inputs(plan) if port[0] == name]
    if not taken:
        raise NetworkError(
            "this node is marked as the output but has no picture: mark a node with a picture",
            node=name,
        )
    return taken[0][1]


def _ends(plan: Plan) -> list[str]:
    """The first pictures that nothing further is made of, of the best kind there is."""
    kinds: dict[int, list[str]] = {}
    for name, planned in plan.nodes.items():
        port = _first_image(planned, name)
        if port is not None:
            bare, analysis = not planned.inputs, planned.declaration.group == ANALYSIS
            kinds.setdefault(2 if bare else 1 if analysis else 0, []).append(port)
    return _leaves(plan, kinds[min(kinds)]) if kinds else []


def _leaves(plan: Plan, ports: list[str]) -> list[str]:
    """The ports on whose nodes none of the others' nodes hangs."""
    passed = ancestors(plan.network, *{_node(port) for port in ports})
    return [port for port in ports if _node(port) not in passed]


def _seen_or_open(plan: Plan) -> list[str]:
    linked = {f"{link.source}.{link.output}" for link in plan.network.links}
    main = {port for name in plan.nodes if (port := _first_image(plan.nodes[name], name))}
    open_ends = [port for port in ports_of_images(plan) if port not in linked]
    candidates = dict.fromkeys([*(port for _, port in _sink_inputs(plan)), *open_ends])
    beside = set(open_ends) - main
    groups = {port: plan.nodes[_node(port)].declaration.group for port in candidates}
    return [port for port in candidates if groups[port] != ANALYSIS and port not in beside]


def _sink_inputs(plan: Plan) -> list[tuple[str, str]]:
    nodes = plan.nodes.items()
    sinks = {name for name, one in nodes if one.module is not None and one.declaration.sink}
    pairs = [(link.target, f"{link.source}.{link.output}") for link in plan.network.links]
    return [(name, port) for name, port in pairs if name in sinks and _is_image(plan, port)]


def _first_image(planned: PlannedNode, name: str) -> str | None:
    """The node's first picture, which is its product; the others show how (its noise)."""
    outputs = planned.outputs.items()
    return next((f"{name}.{port}" for port, value in outputs if isinstance(value, Image)), None)


def ports_of_images(plan: Plan) -> Iterator[str]:
    for name, planned in plan.nodes.items():
        for port, value in planned.outputs.items():
            if isinstance(value, Image):
                yield f"{name}.{port}"


def _is_image(plan: Plan, port: str) -> bool:
    planned = plan.nodes.get(_node(port))
    output = None if planned is None else planned.outputs.get(port.rpartition(".")[2])
    return isinstance(output, Image)


def _node(port: str) -> str:
    return port.rpartition(".")[0]


# What judges the delivered picture, and has no part in it.


def delivering(network: Network, library: Library) -> set[str]:
    """The nodes of the delivered picture; if none is marked, of all that analysis does not make."""

    def makes_pictures(node: Node) -> bool:
        if node.module not in library:
            return True
        declared = declaration(library[node.module])
        images = any("image" in port.types for port in declared.outputs)
        return images and declared.group != ANALYSIS

    made = [name for name, node in network.nodes.items() if makes_pictures(node)]
    ends = network.output_nodes or made
    return {*ends, *ancestors(network, *ends)}


def without_judges(
    network: Network,
    error: ImagechainError,
    library: Library,
    spare: Collection[str] = (),
    *,
    figures_only: bool = False,
) -> tuple[Network, tuple[str, ...]] | None:
    """The network without the judges that have errors, and a line on each.

    None if the delivered picture, or one of `spare`, would go too; or with `figures_only` if
    another module than one of analysis has an error.
    """
    problems = error.problems if isinstance(error, NetworkProblems) else (error,)
    judges = set(network.nodes) - delivering(network, library)
    gone: set[str] = set()
    lines = []
    for problem in problems:
        if problem.node is None or problem.node not in judges:
            return None
        module = library.get(network.nodes[problem.node].module)
        if figures_only and (module is None or declaration(module).group != ANALYSIS):
            return None
        gone |= reached(network.followers, [problem.node])
        lines.append(f"{problem.node} is left out: {problem.message}")
    if not gone <= judges or gone & set(spare):
        return None
    nodes = {name: node for name, node in network.nodes.items() if name not in gone}
    links = tuple(link for link in network.links if not {link.source, link.target} & gone)
    return replace(network, nodes=nodes, links=links), tuple(lines)


@dataclass(frozen=True)
class Stage:
    node: str
    title: str
    factors: tuple[Factor, ...]


@dataclass(frozen=True)
class Chain:
    final: str | None  # ``NODE.PORT`` of the final picture, None in a network without pictures
    sources: tuple[str, ...]  # ports of the input pictures it stems from
    grid: Grid | None  # sampling on which the spectrum is multiplied
    # the sampling once pixels have been combined on the way to the final picture; None where they
    # are not
    combined: Grid | None
    stages: tuple[Stage, ...]  # factors on the spectrum, in order
    later: tuple[Stage, ...]  # transfer functions after that: the electronics
    beside: tuple[Stage, ...]  # transfer functions that do not lead to the final picture
    # why `stages` have no product, in one line; empty where they act one after the other, so that
    # they have one
    missing: str = ""
    choices: tuple[str, ...] = ()  # pictures of which each could be the final one, where none is
    # from one pixel of the detector to the next, across and along
    pitch_mrad: tuple[float | None, float | None] = (None, None)

    @property
    def pixel_nyquist(self) -> tuple[float | None, float | None]:
        """Of the combined pixels across and along, else of the detector's pitch, if known."""
        if self.combined is not None:
            return self.combined.nyquist_x, self.combined.nyquist_y
        x, y = (0.5 / pitch if pitch else None for pitch in self.pitch_mrad)
        return x, y

    @property
    def factors(self) -> tuple[Factor, ...]:
        return tuple(factor for stage in (*self.stages, *self.later) for factor in stage.factors)

    @property
    def cascade(self) -> bool:
        return not self.missing


def find_chain(plan: Plan) -> Chain:
    output = find_output(plan)
    final = output.port
    if final is None:
        return _unconnected(plan, output, ())
    node = final.rpartition(".")[0]
    upstream = ancestors(plan.network, node) | {node}
    sources = tuple(p for p in source_images(plan) if p.rpartition(".")[0] in upstream)
    delivered = _delivered(plan, upstream)
    if delivered is None:
        return _unconnected(plan, output, sources)
    last, recipe = delivered
    factors = (*recipe.magnitude.factors, *recipe.phase.factors)
    before = ancestors(plan.network, last) | {last}
    stages = _stages(plan, factors, before)
    behind = upstream - before
    later = [_transfers(plan, name) for name in plan.nodes if name in behind]
    inside = {stage.node for stage in (*stages, *later)}
    beside = [_transfers(plan, name) for name in plan.nodes if name not in inside]
    return Chain(
        final,
        sources,
        recipe.magnitude.grid,
        _combined(plan, [last, *(name for name in plan.nodes if name in behind)]),
        tuple(stages),
        tuple(stage for stage in later if stage.factors),
        tuple(stage for stage in beside if stage.factors),
        pitch_mrad=recipe.magnitude.pixel_mrad,
    )


def _delivered(plan: Plan, upstream: set[str]) -> tuple[str, back_transformed.Delivered] | None:
    """The last node whose picture comes straight out of an inverse transform."""
    for name in reversed([name for name in plan.nodes if name in upstream]):
        for value in plan.nodes[name].outputs.values():
            if isinstance(value, Image) and isinstance(value.recipe, back_transformed.Delivered):
                return name, value.recipe
    return None


def _combined(plan: Plan, names: Iterable[str]) -> Grid | None:
    grids = [
        value.grid()
        for name in names
        for value in plan.nodes[name].outputs.values()
        if isinstance(value, Image)
        and _combines_pixels(value, name)
        and value.interval_x_mrad
        and value.interval_y_mrad
    ]
    return max(grids, key=lambda grid: grid.interval_x_mrad * grid.interval_y_mrad, default=None)


def _combines_pixels(image: Image, node: str) -> bool:
    """Whether the last step to the picture, or one before it at the node, combines pixels."""
    recipe: Recipe | None = image.recipe
    while recipe is not None and (lineage := step_lineage.lineage_of(recipe)) is not None:
        if lineage.linear.combines_pixels:
            return True
        before = lineage.picture
        recipe = before if getattr(before, "node", None) == node else None
    return False


def _stages(plan: Plan, factors: Iterable[Factor], before: set[str]) -> list[Stage]:
    """Factors by node, in the network's order; a node at its neutral setting has none."""
    grouped: dict[str, list[Factor]] = {}
    for factor in factors:
        grouped.setdefault(factor.node or factor.label or "stage", []).append(factor)
    named = [name for name in plan.nodes if name in grouped or _is_idle(plan, name, before)]
    named += [name for name in grouped if name not in plan.nodes]
    return [Stage(name, _title(plan, name), tuple(grouped.get(name, ()))) for name in named]


def _title(plan: Plan, name: str) -> str:
    planned = plan.nodes.get(name)
    return name if planned is None or planned.module is None else planned.declaration.title


def _is_idle(plan: Plan, name: str, before: set[str]) -> bool:
    transfers = _transfer_outputs(plan, name)
    return name in before and bool(transfers) and not any(v.factors or v.own for v in transfers)


def _transfers(plan: Plan, name: str) -> Stage:
    factors = [factor for value in _transfer_outputs(plan, name) for factor in value.factors]
    return Stage(name, _title(plan, name), tuple(factors))


def _transfer_outputs(plan: Plan, name: str) -> list[Transfer]:
    return [value for value in plan.nodes[name].outputs.values() if isinstance(value, Transfer)]


def _unconnected(plan: Plan, output: Output, sources: tuple[str, ...]) -> Chain:
    """Without an inverse transform: every transfer function there is, side by side."""
    stages = [stage for name in plan.nodes if (stage := _transfers(plan, name)).factors]
    grids = (value.grid for name in plan.nodes for value in _transfer_outputs(plan, name))
    grid = next(grids, None)
    missing = output.missing or f"no Back Transform comes before the output, {output.port}"
    if grid is None:
        missing = "the network has no transfer function"
    return Chain(output.port, sources, grid, None, tuple(stages), (), (), missing, output.choices)


# Transfer functions along the two axes: what mtf.csv and the reports show.

Axis = Literal["x", "y"]
TOTAL = "total"
SYSTEM = "total_with_electronics"
_SYSTEM_TITLE = "Total with electronics"


@dataclass(frozen=True)
class StageCurve:
    """MTF (signed) and PTF (rad) of a stage along one axis; `frequency` in cycles/mrad."""

    frequency: Vector = field(repr=False)
    mtf: Vector = field(repr=False)
    ptf_rad: Vector = field(repr=False)

    @property
    def otf(self) -> NDArray[np.complex128]:
        """MTF and PTF as one complex function."""
        return np.asarray(self.mtf * np.exp(1j * self.ptf_rad), np.complex128)


@dataclass(frozen=True)
class StageResponse:
    name: str
    title: str
    x: StageCurve
    y: StageCurve = StageCurve(np.zeros(0), np.zeros(0), np.zeros(0))
    is_product: bool = False

    @property
    def has_phase(self) -> bool:
        return bool(self.x.ptf_rad.any() or self.y.ptf_rad.any())

    @property
    def has_blur(self) -> bool:
        return bool((self.x.mtf != 1).any() or (self.y.mtf != 1).any())

    @property
    def acts(self) -> bool:
        return self.has_phase or self.has_blur


@dataclass(frozen=True)
class Responses:
    """All stages at the plain FFT's frequencies from 0 to Nyquist, or along a line (then in `x`).

    `products` has the total before pixels are combined, and with the electronics; it is empty
    where the stages do not follow one another.
    """

    xi: Vector
    eta: Vector
    stages: tuple[StageResponse, ...]
    beside: tuple[StageResponse, ...]
    products: tuple[StageResponse, ...]
    failed: tuple[ImagechainError, ...] = ()


def responses(chain: Chain, work: Work) -> Responses:
    """Evaluate every stage of the chain along both axes; no plane is ever built."""
    grid = chain.grid
    if grid is None:
        empty = np.zeros(0)
        return Responses(empty, empty, (), (), ())
    xi = np.asarray(np.fft.rfftfreq(grid.columns, grid.interval_x_mrad))
    eta = np.asarray(np.fft.rfftfreq(grid.rows, grid.interval_y_mrad))

    def sampled(stages: Iterable[Stage], *, is_product: bool = False) -> tuple[StageResponse, ...]:
        made = []
        for stage in stages:
            x, y = response(work, stage.factors, xi, "x"), response(work, stage.factors, eta, "y")
            made.append(StageResponse(stage.node, stage.title, x, y, is_product))
        return tuple(made)

    stages = sampled((*chain.stages, *chain.later))
    products = sampled(_products(chain), is_product=True)
    return Responses(xi, eta, stages, sampled(chain.beside), products)


def _products(chain: Chain) -> list[Stage]:
    if not chain.cascade:
        return []
    before = tuple(factor for stage in chain.stages for factor in stage.factors)
    whole = [Stage(SYSTEM, _SYSTEM_TITLE, chain.factors)] if chain.later else []
    return [Stage(TOTAL, "Total", before), *whole]


def response(
    work: Work, factors: Iterable[Factor], frequency: Vector, line: Axis | Line
) -> StageCurve:
    """Product of the MTFs and sum of the PTFs along an axis, or a line."""
    if not isinstance(line, Line):
        line = HORIZONTAL if line == "x" else VERTICAL
    factors = tuple(factors)

    def along(part: Part) -> Vector:
        stage = LineStage("", tuple(factor for factor in factors if factor.part == part))
        return stage_along(work, stage, part, line, frequency)

    return StageCurve(frequency, along("mtf"), along("ptf"))


def mtf_at(work: Work, factors: Iterable[Factor], frequency: float, axis: Axis) -> float:
    return float(response(work, factors, np.array([frequency]), axis).mtf[0])


def responses_along(
    chain: Chain, work: Work, angle_deg: float, samples: int | None = None
) -> Responses:
    """Every stage along a line at an angle from the xi axis (0°) to the eta axis (90°)."""
    grid = chain.grid
    if grid is None:
        return Responses(np.zeros(0), np.zeros(0), (), (), ())
    line = Line.at(angle_deg)
    frequency = line.frequencies(grid, samples or max(grid.rows, grid.columns) // 2 + 1)
    failed: dict[str, ImagechainError] = {}

    def along(stages: Iterable[Stage]) -> list[StageResponse]:
        evaluated = []
        for stage in stages:
            work.check()
            try:
                values = response(work, stage.factors, frequency, line)
            except FAULTS as error:
                failed[str(error)] = error
            else:
                evaluated.append(StageResponse(stage.node, stage.title, values))
        return evaluated

    def product(name: str, title: str, stages: Iterable[StageResponse]) -> StageResponse:
        mtf, ptf = np.ones(len(frequency)), np.zeros(len(frequency))
        for stage in stages:
            mtf, ptf = mtf * stage.x.mtf, ptf + stage.x.ptf_rad
        return StageResponse(name, title, StageCurve(frequency, mtf, ptf), is_product=True)

    before, later = along(chain.stages), along(chain.later)
    products = []
    if chain.cascade and len(before) == len(chain.stages):
        products.append(product(TOTAL, "Total", before))
        if chain.later and len(later) == len(chain.later):
            products.append(product(SYSTEM, _SYSTEM_TITLE, [*before, *later]))
    beside = along(chain.beside)
    stages, errors = (*before, *later), tuple(failed.values())
    return Responses(frequency, np.zeros(0), stages, tuple(beside), tuple(products), errors)


def at_nyquist(chain: Chain, work: Work) -> dict[str, float]:
    grid = chain.grid
    if grid is None:
        return {}
    figures = {}
    places: tuple[tuple[Axis, float], ...] = (("x", grid.nyquist_x), ("y", grid.nyquist_y))
    for stage in (*chain.stages, *chain.later, *chain.beside, *_products(chain)):
        for axis, frequency in places:
            value = response(work, stage.factors, np.array([frequency]), axis)
            figures[f"{stage.node}.mtf_nyquist_{axis}"] = float(value.mtf[0])
            figures[f"{stage.node}.ptf_nyquist_{axis}"] = float(value.ptf_rad[0])
    return figures


def mtf_csv(sampled: Responses) -> str:
    """One line for each frequency; the shorter axis of an oblong frame leaves cells empty."""
    columns = [("xi_cyc_per_mrad", sampled.xi), ("eta_cyc_per_mrad", sampled.eta)]
    for stage in (*sampled.stages, *sampled.beside, *sampled.products):
        for axis, along in (("x", stage.x), ("y", stage.y)):
            columns.append((f"{stage.name}.mtf_{axis}", along.mtf))
            columns.append((f"{stage.name}.ptf_{axis}_rad", along.ptf_rad))
    return csv_columns((name, column.tolist()) for name, column in columns)
