"""Which worker computes which points: neighbours together, so that they share what is known."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

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
    """

    def __init__(self, tasks: Sequence[Task]) -> None:
        self._stretches: dict[str, list[Task]] = {}
        self._free: list[list[Task]] = [list(tasks)]
        self._mean_s: float | None = None

    @property
    def left(self) -> int:
        """How many points have not been handed out."""
        return sum(map(len, [*self._free, *self._stretches.values()]))

    def workers(self, names: Iterable[str]) -> None:
        """The workers that there are now; the stretches of others are free."""
        names = list(dict.fromkeys(names))
        for gone in set(self._stretches) - set(names):
            self._free.append(self._stretches.pop(gone))
        new = [name for name in names if name not in self._stretches]
        if not self._stretches and new:
            everything = [task for stretch in self._free for task in stretch]
            self._free = []
            each = -(-len(everything) // len(new)) or 1
            for number, name in enumerate(new):
                self._stretches[name] = everything[number * each : (number + 1) * each]
        for name in new:
            self._stretches.setdefault(name, [])

    def batch(self, worker: str) -> list[Task]:
        """The next points for a worker; none when all are handed out."""
        stretch = self._stretches[worker]
        if not stretch:
            stretch = self._stretches[worker] = self._taken_over()
        size = self._size(len(stretch))
        batch, self._stretches[worker] = stretch[:size], stretch[size:]
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

    def _taken_over(self) -> list[Task]:
        """A stretch of a worker that is gone, or the far half of the longest."""
        while self._free:
            stretch = self._free.pop(0)
            if stretch:
                return stretch
        longest = max(self._stretches, key=lambda name: len(self._stretches[name]))
        stretch = self._stretches[longest]
        half = len(stretch) // 2
        self._stretches[longest] = stretch[:half]
        return stretch[half:]
