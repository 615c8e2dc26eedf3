"""Planning with nodes held back: those without Auto-Generate stay as they were generated last."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.chain.engine import Engine, Plan, PlannedNode
from core.network.network import Network


@dataclass(frozen=True)
class Planned:
    """A network as it is shown, and as it would be if all were generated.

    `stale` names the nodes held back that would give something else by now.
    """

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
    """Plan a network; unless all is generated, nodes held back stay as they were.

    Parameters
    ----------
    engine : Engine
        Plans.
    network : Network
        The document as it stands.
    folder : Path
        What its file names are relative to.
    last : Planned or None
        The same document before, None if it was opened just now: all is generated then.
    generate : bool
        Whether to generate what is held back too.

    Raises
    ------
    ImagechainError
        If the network as a whole cannot be planned, as with a cycle.
    """
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
    stale = frozenset(name for name in held if _content(held[name]) != _content(fresh.nodes[name]))
    return Planned(shown, fresh, stale)


def _content(planned: PlannedNode) -> tuple[Hashable, ...]:
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
