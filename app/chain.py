"""What a network amounts to: its final picture, and the transfer functions that lead to it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from core.delivered import Delivered, block_combine
from core.engine import Plan, PlannedNode
from core.errors import NetworkError
from core.factors import Factor
from core.grid import Grid
from core.network import Network
from core.recipes import Step
from core.values import Image, Transfer

ANALYSIS = "Analysis"  # the group whose modules compare and measure, so their pictures end nothing


@dataclass(frozen=True)
class Stage:
    """The factors that one node brings to a chain."""

    node: str
    title: str
    factors: tuple[Factor, ...]


@dataclass(frozen=True)
class Chain:
    """What leads to the final picture.

    Parameters
    ----------
    final : str or None
        ``NODE.PORT`` of the final picture, None in a network without pictures.
    sources : tuple of str
        Ports of the input pictures it stems from.
    grid : Grid or None
        Sampling on which the spectrum is multiplied.
    combined : Grid or None
        The sampling once pixels have been combined on the way to the final picture; None where
        they are not.
    stages : tuple of Stage
        Factors on the spectrum, in order.
    later : tuple of Stage
        Transfer functions after that: the electronics.
    beside : tuple of Stage
        Transfer functions that do not lead to the final picture.
    cascade : bool
        Whether `stages` act one after the other, so that they have a product.
    """

    final: str | None
    sources: tuple[str, ...]
    grid: Grid | None
    combined: Grid | None
    stages: tuple[Stage, ...]
    later: tuple[Stage, ...]
    beside: tuple[Stage, ...]
    cascade: bool


def find_chain(plan: Plan) -> Chain:
    """The chain that ends in the network's final picture.

    Raises
    ------
    NetworkError
        If the network's field `final` names no picture.
    """
    final = final_image(plan)
    if final is None:
        return _unconnected(plan, None, ())
    node = final.rpartition(".")[0]
    upstream = ancestors(plan.network, node) | {node}
    sources = tuple(_sources(plan, upstream))
    found = _delivered(plan, upstream)
    if found is None:
        return _unconnected(plan, final, sources)
    last, recipe = found
    factors = (*recipe.magnitude.factors, *recipe.phase.factors)
    before = ancestors(plan.network, last) | {last}
    stages = _stages(plan, factors, before)
    later = [_transfers(plan, name) for name in plan.nodes if name in upstream - before]
    inside = {stage.node for stage in (*stages, *later)}
    beside = [_transfers(plan, name) for name in plan.nodes if name not in inside]
    return Chain(
        final,
        sources,
        recipe.magnitude.grid,
        _combined(plan, [last, *(name for name in plan.nodes if name in upstream - before)]),
        tuple(stages),
        tuple(stage for stage in later if stage.factors),
        tuple(stage for stage in beside if stage.factors),
        cascade=True,
    )


def final_image(plan: Plan) -> str | None:
    """The picture furthest downstream.

    It is the one the network's field `final` names; else, of the pictures that a node without
    outputs takes or that no link leaves, one that none of the others stems from.
    """
    named = plan.network.extra.get("final")
    if named is not None:
        if not isinstance(named, str) or not _is_image(plan, named):
            raise NetworkError(f"final = {named!r:.80} is not allowed: NODE.PORT of an image")
        return named
    ending = ending_images(plan)
    looked_at = set(_sink_inputs(plan))
    order = list(plan.nodes)
    return max(
        ending,
        key=lambda port: (
            port in looked_at,
            port in _main_images(plan),
            len(ancestors(plan.network, _node(port))),
            order.index(_node(port)),
        ),
        default=None,
    )


def ending_images(plan: Plan) -> list[str]:
    """Pictures looked at or left open, less those that another one of them stems from."""
    candidates = _candidates(plan) or list(_image_ports(plan))
    passed: set[str] = set()
    for port in candidates:
        passed |= ancestors(plan.network, _node(port))
    return [port for port in candidates if _node(port) not in passed]


def ancestors(network: Network, node: str) -> set[str]:
    """Every node that `node` hangs on."""
    found: set[str] = set()
    waiting = [node]
    while waiting:
        for link in network.links_into(waiting.pop()):
            if link.source not in found:
                found.add(link.source)
                waiting.append(link.source)
    return found


def source_images(plan: Plan) -> list[str]:
    """Ports of pictures that hang on nothing: files and test scenes."""
    return [port for port in _image_ports(plan) if not plan.nodes[_node(port)].inputs]


def _candidates(plan: Plan) -> list[str]:
    linked = {f"{link.source}.{link.output}" for link in plan.network.links}
    open_ends = [port for port in _image_ports(plan) if port not in linked]
    found = dict.fromkeys([*_sink_inputs(plan), *open_ends])
    return [
        port
        for port in found
        if plan.nodes[_node(port)].declaration.group != ANALYSIS
        and (port not in open_ends or port in _main_images(plan))
    ]


def _main_images(plan: Plan) -> set[str]:
    return {port for name in plan.nodes if (port := _first_image(plan.nodes[name], name))}


def _sink_inputs(plan: Plan) -> list[str]:
    return [
        f"{link.source}.{link.output}"
        for link in plan.network.links
        if _is_sink(plan, link.target) and _is_image(plan, f"{link.source}.{link.output}")
    ]


def _is_sink(plan: Plan, name: str) -> bool:
    """Not so a node that is not there, or whose module is unknown or cannot be built."""
    planned = plan.nodes.get(name)
    return planned is not None and planned.module is not None and planned.declaration.sink


def _first_image(planned: PlannedNode, name: str) -> str | None:
    """The node's first picture, which is what it makes; the others tell how (its noise)."""
    ports = (f"{name}.{port}" for port, value in planned.outputs.items() if _image(value))
    return next(ports, None)


def _image_ports(plan: Plan) -> Iterable[str]:
    for name, planned in plan.nodes.items():
        yield from (f"{name}.{port}" for port, value in planned.outputs.items() if _image(value))


def _is_image(plan: Plan, port: str) -> bool:
    planned = plan.nodes.get(_node(port))
    return planned is not None and _image(planned.outputs.get(port.rpartition(".")[2]))


def _image(value: Any) -> bool:
    return isinstance(value, Image)


def _node(port: str) -> str:
    return port.rpartition(".")[0]


def _sources(plan: Plan, upstream: set[str]) -> list[str]:
    return [port for port in source_images(plan) if _node(port) in upstream]


def _delivered(plan: Plan, upstream: set[str]) -> tuple[str, Delivered] | None:
    """The last node whose picture comes straight out of an inverse transform."""
    for name in reversed([name for name in plan.nodes if name in upstream]):
        for value in plan.nodes[name].outputs.values():
            if isinstance(value, Image) and isinstance(value.recipe, Delivered):
                return name, value.recipe
    return None


def _combined(plan: Plan, names: Iterable[str]) -> Grid | None:
    grids = [
        value.grid()
        for name in names
        for value in plan.nodes[name].outputs.values()
        if isinstance(value, Image)
        and _combines_pixels(value)
        and value.interval_x_mrad
        and value.interval_y_mrad
    ]
    return max(grids, key=lambda grid: grid.interval_x_mrad * grid.interval_y_mrad, default=None)


def _combines_pixels(image: Image) -> bool:
    """Whether the last step to the picture combines pixels, or its transform does."""
    recipe = image.recipe
    if isinstance(recipe, Delivered):
        return (recipe.factor_x, recipe.factor_y) != (1, 1)
    return isinstance(recipe, Step) and recipe.function is block_combine


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


def _unconnected(plan: Plan, final: str | None, sources: tuple[str, ...]) -> Chain:
    """Without an inverse transform: every transfer function there is, side by side."""
    stages = [stage for name in plan.nodes if (stage := _transfers(plan, name)).factors]
    grids = [
        value.grid
        for planned in plan.nodes.values()
        for value in planned.outputs.values()
        if isinstance(value, Transfer)
    ]
    grid = grids[0] if grids else None
    return Chain(final, sources, grid, None, tuple(stages), (), (), cascade=False)
