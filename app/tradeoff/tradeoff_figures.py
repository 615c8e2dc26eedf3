"""Figures of merit that a trade-off can show: read-outs of nodes, and the chain's MTF."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from app.run.output import sound_part
from app.run.overrides import near
from app.run.responses import SYSTEM, TOTAL, Axis, mtf_at
from app.run.transfer_chain import Chain, find_chain
from core.chain.engine import Engine, Plan
from core.errors import Cancelled, DataError, ImagechainError, NetworkError, UsageError
from core.evaluation.work import Work
from core.modules.declaration import Library, declaration
from core.names import shown
from core.network.linked_values import following
from core.network.network import Network, reached

ELECTRONICS = "electronics_noise"
SENSORS = (ELECTRONICS, "focal_plane", "microbolometer")
_PLACES: Mapping[str, tuple[Axis, float, str]] = MappingProxyType(
    {
        "mtf_nyquist_x": ("x", 1.0, "at the horizontal Nyquist frequency of the samples"),
        "mtf_nyquist_y": ("y", 1.0, "at the vertical Nyquist frequency of the samples"),
        "mtf_half_nyquist_x": ("x", 0.5, "at half the horizontal Nyquist frequency of the samples"),
        "mtf_half_nyquist_y": ("y", 0.5, "at half the vertical Nyquist frequency of the samples"),
    }
)
_OF_PIXELS: Mapping[str, tuple[Axis, float, str]] = MappingProxyType(
    {
        name.replace("nyquist", "pixel_nyquist"): (axis, share, where.replace("samples", "pixels"))
        for name, (axis, share, where) in _PLACES.items()
    }
)
_ALL_PLACES: Mapping[str, tuple[Axis, float, str]] = MappingProxyType({**_PLACES, **_OF_PIXELS})
_NO_PIXELS = "the detector's pitch is not known, and no pixels are combined"
_WITH_PIXELS = ("camera", "sample_pixels", "combine_pixels")
_TOTALS: Mapping[str, str] = MappingProxyType(
    {TOTAL: "MTF of the chain", SYSTEM: "MTF of the chain with its electronics"}
)


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
    if "back_transform" in modules:
        for total, what in _TOTALS.items():
            if total == TOTAL or ELECTRONICS in modules:
                places = {**(_OF_PIXELS if _has_pitch(network) else {}), **_PLACES}
                figures += [
                    Figure(total, n, "", f"{what} {where}") for n, (*_, where) in places.items()
                ]
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


def _has_pitch(network: Network) -> bool:
    return makes_pixels(network) or any(
        node.module == "init_trans" and node.params.get("detector_x_um")
        for node in network.nodes.values()
    )


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
        raise UsageError(f"{option} {shown(text)}: the network has no such read-out{hint}")
    return known[text]


@dataclass(frozen=True)
class Point:
    """The figures at one value; `absent` ones were computed and have no number."""

    value: Any = None
    figures: Mapping[str, float] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    absent: frozenset[str] = frozenset()


def computed(
    figures: Iterable[Figure], engine: Engine, plan: Plan, work: Work, varied: Collection[str]
) -> Point:
    """The figures of a planned network, of which `varied` are the nodes whose parameters vary."""
    figures = tuple(figures)
    values: dict[str, float] = {}
    reasons: dict[str, str] = {}
    absent: set[str] = set()
    for node in dict.fromkeys(figure.node for figure in figures):
        totals = [f for f in figures if f.node == node and f.is_total]
        readouts = [f for f in figures if f.node == node and not f.is_total]
        waiting = [wanted for wanted in (totals, readouts) if wanted]
        while waiting:
            wanted = waiting.pop(0)
            work.check()
            try:
                if wanted is totals:
                    results = _total(totals, plan, work, varied)
                else:
                    names = [figure.name for figure in wanted]
                    results = engine.readouts(plan, node, work, names=names)
            except Cancelled:
                raise
            except ImagechainError as error:
                if wanted is not totals and len(wanted) > 1:  # one that fails leaves the others
                    waiting += [[figure] for figure in wanted]
                    continue
                reasons |= {figure.text: str(error) for figure in wanted}
                continue
            for figure in wanted:
                number = _number(results.get(figure.name))
                if number is None:
                    why = _NO_PIXELS
                    if not figure.is_total:
                        why = engine.why_none(plan, node, work, figure.name)
                    reasons[figure.text] = _no_number(figure, results, why)
                    absent.add(figure.text)
                else:
                    values[figure.text] = number
    return Point(None, values, reasons, absent=frozenset(absent))


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
        raise NetworkError(f"no total MTF: {chain.missing}")
    mtfs = {}
    for figure in figures:
        axis, share, _ = _ALL_PLACES[figure.name]
        before = [factor for stage in chain.stages for factor in stage.factors]
        factors = chain.factors if figure.node == SYSTEM else before
        nyquist = _nyquist(chain, axis, of_pixels=figure.name in _OF_PIXELS)
        if nyquist is None:
            continue
        mtfs[figure.name] = mtf_at(work, factors, share * nyquist, axis)
        if not np.isfinite(mtfs[figure.name]):
            raise DataError("the MTF is not finite")
    return mtfs


def _nyquist(chain: Chain, axis: Axis, *, of_pixels: bool) -> float | None:
    assert chain.grid is not None
    grid, place = chain.grid, 0 if axis == "x" else 1
    return chain.pixel_nyquist[place] if of_pixels else (grid.nyquist_x, grid.nyquist_y)[place]


def nodes_after(network: Network, node: str) -> set[str]:
    """The nodes that hang on that one: by wires, or by parameters that follow its own."""
    next_ones = {*following(network, node), *network.followers.get(node, ())}
    return reached(network.followers, next_ones)


def _number(value: Any) -> float | None:
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.number):
        return None
    number = float(value)
    return None if np.isnan(number) else number


def _no_number(figure: Figure, results: Mapping[str, Any], why: str) -> str:
    if results.get(figure.name) is not None:
        return f"{figure.text} is not a number"
    return f"{figure.text} has no value{f': {why}' if why else ''}"
