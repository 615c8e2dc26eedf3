"""When a pass gives way to an edit, and when a picture of reduced size comes first.

While a pass is fast, edits are gathered: the pass is finished, and the next one takes the newest
state. To begin anew at each edit of a drag would show no picture until it ends.
"""

from __future__ import annotations

import time
from collections.abc import Hashable

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
