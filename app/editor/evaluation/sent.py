"""What has been answered already, and need not be answered again."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator
from dataclasses import dataclass

from app.editor.evaluation.mailbox import Request
from core.errors import ImagechainError
from core.evaluation.evaluation_log import EvaluationLog


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
        """Forget all."""
        self._sent.clear()
        self._given_up.clear()

    def keep(self, requests: Collection[Request]) -> None:
        """Drop all but these."""
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
        """Note an answer."""
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
