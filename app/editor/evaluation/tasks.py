"""One pass over a plan: what there is to answer, and how long it takes."""

from __future__ import annotations

import time
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

from app.editor.declared_text import error_text
from app.editor.evaluation.badges import as_error
from app.editor.evaluation.mailbox import Request, SentAnswers, Snapshot
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


# When a pass gives way to an edit, and when a picture of reduced size comes first.
#
# While a pass is fast, edits are gathered: the pass is finished, and the next one takes the
# newest
# state. To begin anew at each edit of a drag would show no picture until it ends.

SLOW_S = 0.15
"""A pass that takes longer gives way to edits, and is preceded by a preview."""
PAUSE_S = 0.15
"""Edits have paused when none came for so long."""
REST_S = 0.1
"""While edits come, what is no picture is brought up to date at most so often."""
REST_SHARE = 5
"""While edits come, what is no picture takes at most one part in so many of the time."""
PREVIEW_S = 0.04
"""What a preview is meant to take, with some room to 60 ms: not all goes with its size."""
WORTH = 2 / 3
"""A preview that takes a larger part of the full picture's time is not worth it."""
REDUCTIONS = (2, 4, 8, 16)
_REMEMBERED = 64


class Pace:
    """How long pictures took after which edits, and when one was shown last."""

    def __init__(self) -> None:
        self._seconds: dict[tuple[Hashable, int], float] = {}
        self._wasted = 0.0
        self.rest_again = 0.0

    def expected(self, change: Hashable, reduced: int = 1) -> float:
        """Seconds that the pictures took after such an edit; 0 if unknown."""
        return self._seconds.get((change, reduced), 0.0)

    def took(self, change: Hashable, seconds: float, reduced: int = 1) -> None:
        """Pictures took so long after such an edit."""
        known = self._seconds.pop((change, reduced), None)
        if reduced > 1 and known is None:
            seconds = 0.0  # the first preview makes small pictures of what the others start from
        self._seconds[change, reduced] = seconds
        if len(self._seconds) > _REMEMBERED:
            del self._seconds[next(iter(self._seconds))]

    def shown(self) -> None:
        """A picture was sent to the window."""
        self._wasted = 0.0

    def gave_way(self, seconds: float) -> None:
        """Note that a pass was stopped after so long."""
        self._wasted += seconds

    def is_slow(self, seconds: float) -> bool:
        """Whether a pass of that length holds a drag up."""
        return seconds >= SLOW_S

    def rest_took(self, seconds: float) -> None:
        """So much time was spent on all but the pictures just now."""
        wait = max(REST_S, (REST_SHARE - 1) * seconds)
        self.rest_again = time.perf_counter() + wait

    def rest_may_wait(self) -> bool:
        """Whether queries other than pictures have had their share of the time during edits."""
        return time.perf_counter() < self.rest_again

    def gives_way(
        self, elapsed: float, expected: float, *, has_preview: bool, new_gesture: bool
    ) -> bool:
        """Whether a pass over full pictures gives way to an edit that has come.

        Before a preview, always. Without one, only to another gesture and not again and again: a
        drag of passes of 0.4 s that each gave way to the next edit would show no picture.

        Parameters
        ----------
        elapsed, expected : float
            Seconds since it began, and that it took the last time.
        has_preview : bool
            Whether the edit will be followed by a preview, which is always finished.
        new_gesture : bool
            Whether an edit is among those that have come before which there was a pause.
        """
        if not self.is_slow(max(elapsed, expected)):
            return False
        return has_preview or (new_gesture and self._wasted <= expected)

    def reduction(self, change: Hashable) -> int:
        """How many times smaller each side of a preview after such an edit is to be; 1: none."""
        expected = self.expected(change)
        if not self.is_slow(expected):
            return 1
        fit = (k for k in REDUCTIONS if expected / k**2 <= PREVIEW_S)
        k = next(fit, REDUCTIONS[-1])
        return k if self.expected(change, k) <= expected * WORTH else 1
