"""Which worker computes which points: neighbours together, so that they share what is known."""

from __future__ import annotations

from collections.abc import Sequence

from app.study.point_rows import Task

BATCH_S = 0.5
"""How long a batch should take: longer than its way there and back, short enough to lose."""
_FIRST, _MOST = 2, 500
_WEIGHT = 0.3  # of the newest batch in the mean


class Lanes:
    """A stretch of the points for each worker; who has come to its end takes half of another's.

    Parameters
    ----------
    tasks : sequence of Task
        The points in the order in which they repeat least.
    workers : int
        How many there are.
    """

    def __init__(self, tasks: Sequence[Task], workers: int) -> None:
        each = -(-len(tasks) // workers) or 1
        self._stretches = [list(tasks[n * each : (n + 1) * each]) for n in range(workers)]
        self._mean_s: float | None = None

    @property
    def left(self) -> int:
        """How many points have not been handed out."""
        return sum(map(len, self._stretches))

    def batch(self, worker: int) -> list[Task]:
        """The next points for a worker; none when all are handed out."""
        if not self._stretches[worker]:
            longest = max(self._stretches, key=len)
            half = len(longest) // 2
            self._stretches[worker] = longest[half:]
            del longest[half:]
        stretch = self._stretches[worker]
        size = self._size(len(stretch))
        batch = stretch[:size]
        del stretch[:size]
        return batch

    def took(self, seconds: float, points: int) -> None:
        """What a batch took, for the size of the next ones."""
        each = seconds / max(1, points)
        before = self._mean_s
        self._mean_s = each if before is None else before + _WEIGHT * (each - before)

    def _size(self, left: int) -> int:
        if self._mean_s is None:
            return min(_FIRST, left)
        wanted = int(BATCH_S / max(self._mean_s, 1e-9))
        # Towards the end in smaller ones, so that all workers end together.
        return max(1, min(wanted, _MOST, -(-left // 2)))
