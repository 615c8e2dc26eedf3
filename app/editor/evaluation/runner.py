"""The worker: plans each snapshot of the window and answers its queries.

While a pass is fast, edits are gathered: the pass is finished, and the next one takes the newest
state. To begin anew at each edit of a drag would show no picture until it ends.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Hashable, Sequence
from typing import Any

import numpy as np

from app.editor.declared_text import error_text
from app.editor.evaluation import changes
from app.editor.evaluation.queries import (
    Answer,
    Badge,
    Inbox,
    Outbox,
    PassDone,
    Passing,
    Request,
    Snapshot,
    as_error,
    badges,
    skip_texts,
)
from core.chain.engine import Engine, Plan
from core.chain.skipped import skips
from core.errors import Cancelled, ImagechainError
from core.evaluation.recipes import Recipe, Region, Store
from core.evaluation.work import EvaluationLog, Policy, Work
from core.machine import Workers
from core.modules.declaration import Library
from core.modules.parameters import Caution, PendingCheck
from core.network.network import Network
from core.records import dataclass, replace


@dataclass(frozen=True)
class Due:
    request: Request
    key: Hashable
    error: ImagechainError | None = None

    @classmethod
    def of(cls, request: Request, plan: Plan) -> Due:
        try:
            return cls(request, request.query.key(plan))
        except Exception as raised:
            error = as_error(raised)
            return cls(request, ("error", error_text(error)), error)


@dataclass(frozen=True)
class Task:
    """One pass: what it works on, its plan, and what to answer: pictures, then the `rest`.

    What of the rest is due is found out only when the pass comes to it: in a drag, one in five
    does. `change` was edited since the last pass that was finished; `expected` is what its pictures
    took the last time. `has_preview`: an edit meanwhile would be followed by a preview. `preview`
    is the pass to make first; in that one, the plan is of reduced pictures.
    """

    snapshot: Snapshot
    plan: Plan
    due: Sequence[Due]
    change: changes.Change
    rest: Collection[Request] = ()
    reduced: int = 1
    expected: float = 0.0
    has_preview: bool = False
    preview: Task | None = None


@dataclass(frozen=True)
class Sent:
    """An answer that was sent: what it depends on, and what was looked at for it."""

    key: Hashable
    log: EvaluationLog | None = None
    reduced: int = 1
    error: ImagechainError | None = None


class Runner:
    """Works in a thread of its own until its inbox is stopped."""

    def __init__(self, library: Library, inbox: Inbox, outbox: Outbox) -> None:
        self.position: Position | None = None
        self._engine = Engine(library, Store())
        self._workers = Workers()
        self._inbox, self._outbox = inbox, outbox
        self._pace = Pace()
        self._sent: dict[Request, Sent] = {}  # to each query that stands, the answer sent last
        self._given_up: set[Request] = set()  # left unanswered until there is an edit
        self._last: Snapshot | None = None
        self._done: Snapshot | None = None
        self._planned: changes.Planned | None = None
        self._small: Plan | None = None
        self._has_preview = False
        self._skipped: dict[str, str] = {}
        self._badges: dict[str, Badge] | None = None
        self._stale: frozenset[str] = frozenset()  # nodes whose newer values are yet to be sent
        self._warned: dict[str, Caution | None] = {}

    def run(self) -> None:
        with np.errstate(all="ignore"):  # what matters is watched by the engine
            while (snapshot := self._inbox.take()) is not None:
                try:
                    self._work_on(snapshot)
                except Exception as raised:  # of the network as a whole, or a fault of ours
                    self._answer_all(snapshot, as_error(raised))

    def _work_on(self, snapshot: Snapshot) -> None:
        generate = self._follow(snapshot)
        self._planned = changes.plan_held(
            self._engine, snapshot.network, snapshot.folder, self._planned, generate=generate
        )
        plan = self._planned.shown
        self._outbox.deliver(plan=plan)
        self._stale |= self._planned.stale
        task = None if snapshot.only_planned else self._task(snapshot, plan)
        # A quick picture comes before the badges; errors do not wait.
        if task is None or not 0 < task.expected < REST_S or plan.errors():
            self._send_badges()
        if task is None:
            self._finish(snapshot)
            return
        if self._preview(task) and self._pass(task):
            self._done = snapshot
            self._stale = frozenset(self._planned.stale)
            self._send_badges()
            self._settle(snapshot)
            self._answer_waiting(snapshot)
            self._finish(snapshot)

    def _task(self, snapshot: Snapshot, plan: Plan) -> Task:
        change = changes.edited(self._done.network if self._done else None, snapshot.network)
        task = Task(
            snapshot,
            plan,
            self._due([each for each in snapshot.requests if each.query.urgency <= 0], plan),
            change,
            rest=[each for each in snapshot.requests if each.query.urgency > 0],
            expected=self._pace.expected(change),
        )
        wanted = [due.request for due in task.due if due.request.query.from_preview]
        if not wanted or not self._is_edited(snapshot):
            return task
        if task.expected < SLOW_S:
            return replace(task, has_preview=self._has_preview)
        reduced = self._pace.reduction(change)
        small = self._small_plan(snapshot, reduced, change) if reduced > 1 else None
        if small is None:
            return task
        due = self._due(wanted, small, reduced)
        preview = Task(snapshot, small, due, change, reduced=reduced)
        return replace(task, has_preview=True, preview=preview)

    def _follow(self, snapshot: Snapshot) -> bool:
        last, self._last = self._last, snapshot
        self._outbox.begin(snapshot.document)
        if last is None or last.document != snapshot.document:
            self._engine.store.clear()
            self._sent.clear()
            self._given_up.clear()
            self._planned = self._small = self._done = self._badges = None
            self._skipped = {}
            self._stale = frozenset()
            return True
        generate = last.generates != snapshot.generates
        if last.edits != snapshot.edits:
            self._given_up.clear()
        wanted = set(snapshot.requests)
        self._given_up &= wanted
        self._sent = {
            request: sent
            for request, sent in self._sent.items()
            if request in wanted and not (generate and sent.error)
        }
        return generate

    def _due(
        self, requests: Collection[Request], plan: Plan, reduced: int = 1, *, waiting: bool = False
    ) -> tuple[Due, ...]:
        """The most urgent first; `waiting`: what can wait until edits pause, and nothing else."""
        standing = (
            Due.of(request, plan)
            for request in requests
            if request.query.waits is waiting and request not in self._given_up
        )
        due = (each for each in standing if not self._is_answered(each, reduced))
        return tuple(sorted(due, key=lambda due: due.request.query.urgency))

    def _is_answered(self, due: Due, reduced: int = 1) -> bool:
        sent = self._sent.get(due.request)
        known = sent is not None and (sent.key, sent.reduced) == (due.key, reduced)
        return known and due.key is not None

    def _answer_all(self, snapshot: Snapshot, error: ImagechainError) -> None:
        start = time.perf_counter()
        for request in snapshot.requests:
            due = Due(request, ("no answer", str(error)))
            if request not in self._given_up and not self._is_answered(due):
                self._send(due, snapshot, error=error)
        self._outbox.deliver(done=PassDone(snapshot.generation, time.perf_counter() - start))
        self._finish(snapshot)

    def _finish(self, snapshot: Snapshot) -> None:
        self._outbox.deliver(finished=snapshot.generation, unanswered=bool(self._given_up))

    def _preview(self, task: Task) -> bool:
        """Whether to go on with full pictures: not if something newer has come."""
        if task.preview is None:
            return True
        pause = task.snapshot.edited_at + PAUSE_S
        paused = self._pass(task.preview) and self._inbox.quiet_until(pause)
        return paused or self._is_cancelled(task.snapshot)

    def _small_network(self, reduced: int, change: changes.Change = None) -> Network | None:
        planned = self._planned
        if planned is None or planned.stale:
            return None  # what is held back has a recipe of full size only
        names = {item[0] for item in change or () if isinstance(item, tuple)}
        return changes.reduced_network(planned.shown, reduced, edited=names)

    def _small_plan(self, snapshot: Snapshot, reduced: int, change: changes.Change) -> Plan | None:
        small, before = self._small_network(reduced, change), self._small
        if small is None:
            return None
        if before is not None:
            small = changes.with_same_nodes(small, before.network)
        self._small = self._engine.plan(small, folder=snapshot.folder, previous=before)
        return self._small

    def _pass(self, task: Task) -> bool:
        """Answer all that is due; whether it was completed, or cancelled by the person."""
        snapshot, reduced = task.snapshot, task.reduced
        position = Position(len(task.due), lambda place: self._must_stop(task, place))
        self.position = position
        rest: tuple[Due, ...] | None = None
        try:
            position.check()
            try:
                self._answer(task.due, task, position)
            finally:
                if task.due and not self._is_cancelled(snapshot):
                    known = task.expected if position.stopped else 0.0
                    self._pace.took(task.change, max(position.seconds, known), reduced)
            if task.due and task.rest and self._pace.rest_may_wait():
                until = min(self._pace.rest_again, snapshot.edited_at + PAUSE_S)
                if not self._inbox.quiet_until(until) and self._inbox.waiting:
                    return False  # an edit has come before its time
            rest = self._due(task.rest, task.plan)
            if rest:
                position.wanted += len(rest)
                start = time.perf_counter()
                try:
                    self._answer(rest, task, position)
                finally:
                    self._pace.rest_took(time.perf_counter() - start)
        except Cancelled:
            if reduced > 1 or not self._is_cancelled(snapshot):
                self._pace.gave_way(position.seconds)
                return False
            rest = self._due(task.rest, task.plan) if rest is None else rest
            self._given_up.update(due.request for due in (*task.due, *rest)[position.done :])
        finally:
            self.position = None
        follows = self._is_edited(snapshot)
        if task.due or rest or follows:
            how = (position.seconds, reduced, position.stopped, follows)
            self._outbox.deliver(done=PassDone(snapshot.generation, *how))
        return True

    def _answer(self, dues: Sequence[Due], task: Task, position: Position) -> None:
        for due in dues:
            position.check()
            work = PassWork(self._engine.store, self._workers, position)
            passing = Passing(self._engine, task.plan, work, task.reduced)
            value, error = None, due.error
            try:
                if error is None:
                    value = due.request.query.answer(passing)
            except Exception as raised:
                if position.stopped and isinstance(raised, Cancelled):
                    raise
                error = as_error(raised)
            if error is None or task.reduced == 1:  # a preview's error may be its own
                self._send(due, task.snapshot, value, error, work, task.reduced)
            position.done += 1

    def _send(
        self,
        due: Due,
        snapshot: Snapshot,
        value: Any = None,
        error: ImagechainError | None = None,
        work: PassWork | None = None,
        reduced: int = 1,
    ) -> None:
        request = due.request
        self._sent[request] = Sent(due.key, work.log if work else None, reduced, error)
        of = (snapshot.generation, request.owner, request.query)
        self._outbox.deliver(Answer(*of, value, error, reduced))
        if request.query.urgency <= 0:
            self._pace.shown()

    def _is_cancelled(self, snapshot: Snapshot) -> bool:
        return self._inbox.cancelled >= snapshot.generation

    def _is_edited(self, snapshot: Snapshot) -> bool:
        return self._done is None or self._done.edits != snapshot.edits

    def _must_stop(self, task: Task, position: Position) -> bool:
        """Whether a pass gives way to what has come since it began."""
        snapshot, newest = task.snapshot, self._inbox.newest
        if self._inbox.stopped or self._is_cancelled(snapshot):
            return True
        if newest is None or newest.edits == snapshot.edits:
            return False
        if newest.document != snapshot.document:
            return True
        return task.reduced == 1 and self._pace.gives_way(
            position.seconds,
            task.expected,
            has_preview=task.has_preview,
            new_gesture=newest.gestures != snapshot.gestures,
        )

    def _settle(self, snapshot: Snapshot) -> None:
        """Once edits pause, look at what was skipped, and whether a preview could be made."""
        if not self._inbox.quiet_until(snapshot.edited_at + PAUSE_S):
            return
        assert self._planned is not None
        plan = self._planned.shown
        self._has_preview = self._small_network(REDUCTIONS[0]) is not None
        position = Position(0, lambda _: self._inbox.waiting)
        work = PassWork(self._engine.store, self._workers, position)
        for sent in self._sent.values():
            if sent.log is not None and sent.reduced == 1:
                work.log.add(sent.log)
        try:
            self._look_at_samples(plan, work)
            self._skipped = skip_texts(skips(plan, work))
        except ImagechainError:  # something newer has come, or an error that is shown elsewhere
            return
        self._send_badges()

    def _look_at_samples(self, plan: Plan, work: PassWork) -> None:
        """Take the nodes' warnings on samples already computed; none are computed for them."""
        pending = [check for check in plan.checks() if isinstance(check, PendingCheck)]
        keys = {check.recipe.key for check in pending}
        self._warned = {key: warning for key, warning in self._warned.items() if key in keys}
        for check in pending:
            if check.recipe.key not in self._warned and check.is_ready(work):
                self._warned[check.recipe.key] = check.value(work)

    def _answer_waiting(self, snapshot: Snapshot) -> None:
        assert self._planned is not None
        plan, inbox = self._planned.shown, self._inbox
        due = self._due(snapshot.requests, plan, waiting=True)
        position = Position(len(due), lambda _: inbox.waiting or self._is_cancelled(snapshot))
        self.position = position
        try:
            self._answer(due, Task(snapshot, plan, due, None), position)
        except Cancelled:
            if self._is_cancelled(snapshot):
                self._given_up.update(item.request for item in due[position.done :])
        finally:
            self.position = None

    def _send_badges(self) -> None:
        assert self._planned is not None
        plan = self._planned.shown
        pending = [check for check in plan.checks() if isinstance(check, PendingCheck)]
        known = [self._warned.get(check.recipe.key) for check in pending]
        warned = [warning for warning in known if warning is not None]
        met = [sent.error for sent in self._sent.values() if sent.error is not None]
        stale, skipped = self._stale, self._skipped
        shown = badges(
            plan, self._engine.library, stale=stale, met=met, skipped=skipped, warned=warned
        )
        if shown != self._badges:
            self._badges = shown
            self._outbox.deliver(badges=shown)


# An evaluation that can be stopped, with the node it is at.


class Position:
    """Where a pass is. Written by the worker, read by the window: each field on its own is true."""

    def __init__(self, wanted: int, must_stop: Callable[[Position], bool]) -> None:
        self.started = time.perf_counter()
        self.thread = threading.get_ident()
        self.wanted = wanted
        self.done = 0
        self.stopped = False
        self.nodes: list[str | None] = []  # whose recipes are computed, each for the one before
        self._must_stop = must_stop

    @property
    def seconds(self) -> float:
        return time.perf_counter() - self.started

    @property
    def node(self) -> str | None:
        nodes = tuple(self.nodes)
        return next((node for node in reversed(nodes) if node), None)

    def check(self) -> None:
        if self.stopped or self._must_stop(self):
            self.stopped = True
            raise Cancelled("stopped on request")


class PassWork(Work):
    def __init__(self, store: Store, workers: Workers, position: Position) -> None:
        super().__init__(Policy(), store, workers=workers)
        self._position = position

    def check(self) -> None:
        self._position.check()

    def _compute(self, recipe: Recipe, region: Region | None = None) -> Any:
        position = self._position
        if threading.get_ident() != position.thread:
            return super()._compute(recipe, region)
        position.nodes.append(recipe.node)
        try:
            return super()._compute(recipe, region)
        finally:
            position.nodes.pop()


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
    def __init__(self) -> None:
        self._seconds: dict[tuple[Hashable, int], float] = {}
        self._wasted = 0.0
        self.rest_again = 0.0

    def expected(self, change: Hashable, reduced: int = 1) -> float:
        """Seconds that the pictures took after such an edit; 0 if unknown."""
        return self._seconds.get((change, reduced), 0.0)

    def took(self, change: Hashable, seconds: float, reduced: int = 1) -> None:
        known = self._seconds.pop((change, reduced), None)
        if reduced > 1 and known is None:
            seconds = 0.0  # the first preview makes small pictures of what the others start from
        self._seconds[change, reduced] = seconds
        if len(self._seconds) > _REMEMBERED:
            del self._seconds[next(iter(self._seconds))]

    def shown(self) -> None:
        self._wasted = 0.0

    def gave_way(self, seconds: float) -> None:
        self._wasted += seconds

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
        `expected` is what the pass took the last time.
        """
        if max(elapsed, expected) < SLOW_S:
            return False
        return has_preview or (new_gesture and self._wasted <= expected)

    def reduction(self, change: Hashable) -> int:
        """How many times smaller each side of a preview after such an edit is to be; 1: none."""
        expected = self.expected(change)
        if expected < SLOW_S:
            return 1
        fit = (k for k in REDUCTIONS if expected / k**2 <= PREVIEW_S)
        k = next(fit, REDUCTIONS[-1])
        return k if self.expected(change, k) <= expected * WORTH else 1
