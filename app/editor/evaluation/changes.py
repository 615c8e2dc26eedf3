"""What an edit changes, and planning with nodes held back from it.

Those without Auto-Generate stay as they were generated last.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.chain.engine import Engine, Plan, PlannedNode
from core.network.network import Link, Network

Change = frozenset[tuple[str, str] | str | Link] | None
"""Parameters by node, nodes, links and "seed"; the same edit again is equal to it."""


def edited(before: Network | None, after: Network) -> Change:
    """What differs between two networks; None where there was none before."""
    if before is None:
        return None
    changes: set[tuple[str, str] | str | Link] = {*(set(before.links) ^ set(after.links))}
    for name in {*before.nodes, *after.nodes}:
        old, new = before.nodes.get(name), after.nodes.get(name)
        if old is new:
            continue
        if old is None or new is None or (old.auto, old.disabled) != (new.auto, new.disabled):
            changes.add(name)
        else:
            names = {*old.params, *new.params}
            changes |= {(name, p) for p in names if old.params.get(p) != new.params.get(p)}
    if before.seed != after.seed:
        changes.add("seed")
    return frozenset(changes)


def computes_alike(before: Network, after: Network) -> bool:
    """Whether the networks differ only in their appearance."""
    return (
        before.links == after.links
        and before.seed == after.seed
        and before.extra == after.extra
        and len(before.nodes) == len(after.nodes)
        and all(after.nodes.get(name) is node for name, node in before.nodes.items())
    )


@dataclass(frozen=True)
class Planned:
    """A network as shown, and as if all were generated; `stale` nodes would give other values."""

    shown: Plan
    fresh: Plan
    stale: frozenset[str] = frozenset()


def plan_held(
    engine: Engine,
    network: Network,
    folder: Path,
    last: Planned | None,
    *,
    generate: bool,
) -> Planned:
    """Plan a network; unless all is generated, or was just opened, held nodes stay as they were."""
    before = last.fresh if last is not None else None
    fresh = engine.plan(network, folder=folder, previous=before)
    if generate or last is None:
        return Planned(fresh, fresh)
    held = {
        name: planned
        for name, planned in last.shown.nodes.items()
        if planned.error is None and name in network.nodes and network.nodes[name].auto is False
    }
    if not held:
        return Planned(fresh, fresh)
    shown = engine.plan(network, folder=folder, previous=last.shown, held=held)
    stale = frozenset(name for name in held if content(held[name]) != content(fresh.nodes[name]))
    return Planned(shown, fresh, stale)


def content(planned: PlannedNode) -> tuple[Hashable, ...]:
    """What a node makes its outputs and read-outs of, and what it gives."""
    return (
        _keys(planned.outputs),
        _keys(planned.inputs),
        repr(planned.module),
        planned.node.disabled,
        planned.error is None,
    )


def _keys(values: Any) -> tuple[tuple[str, str | None], ...]:
    return tuple((name, getattr(value, "key", None)) for name, value in sorted(values.items()))
