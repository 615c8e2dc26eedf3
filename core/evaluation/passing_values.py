"""Values of a long row of recipes that are read once: dropped when the next one comes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.evaluation.evaluation_log import EvaluationLog
from core.evaluation.store import Store

if TYPE_CHECKING:
    from core.evaluation.region import Region


class PassingValues:
    """What each recipe of a row leaves in store and log, beyond what was there before the row.

    What is made a second time right after it was dropped is shared by all of the row: it stays.

    Parameters
    ----------
    store, log : Store, EvaluationLog
        Where recipes leave something.
    suffix : str
        What follows a recipe's key in the store.
    """

    def __init__(self, store: Store, log: EvaluationLog, suffix: str) -> None:
        self._store, self._log, self._suffix = store, log, suffix
        self._computed = set(log.computed)
        self._requested, self._parts = set(log.requested), set(log.parts)
        self._looked_at = set(log.looked_at)
        self._dropped: set[str | tuple[str, Region]] = set()

    def forget(self) -> None:
        """Drop what has been made since the last call and is not held for what comes."""
        made = self._log.computed - self._computed
        self._computed |= made & self._dropped
        self._dropped = made - self._dropped
        for one in self._dropped:
            key, region = (one, "") if isinstance(one, str) else (one[0], f"/{one[1]}")
            self._store.drop(f"{key}{self._suffix}{region}")
        self._log.computed &= self._computed
        for whole in self._log.requested.keys() - self._requested:
            del self._log.requested[whole]
        for part in self._log.parts.keys() - self._parts:
            del self._log.parts[part]
        self._log.looked_at &= self._looked_at
