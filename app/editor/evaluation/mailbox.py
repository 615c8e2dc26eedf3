"""What passes between the window and the worker: the newest snapshot in, the newest answers out."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from app.editor.evaluation.queries import Answer, Badge, PassDone, Query
from core.chain.engine import Plan
from core.errors import ImagechainError
from core.evaluation.store import EvaluationLog
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

    Parameters
    ----------
    generation : int
        Number of the snapshot; later ones have larger numbers.
    document : int
        Number of the document.
    network, folder
        The document.
    requests : tuple of Request
        All queries on it.
    edits, generates : int
        How many edits, openings and generations there have been, and how many of the last.
    gestures : int
        How many edits there have been with a pause before them.
    edited_at : float
        When the last edit was, on the clock of `time.perf_counter`.
    only_planned : bool
        Whether nothing is to be computed: what to show first is chosen by the plan.
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
        """The snapshot posted last, taken or not."""
        return self._newest

    def post(self, snapshot: Snapshot) -> None:
        """Put a snapshot in the place of the last one."""
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


@dataclass(frozen=True)
class News:
    """What the worker delivers on a document, all at once.

    `finished`: nothing is left to do up to that generation; `unanswered`: the rest is given up.
    """

    document: int
    plan: Plan | None = None
    badges: Mapping[str, Badge] | None = None
    answers: tuple[Answer, ...] = ()
    done: tuple[PassDone, ...] = ()
    finished: int = 0
    unanswered: bool = False


class Outbox:
    """Gathers what the worker delivers until the window takes it.

    Of several answers to one question only the newest is kept: a window that is slow to draw skips
    pictures instead of lagging behind.

    Parameters
    ----------
    wake : callable
        Called from the worker's thread once there is something to take.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._lock = threading.Lock()
        self._wake = wake
        self._woken = False
        self._news = News(0)
        self._answers: dict[tuple[str, Query], Answer] = {}
        self.closed = False

    def begin(self, document: int) -> None:
        """From now on it is about that document; what is left of another is dropped."""
        with self._lock:
            if document != self._news.document:
                self._answers.clear()
                self._news = News(document)

    def deliver(self, **news: Any) -> None:
        """Deliver the latest of these fields of `News`."""
        with self._lock:
            self._news = replace(self._news, **news)
        self._notify()

    def answer(self, answer: Answer) -> None:
        with self._lock:
            self._answers.pop((answer.owner, answer.query), None)
            self._answers[answer.owner, answer.query] = answer
        self._notify()

    def done(self, done: PassDone) -> None:
        """Deliver the end of a pass."""
        with self._lock:
            self._news = replace(self._news, done=(*self._news.done, done))
        self._notify()

    def take(self) -> News:
        with self._lock:
            self._woken = False
            news, answers = self._news, tuple(self._answers.values())
            self._news = News(news.document)
            self._answers.clear()
        return replace(news, answers=answers)

    def _notify(self) -> None:
        with self._lock:
            if self._woken or self.closed:
                return
            self._woken = True
        self._wake()


# What has been answered already, and need not be answered again.


@dataclass(frozen=True)
class Sent:
    """An answer that was sent: what it depends on, and what was looked at for it."""

    key: Hashable
    log: EvaluationLog | None = None
    reduced: int = 1
    error: ImagechainError | None = None


class SentAnswers:
    """The answer sent last to each query that stands."""

    def __init__(self) -> None:
        self._sent: dict[Request, Sent] = {}
        self._given_up: set[Request] = set()

    def __iter__(self) -> Iterator[Sent]:
        return iter(tuple(self._sent.values()))

    def log(self) -> EvaluationLog:
        """All that was looked at for answers from full pictures."""
        combined = EvaluationLog()
        for sent in self:
            if sent.log is not None and sent.reduced == 1:
                combined.add(sent.log)
        return combined

    def clear(self) -> None:
        self._sent.clear()
        self._given_up.clear()

    def keep(self, requests: Collection[Request]) -> None:
        wanted = set(requests)
        self._sent = {request: sent for request, sent in self._sent.items() if request in wanted}
        self._given_up &= wanted

    def is_due(self, request: Request, key: Hashable, reduced: int = 1) -> bool:
        """Whether the query is to be answered: its answer depends on something else by now."""
        if request in self._given_up:
            return False
        sent = self._sent.get(request)
        return key is None or sent is None or (sent.key, sent.reduced) != (key, reduced)

    def put(self, request: Request, sent: Sent) -> None:
        self._sent[request] = sent

    @property
    def has_given_up(self) -> bool:
        """Whether something that is wanted is left unanswered."""
        return bool(self._given_up)

    def give_up(self, requests: Collection[Request]) -> None:
        """Leave these unanswered until there is an edit."""
        self._given_up.update(requests)

    def take_up(self, *, errors: bool = False) -> None:
        """Answer again what was given up, and with `errors` what was answered by an error."""
        self._given_up.clear()
        if errors:
            self._sent = {
                request: sent for request, sent in self._sent.items() if sent.error is None
            }
