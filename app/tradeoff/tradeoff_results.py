"""Figures of merit at values of parameters: read-outs of nodes, and the MTF of the chain."""

import itertools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from app.run.overrides import Variation, near, taken_value
from app.run.terminal import number_text
from app.run.transfer_chain import SYSTEM, TOTAL, Axis, find_chain, mtf_at, sound_part
from core import errors
from core.chain.engine import Engine, Plan
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter, PendingCheck
from core.network.linked_values import following
from core.network.network import Network, reached
from core.records import dataclass, field, replace

ELECTRONICS = "electronics_noise"
SENSORS = (ELECTRONICS, "focal_plane", "microbolometer")
_NO_PIXELS = "the detector's pitch is not known, and no pixels are combined"
_ABSENT = object()
_WITH_PIXELS = ("camera", "sample_pixels", "combine_pixels")
_TOTALS = {TOTAL: "MTF of the chain", SYSTEM: "MTF of the chain with its electronics"}


def _places(kind: str, of: str) -> dict[str, tuple[Axis, float, str]]:
    """Figures of a total by name: the axis, the share of its Nyquist frequency, and words."""
    ways: tuple[tuple[Axis, str], ...] = (("x", "horizontal"), ("y", "vertical"))
    return {
        f"mtf_{half}{kind}nyquist_{axis}": (
            axis, share, f"at {words} {way} Nyquist frequency of the {of}"
        )
        for half, share, words in (("", 1.0, "the"), ("half_", 0.5, "half the"))
        for axis, way in ways
    }  # fmt: skip


_PLACES, _OF_PIXELS = _places("", "samples"), _places("pixel_", "pixels")
_ALL_PLACES = {**_PLACES, **_OF_PIXELS}


@dataclass(frozen=True)
class Figure:
    """A node's read-out or an MTF of the chain; a study may leave it out if `by_default`."""

    node: str
    name: str
    unit: str = ""
    meaning: str = ""
    by_default: bool = False

    @property
    def text(self) -> str:
        return f"{self.node}.{self.name}"

    @property
    def is_total(self) -> bool:
        return self.node in _TOTALS and self.name in _ALL_PLACES


def figures_of(network: Network, library: Library) -> dict[str, Figure]:
    """All figures by ``NODE.READOUT``; whether one is a number shows once it is computed."""
    figures: list[Figure] = []
    modules = {node.module for node in network.nodes.values()}
    has_pitch = makes_pixels(network) or any(
        node.module == "init_trans" and node.params.get("detector_x_um")
        for node in network.nodes.values()
    )
    if "back_transform" in modules:
        for total, what in _TOTALS.items():
            if total == TOTAL or ELECTRONICS in modules:
                places = {**(_OF_PIXELS if has_pitch else {}), **_PLACES}.items()
                figures += [Figure(total, n, "", f"{what} {where}") for n, (*_, where) in places]
    for node in network.nodes.values():
        if node.module in library and not node.disabled:
            figures += [
                Figure(node.id, readout.name, readout.unit, readout.meaning)
                for readout in declaration(library[node.module]).readouts
            ]
    return {figure.text: figure for figure in figures}


def makes_pixels(network: Network) -> bool:
    """Whether a network makes pixels of its samples, or takes them from a camera's data sheet."""
    return any(node.module in _WITH_PIXELS for node in network.nodes.values())


def default_figures(network: Network, library: Library) -> tuple[Figure, ...]:
    """The sensor's figures and the chain's MTF; else those of the analysis, else all."""
    known = figures_of(network, library)
    groups = {
        node.id: declaration(library[node.module])
        for node in network.nodes.values()
        if node.module in library
    }
    places = _OF_PIXELS if makes_pixels(network) else _PLACES
    usual = [
        figure
        for figure in known.values()
        if (figure.name in places if figure.is_total else groups[figure.node].key in SENSORS)
    ]
    if not usual:
        usual = [f for f in known.values() if groups[f.node].group == "Analysis"]
    return tuple(replace(figure, by_default=True) for figure in usual or known.values())


def chosen_figures(texts: Sequence[str], network: Network, library: Library) -> tuple[Figure, ...]:
    if not texts:
        return default_figures(network, library)
    return tuple(named_figure("--figure", text, network, library) for text in dict.fromkeys(texts))


def named_figure(option: str, text: str, network: Network, library: Library) -> Figure:
    known = figures_of(network, library)
    if text not in known:
        beside = [name for name in known if known[name].node == text.rpartition(".")[0]]
        hint = near("", beside) if beside else near(text, known)
        raise errors.UsageError(
            f"{option} {errors.shown(text)}: the network has no such read-out{hint}"
        )
    return known[text]


@dataclass(frozen=True)
class Point:
    """The figures at a value of each axis; `absent` ones were computed and have no number."""

    values: tuple[Any, ...] = ()
    figures: Mapping[str, float] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    absent: frozenset[str] = frozenset()


def computed(
    figures: Iterable[Figure], engine: Engine, plan: Plan, work: Work, varied: Collection[str]
) -> Point:
    """The figures of a planned network, of which `varied` are the nodes whose parameters vary."""
    values: dict[str, float] = {}
    reasons: dict[str, str] = {}
    absent: set[str] = set()
    groups: dict[tuple[str, bool], list[Figure]] = {}
    for figure in figures:
        groups.setdefault((figure.node, figure.is_total), []).append(figure)
    waiting = list(groups.values())
    while waiting:
        wanted = waiting.pop(0)
        node, is_total = wanted[0].node, wanted[0].is_total
        work.check()
        try:
            if is_total:
                results = _total(wanted, plan, work, varied)
            else:
                names = [figure.name for figure in wanted]
                results = engine.readouts(plan, node, work, names=names)
        except errors.FAULTS as error:
            if is_total or len(wanted) == 1:
                reasons |= {figure.text: str(error) for figure in wanted}
            else:  # one that fails leaves the others
                waiting += [[figure] for figure in wanted]
            continue
        for figure in wanted:
            found = results.get(figure.name)
            number = _number(found)
            if number is not None:
                values[figure.text] = number
                continue
            absent.add(figure.text)
            reasons[figure.text] = f"{figure.text} is not a number"
            if found is None:
                why = _NO_PIXELS if is_total else engine.why_none(plan, node, work, figure.name)
                reasons[figure.text] = f"{figure.text} has no value{why and f': {why}'}"
    return Point(figures=values, reasons=reasons, absent=frozenset(absent))


def _total(
    figures: Iterable[Figure], plan: Plan, work: Work, varied: Collection[str]
) -> dict[str, Any]:
    """MTFs of the chain; what the varied nodes do not feed may be broken."""
    touched = {*varied}.union(*(nodes_after(plan.network, name) for name in varied))
    for name in [name for name in plan.network.nodes if name in touched]:
        error = plan.nodes[name].error
        if error is not None:
            raise error
    chain = find_chain(sound_part(plan))
    if chain.grid is None or not chain.cascade:
        raise errors.NetworkError(f"no total MTF: {chain.missing}")
    mtfs = {}
    for figure in figures:
        axis, share, _ = _ALL_PLACES[figure.name]
        before = [factor for stage in chain.stages for factor in stage.factors]
        factors = chain.factors if figure.node == SYSTEM else before
        place = 0 if axis == "x" else 1
        of_pixels = figure.name in _OF_PIXELS
        samples = chain.grid.nyquist_x, chain.grid.nyquist_y
        nyquist = chain.pixel_nyquist[place] if of_pixels else samples[place]
        if nyquist is None:
            continue
        mtfs[figure.name] = mtf_at(work, factors, share * nyquist, axis)
        if not np.isfinite(mtfs[figure.name]):
            raise errors.DataError("the MTF is not finite")
    return mtfs


def nodes_after(network: Network, node: str) -> set[str]:
    """The nodes that hang on that one: by wires, or by parameters that follow its own."""
    next_ones = {*following(network, node), *network.followers.get(node, ())}
    return reached(network.followers, next_ones)


def _number(value: Any) -> float | None:
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.number):
        return None
    number = float(value)
    return None if np.isnan(number) else number


# What a trade-off has found: for one curve or a family of them.

_ROUNDING = 1e-5


def moves(low: float, high: float) -> bool:
    """Whether a figure from `low` to `high` moves by more than its rounding."""
    return high - low > _ROUNDING * max(abs(low), abs(high))


@dataclass(frozen=True)
class Results:
    network: str  # name of the network
    axes: tuple[Variation, ...]  # what differs from curve to curve, and what moves along them
    figures: tuple[Figure, ...]  # the figures shown
    points: tuple[Point, ...]  # curve after curve
    present: Any = None  # the value in the network as it stands

    @property
    def along(self) -> Variation:
        return self.axes[-1]

    def why_nothing(self) -> str | None:
        """Why no point has a figure that is shown, as far as known; None where one has."""
        if any(f.text in point.figures for f in self.figures for point in self.points):
            return None
        gaps = [reason for _, reason in self.failures()]
        # The default figures had no value, so none is left.
        gaps = gaps or [r for point in self.points for r in point.reasons.values()]
        return gaps[0] if gaps else ""

    @property
    def curves(self) -> list[tuple[Point, ...]]:
        count = len(self.along.values)
        return [self.points[at : at + count] for at in range(0, len(self.points), count)]

    def reasons(self, point: Point) -> list[str]:
        """Why figures that are shown have no value at a point."""
        names = (figure.text for figure in self.figures if figure.text in point.reasons)
        return list(dict.fromkeys(point.reasons[name] for name in names))

    def failures(self) -> list[tuple[str, str]]:
        return [(self._place(point), r) for point in self.points for r in self.reasons(point)]

    def warnings(self) -> list[tuple[str, str]]:
        return [(self._place(point), line) for point in self.points for line in point.warnings]

    def _place(self, point: Point) -> str:
        pairs = [*zip(self.axes, point.values, strict=True)][::-1]
        return ", ".join(f"{axis.text} = {shown_value(value, axis.unit)}" for axis, value in pairs)


def changing_figures(figures: Sequence[Figure], points: Sequence[Point]) -> tuple[Figure, ...]:
    """Of the default figures, those that change; where none does, those that have a value."""
    rows = {figure: [point.figures.get(figure.text) for point in points] for figure in figures}
    shown: list[Figure] = []
    for figure, row in rows.items():
        known = (f for f in shown if f.is_total and figure.is_total and f.name == figure.name)
        if any(value is not None for value in row) and row not in [rows[f] for f in known]:
            shown.append(figure)  # not the MTF with electronics that do not filter
    values = {figure: [v for v in rows[figure] if v is not None] for figure in shown}
    changing = [f for f, v in values.items() if moves(min(v), max(v))]
    return tuple(changing or shown)


def shown_value(value: Any, unit: str = "") -> str:
    if value is None:
        return "empty"
    text = ("true" if value else "false") if isinstance(value, bool) else number_text(value)
    return f"{text} {unit}".strip() if not isinstance(value, str) else text


# A network evaluated at one point after another; what neighbours have in common is made once.


class PointEvaluator:
    """Figures at points, each planned from the one before: what is the same is not made again."""

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
        before, known = self._last
        network = before.network
        for (node, name), value, old in zip(self._targets, values, known, strict=True):
            if value is not old and (type(value) is not type(old) or value != old):
                with errors.placed(node):
                    network = with_value(network, self.engine, node, name, value)
        plan = self.engine.plan(network, folder=self._base.folder, previous=before)
        self._last = (plan, tuple(values))
        return plan

    def figures_of(self, plan: Plan, work: Work) -> Point:
        return computed(self.figures, self.engine, plan, work, self._nodes)

    def warnings_of(
        self, plan: Plan, work: Work | None = None, also: Iterable[Recipe] = ()
    ) -> tuple[str, ...]:
        """What nodes warn of; with `work` also by samples that figures or `also` take."""
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
                    f"{node}: seed is varied, but seed_mode = automatic ignores seed, so all "
                    f"points have the same noise. Set {node}.seed_mode to typed"
                )
        return tuple(dict.fromkeys(lines))

    def _read(self, plan: Plan, also: Iterable[Recipe]) -> set[str]:
        waiting = list(also)
        for node in dict.fromkeys(figure.node for figure in self.figures if not figure.is_total):
            names = [figure.name for figure in self.figures if figure.node == node]
            with suppress(errors.ImagechainError):  # the figure's reason says so
                values = self.engine.planned_readouts(plan, node, names).values()
                waiting += [value for value in values if isinstance(value, Recipe)]
        known: set[str] = set()
        while waiting:
            recipe = waiting.pop()
            if recipe.key not in known:
                known.add(recipe.key)
                waiting += recipe.needs
        return known


def points_at(
    engine: Engine,
    plan: Plan,
    work: Work,
    targets: Sequence[tuple[str, str]],
    places: Iterable[tuple[Any, ...]],
    figures: Sequence[Figure],
) -> Iterator[Point]:
    """Evaluate place by place, each with a value for every parameter."""
    evaluator = PointEvaluator(engine, plan, targets, figures)
    for values in places:
        work.check()
        try:
            at = evaluator.planned(values)
            found = evaluator.figures_of(at, work)
            yield replace(found, values=values, warnings=evaluator.warnings_of(at, work))
        except errors.ParameterError as error:
            yield Point(values, reasons={figure.text: str(error) for figure in figures})


def trade_off(
    engine: Engine,
    plan: Plan,
    work: Work,
    axes: tuple[Variation, ...],
    figures: tuple[Figure, ...],
    *,
    name: str,
    by_default: bool,
    reached: Callable[[int], object],
) -> Results:
    """Evaluate a network at every value; a failure leaves a gap with its reason."""
    along = axes[-1]
    targets = [(axis.node, axis.parameter.name) for axis in axes]
    places = itertools.product(*(axis.values for axis in axes))
    points = []
    for point in points_at(engine, plan, work, targets, places, figures):
        points.append(point)
        reached(len(points))
    if by_default:
        figures = changing_figures([f for f in figures if f.text != along.text], points)
    default = None if along.parameter.required else along.parameter.default
    present = plan.node(along.node).node.params.get(along.parameter.name, default)
    return Results(name, axes, figures, tuple(points), present)


def with_value(network: Network, engine: Engine, node: str, parameter: str, value: Any) -> Network:
    taken = taken_value(parameter_of(network, engine, node, parameter), value)
    return network.with_parameter(node, parameter, taken)


def parameter_of(network: Network, engine: Engine, node: str, parameter: str) -> Parameter:
    module = engine.library.get(network.node(node).module)
    declared = declaration(module).parameter(parameter) if module is not None else None
    if declared is None:
        raise errors.NetworkError(f"{node} has no parameter {parameter}")
    return declared
