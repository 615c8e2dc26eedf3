"""Queries: what the parts of the window show of a network, and the answers to them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from core.chain.engine import Engine, Plan
from core.errors import ImagechainError
from core.evaluation.work import Work

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
        """What the answer depends on: the same key, the same answer. None: answer always.

        Called in the worker's thread. An `ImagechainError` counts as the answer.
        """

    @abstractmethod
    def answer(self, passing: Passing) -> Any:
        """The answer, ready to be shown; in the worker's thread, without Qt.

        An `ImagechainError` is what the window shows instead.
        """


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
    """The mark of a node's state, and its tooltip."""

    kind: BadgeKind
    text: str


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
    """A pass that takes longer than a third of a second: where it is."""

    node: str | None
    seconds: float
    done: int
    wanted: int
