"""What passes between the window and the worker: the newest snapshot in, the newest answers out."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.editor.evaluation.queries import Answer, Badge, PassDone, Query
from core.chain.engine import Plan
from core.network.network import Network


@dataclass(frozen=True)
class Request:
    """A query of an owner; posted again after it was dropped, it has another number."""

    owner: str
    query: Query
    number: int


@dataclass(frozen=True)
class Snapshot:
    """The state of the window that a pass works on.

    Of `generation` and `document` later ones have larger numbers. `edits` counts edits, openings
    and generations, `generates` the last of these, `gestures` the edits with a pause before them;
    `edited_at` is on the clock of `time.perf_counter`. `only_planned`: nothing is to be computed,
    as what to show first is chosen by the plan.
    """

    generation: int
    document: int
    network: Network
    folder: Path
    requests: tuple[Request, ...]
    edits: int
    generates: int
    gestures: int
    edited_at: float
    only_planned: bool = False


class Inbox:
    """Holds the newest snapshot until the worker takes it."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._newest: Snapshot | None = None
        self._taken = 0
        self.stopped = False
        self.cancelled = 0

    @property
    def waiting(self) -> bool:
        """Whether there is a snapshot to take, or it is time to stop."""
        newest = self._newest
        return self.stopped or (newest is not None and newest.generation > self._taken)

    @property
    def newest(self) -> Snapshot | None:
        return self._newest

    def post(self, snapshot: Snapshot) -> None:
        with self._changed:
            self._newest = snapshot
            self._changed.notify()

    def cancel(self, generation: int) -> None:
        """Stop passes up to that generation."""
        with self._changed:
            self.cancelled = generation
            self._changed.notify()

    def stop(self) -> None:
        with self._changed:
            self.stopped = True
            self._newest = None
            self._changed.notify()

    def take(self) -> Snapshot | None:
        """Wait for a snapshot that was not taken yet; None when it is time to stop."""
        with self._changed:
            self._changed.wait_for(lambda: self.waiting)
            if self.stopped or self._newest is None:
                return None
            self._taken = self._newest.generation
            return self._newest

    def quiet_until(self, moment: float) -> bool:
        """Wait until then on the clock of `time.perf_counter`; whether nothing came meanwhile."""
        with self._changed:
            cancelled = self.cancelled

            def disturbed() -> bool:
                return self.waiting or self.cancelled != cancelled

            left = moment - time.perf_counter()
            return not self._changed.wait_for(disturbed, timeout=max(0.0, left))


@dataclass
class News:
    """What the worker delivers on a document, all at once.

    Of several answers to one question only the newest is kept: a window that is slow to draw skips
    pictures instead of lagging behind. `finished`: nothing is left to do up to that generation;
    `unanswered`: the rest is given up.
    """

    document: int
    plan: Plan | None = None
    badges: Mapping[str, Badge] | None = None
    answers: dict[tuple[str, Query], Answer] = field(default_factory=dict)
    done: list[PassDone] = field(default_factory=list)
    finished: int = 0
    unanswered: bool = False


class Outbox:
    """Gathers what the worker delivers until the window takes it.

    `wake` is called from the worker's thread once there is something to take.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._lock = threading.Lock()
        self._wake = wake
        self._woken = False
        self._news = News(0)
        self.closed = False

    def begin(self, document: int) -> None:
        """From now on it is about that document; what is left of another is dropped."""
        with self._lock:
            if document != self._news.document:
                self._news = News(document)

    def deliver(self, **latest: Any) -> None:
        with self._delivering() as news:
            for name, value in latest.items():
                setattr(news, name, value)

    def answer(self, answer: Answer) -> None:
        with self._delivering() as news:
            news.answers.pop((answer.owner, answer.query), None)
            news.answers[answer.owner, answer.query] = answer

    def done(self, done: PassDone) -> None:
        with self._delivering() as news:
            news.done.append(done)

    def take(self) -> News:
        with self._lock:
            self._woken = False
            news, self._news = self._news, News(self._news.document)
        return news

    @contextmanager
    def _delivering(self) -> Iterator[News]:
        with self._lock:
            yield self._news
            wake = not (self._woken or self.closed)
            self._woken |= wake
        if wake:
            self._wake()
