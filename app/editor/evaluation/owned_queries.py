"""Which queries are to be answered, by who posted them, and which answers are still of use."""

from __future__ import annotations

from collections.abc import Sequence

from app.editor.evaluation.mailbox import Request
from app.editor.evaluation.queries import Answer, Query


class OwnedQueries:
    """The queries of every owner, numbered, and what of their answers has come.

    A generation is the number of a state of the window, which later ones exceed.
    """

    def __init__(self) -> None:
        self._requests: dict[str, tuple[Request, ...]] = {}
        self._since: dict[str, int] = {}
        self._answered: dict[str, int] = {}
        self._numbers = 0

    def post(self, owner: str, queries: Sequence[Query], generation: int) -> bool:
        """Have these queries in place of those the owner had; whether they are others.

        Answers count for a new owner from that generation on. A query that stays has the number
        it had.
        """
        before = self._requests.get(owner)
        known = {request.query: request for request in before or ()}
        requests = tuple(known.get(query) or self._numbered(owner, query) for query in queries)
        if requests == before:
            return False
        self._since.setdefault(owner, generation)
        self._requests[owner] = requests
        return True

    def drop(self, owner: str) -> None:
        """Have no queries of that owner."""
        self._requests.pop(owner, None)
        self._since.pop(owner, None)
        self._answered.pop(owner, None)

    def all(self) -> tuple[Request, ...]:
        """The queries of all owners."""
        return tuple(request for group in self._requests.values() for request in group)

    def accept(self, answer: Answer) -> bool:
        """Whether an answer is of use: its owner is there still, and has had no newer one."""
        owner = answer.owner
        since = self._since.get(owner)
        if since is None or answer.generation < max(since, self._answered.get(owner, 0)):
            return False
        self._answered[owner] = answer.generation
        return True

    def _numbered(self, owner: str, query: Query) -> Request:
        self._numbers += 1
        return Request(owner, query, self._numbers)
