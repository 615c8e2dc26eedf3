"""One pass over a plan: what there is to answer, and how long it takes."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

from app.editor.error_text import error_text
from app.editor.evaluation.failures import as_error
from app.editor.evaluation.mailbox import Request, Snapshot
from app.editor.evaluation.pace import Pace
from app.editor.evaluation.sent import SentAnswers
from core.chain.engine import Plan
from core.errors import ImagechainError
from core.network.network import Link, Network

Change = frozenset[tuple[str, str] | str | Link] | None
"""Parameters by node, nodes, links and "seed"; the same edit again is equal to it."""


@dataclass(frozen=True)
class Due:
    """A query to be answered, and what its answer depends on, or why that is unknown."""

    request: Request
    key: Hashable
    error: ImagechainError | None = None

    @property
    def is_picture(self) -> bool:
        """Whether it is as urgent as pictures are."""
        return self.request.query.urgency <= 0


@dataclass(frozen=True)
class Task:
    """One pass.

    Parameters
    ----------
    snapshot : Snapshot
        What it works on.
    plan : Plan
        The network, planned, in a preview that of reduced pictures.
    due : sequence of Due
        What to answer, pictures first.
    change : Change
        What was edited since the last pass that was finished.
    reduced : int
        Above 1 in a preview.
    expected : float
        Seconds its pictures took the last time; 0 if unknown.
    has_preview : bool
        Whether an edit meanwhile would be followed by a preview.
    preview : Task or None
        The pass to make first.
    """

    snapshot: Snapshot
    plan: Plan
    due: Sequence[Due]
    change: Change
    reduced: int = 1
    expected: float = 0.0
    has_preview: bool = False
    preview: Task | None = None


def due_queries(
    requests: Sequence[Request],
    plan: Plan,
    sent: SentAnswers,
    reduced: int = 1,
    *,
    waiting: bool = False,
) -> tuple[Due, ...]:
    """What of that is to be answered from this plan, the most urgent first.

    With `waiting` only what can wait until edits pause, else only what cannot.
    """
    queries = []
    for request in requests:
        if request.query.waits is not waiting:
            continue
        due = _due(request, plan)
        if sent.is_due(request, due.key, reduced):
            queries.append(due)
    return tuple(sorted(queries, key=lambda due: due.request.query.urgency))


def _due(request: Request, plan: Plan) -> Due:
    try:
        return Due(request, request.query.key(plan))
    except Exception as raised:
        error = as_error(raised)
        return Due(request, ("error", error_text(error)), error)


def overtaken(task: Task, newest: Snapshot | None, pace: Pace, elapsed: float) -> bool:
    """Whether a pass gives way to what has come since it began, `elapsed` seconds ago."""
    snapshot = task.snapshot
    if newest is None or newest.edits == snapshot.edits:
        return False
    if newest.document != snapshot.document:
        return True
    return task.reduced == 1 and pace.gives_way(
        elapsed,
        task.expected,
        has_preview=task.has_preview,
        new_gesture=newest.gestures != snapshot.gestures,
    )


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
