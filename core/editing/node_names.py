"""Names for new nodes."""

from __future__ import annotations

import itertools
from collections.abc import Container


def fresh_name(wanted: str, taken: Container[str]) -> str:
    """`wanted`, or with the first number behind it that makes it new: ``jitter``, ``jitter_2``."""
    if wanted not in taken:
        return wanted
    head, _, tail = wanted.rpartition("_")
    stem = head if head and tail.isdigit() else wanted
    numbered = (f"{stem}_{number}" for number in itertools.count(2))
    return next(name for name in numbered if name not in taken)
