"""The transfer functions that lead to the picture a network delivers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from app.run.output import Output, ancestors, find_output, source_images
from core.chain.back_transformed import Delivered
from core.chain.engine import Plan
from core.chain.step_lineage import lineage_of
from core.chain.wires import Image, Transfer
from core.evaluation.recipes import Recipe
from core.transfer.factors import Factor, Grid


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
        and _combines_pixels(value, name)
        and value.interval_x_mrad
        and value.interval_y_mrad
    ]
    return max(grids, key=lambda grid: grid.interval_x_mrad * grid.interval_y_mrad, default=None)


def _combines_pixels(image: Image, node: str) -> bool:
    """Whether the last step to the picture, or one before it at the node, combines pixels."""
    recipe: Recipe | None = image.recipe
    while recipe is not None and (lineage := lineage_of(recipe)) is not None:
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
    grids = [
        value.grid
        for planned in plan.nodes.values()
        for value in planned.outputs.values()
        if isinstance(value, Transfer)
    ]
    grid = grids[0] if grids else None
    missing = output.missing or f"no Back Transform comes before the output, {output.port}"
    if grid is None:
        missing = "the network has no transfer function"
    return Chain(output.port, sources, grid, None, tuple(stages), (), (), missing, output.choices)
