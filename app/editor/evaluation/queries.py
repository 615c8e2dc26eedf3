"""Questions about a network, their answers, and how both pass between window and worker; badges."""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Literal

from app.editor.declared_text import error_text
from core.chain.engine import Engine, Plan, PlannedNode
from core.chain.skipped import Skip
from core.errors import Cancelled, ImagechainError, ParameterError, UnconnectedError
from core.evaluation.work import Work
from core.modules.declaration import Library, declaration
from core.modules.parameters import Caution
from core.network.macro import SEPARATOR
from core.network.network import Network, reached
from core.records import dataclass, field

BadgeKind = Literal["stale", "running", "error", "incomplete", "warning", "skipped", "disabled"]


@dataclass(frozen=True)
class Passing:
    """One pass over a network, as a query is answered from it.

    `work` raises `Cancelled` when the pass is to stop. `reduced` is 1, or how many times smaller
    each side of the pictures is in a preview: at their sources. Where pixels are combined later,
    less is left of it.
    """

    engine: Engine
    plan: Plan
    work: Work
    reduced: int = 1


class Query(ABC):
    """A question about a network, answered again after each change. An immutable, hashable value.

    `urgency` orders the queries of a pass, the lowest first: 0 pictures, 1 what stands beside them,
    2 all else. `from_preview`: whether a picture of reduced size answers it. One that `waits` is
    answered only once edits pause and all others are, and stops for whatever comes.
    """

    urgency: ClassVar[int] = 2
    from_preview: ClassVar[bool] = False
    waits: ClassVar[bool] = False

    @abstractmethod
    def key(self, plan: Plan) -> Hashable:
        """What the answer depends on; None: answer always. An `ImagechainError` is an answer."""

    @abstractmethod
    def answer(self, passing: Passing) -> Any:
        """The answer as shown, or an `ImagechainError`; in the worker's thread, without Qt."""


@dataclass(frozen=True)
class Answer:
    """The answer to a query; None with an `error`.

    Of `generation`, the number of the pass, later ones are larger. `owner` is the part of the
    window that posted the query. `reduced` is above 1 in a preview.
    """

    generation: int
    owner: str
    query: Query
    value: Any = None
    error: ImagechainError | None = None
    reduced: int = 1


@dataclass(frozen=True)
class Badge:
    kind: BadgeKind
    text: str
    parameters: tuple[str, ...] = ()  # those that an error is about


@dataclass(frozen=True)
class PassDone:
    """A pass has ended: how long it took, and how.

    `after_edit`: whether it was the first after an edit, after all was generated or after the
    document was opened, and not one for what is looked at in addition.
    """

    generation: int
    seconds: float
    reduced: int = 1
    cancelled: bool = False
    after_edit: bool = False


@dataclass(frozen=True)
class Busy:
    node: str | None
    seconds: float
    done: int
    wanted: int


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
    def __init__(self) -> None:
        self._changed = threading.Condition()
        self.newest: Snapshot | None = None
        self._taken = 0
        self.stopped = False
        self.cancelled = 0

    @property
    def waiting(self) -> bool:
        newest = self.newest
        return self.stopped or (newest is not None and newest.generation > self._taken)

    def tell(self, **news: Any) -> None:
        """The `newest` snapshot, a generation to be `cancelled`, or that all is `stopped`."""
        with self._changed:
            vars(self).update(news)
            self._changed.notify()

    def take(self) -> Snapshot | None:
        """Wait for a snapshot that was not taken yet; None when it is time to stop."""
        with self._changed:
            self._changed.wait_for(lambda: self.waiting)
            if self.stopped or self.newest is None:
                return None
            self._taken = self.newest.generation
            return self.newest

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
    """Gathers what the worker delivers; `wake` is called in its thread, once for all of it."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._lock = threading.Lock()
        self._wake = wake
        self._woken = False
        self._news = News(0)
        self.closed = False

    @property
    def full(self) -> bool:
        return self._woken

    def begin(self, document: int) -> None:
        """From now on it is about that document; what is left of another is dropped."""
        with self._lock:
            if document != self._news.document:
                self._news = News(document)

    def deliver(
        self, answer: Answer | None = None, done: PassDone | None = None, **latest: Any
    ) -> None:
        with self._lock:
            news = self._news
            vars(news).update(latest)
            if answer is not None:
                news.answers.pop((answer.owner, answer.query), None)
                news.answers[answer.owner, answer.query] = answer
            if done is not None:
                news.done.append(done)
            wake = not (self._woken or self.closed)
            self._woken |= wake
        if wake:
            self._wake()

    def take(self) -> News:
        with self._lock:
            self._woken = False
            news, self._news = self._news, News(self._news.document)
        return news


DISABLED = "disabled: the node passes any input through"
STALE = (
    "not updated: the result is from before your last changes; choose Generate Image to update it"
)
IDENTITY = "skipped: the node has no effect with these settings"


def badges(
    plan: Plan,
    library: Library,
    *,
    stale: Collection[str] = (),
    met: Iterable[ImagechainError] = (),
    skipped: Mapping[str, str] | None = None,
    warned: Iterable[Caution] = (),
) -> dict[str, Badge]:
    """Badges by node; a node that only runs has none.

    An error stands on the node it belongs to alone; the nodes after it wait for that. `stale` names
    nodes held back that would give something else by now, `met` are errors met while computing,
    `skipped` is from `skip_texts`, `warned` are warnings for which samples were looked at.
    """
    by_node: dict[str, Badge] = {}
    warned = tuple(warned)
    badge: Badge | None
    for name, planned in plan.nodes.items():
        if planned.error is not None:
            badge = _of_error(plan.network, library, name, planned.error)
        else:
            texts = [
                warning.text for warning in (*planned.warnings, *warned) if warning.node == name
            ]
            badge = _of_state(planned, name in stale, (skipped or {}).get(name), "\n".join(texts))
        if badge is not None:
            by_node[name] = badge
    for error in met:
        node = error.node
        if node is not None and node in plan.nodes and not _fails(by_node.get(node)):
            by_node[node] = _faulty(error)
            for name in reached(plan.network.followers, [node]) - {node}:
                if not _fails(by_node.get(name)):
                    by_node[name] = Badge("incomplete", f"waiting for {node}")
    return by_node


_URGENT: tuple[BadgeKind, ...] = ("error", "incomplete", "running", "warning", "stale")


def with_macros(by_node: Mapping[str, Badge], network: Network) -> dict[str, Badge]:
    """The badges, and on each macro the gravest of the nodes inside, which `network` has too."""
    shown = dict(by_node)
    for name, node in network.nodes.items():
        if node.macro is None:
            continue
        if node.disabled:
            shown[name] = Badge("disabled", DISABLED)
            continue
        head = f"{name}{SEPARATOR}"
        inside = [(other, badge) for other, badge in by_node.items() if other.startswith(head)]
        for kind in _URGENT:
            texts = [f"{other}: {badge.text}" for other, badge in inside if badge.kind == kind]
            if texts:
                shown[name] = Badge(kind, "\n".join(texts))
                break
    return shown


def skip_texts(skips: Sequence[Skip]) -> dict[str, str]:
    """What is left out of the work of nodes that are left out, or nearly so."""
    by_node: dict[str, list[str]] = {}
    for skip in skips:
        if skip.kind == "below_budget":
            bound = (
                "" if skip.bound is None else f" (at most {skip.bound:.1g} of the picture's range)"
            )
            by_node.setdefault(skip.node, []).append(skip.text + bound)
    for skip in skips:
        if skip.kind == "region" and skip.node in by_node:
            by_node[skip.node].append(skip.text)
    return {name: "\n".join(texts) for name, texts in by_node.items()}


def _of_state(
    planned: PlannedNode, stale: bool, skipped: str | None, warning_text: str
) -> Badge | None:
    if stale:
        return Badge("stale", f"{STALE}\n{warning_text}" if warning_text else STALE)
    if warning_text:
        skipped = IDENTITY if planned.is_neutral else skipped
        return Badge("warning", f"{warning_text}\n{skipped}" if skipped else warning_text)
    if planned.node.disabled:
        return Badge("disabled", DISABLED)
    if planned.is_neutral:
        return Badge("skipped", IDENTITY)
    return Badge("skipped", skipped) if skipped else None


def _of_error(network: Network, library: Library, name: str, error: ImagechainError) -> Badge:
    if error.node not in (None, name):
        return Badge("incomplete", f"waiting for {error.node}")
    if isinstance(error, UnconnectedError):
        return Badge("incomplete", f"not connected: {_unconnected(network, library, name)}")
    return _faulty(error)


def _faulty(error: ImagechainError) -> Badge:
    parameters = error.parameters if isinstance(error, ParameterError) else ()
    return Badge("error", error_text(error, on_node=True), parameters)


def _unconnected(network: Network, library: Library, name: str) -> str:
    linked = {link.input for link in network.links_into(name)}
    ports = declaration(library[network.nodes[name].module]).inputs
    missing = [port for port in ports if port.required and port.name not in linked]
    kinds = [(port.name, " or ".join(port.types)) for port in missing]
    return ", ".join(f"{name} needs a{'n' * (of[:1] in 'aeiou')} {of}" for name, of in kinds)


def _fails(badge: Badge | None) -> bool:
    return badge is not None and badge.kind in ("error", "incomplete")


def as_error(error: Exception) -> ImagechainError:
    if isinstance(error, ImagechainError) and not isinstance(error, Cancelled):
        return error
    if isinstance(error, MemoryError):
        return ImagechainError(
            "not enough memory: make the picture smaller, or close other pictures"
        )
    reason = " ".join(str(error).split())[:200]
    return ImagechainError(f"internal error: {type(error).__name__}: {reason}")
