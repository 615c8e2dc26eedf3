"""A study's points dealt out in batches, to processes of this machine or to a Dask cluster."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Protocol

from app.study.point_rows import Row, Task
from core.errors import Cancelled

_MOST = 500  # points of a batch
_LOOK_S = 0.1


class WorkerEnded(Exception):
    """Who had a batch ended before it was done; `blamed` where a point of it may be why."""

    def __init__(self, *, blamed: bool = True) -> None:
        super().__init__()
        self.blamed = blamed


class Workers(Protocol):
    lanes: int  # how many stretches the points are parted into
    most_ends: int  # of workers within a point, before it is the point's own fault
    why: str  # the error of such a point

    def free(self, busy: Sequence[int]) -> Iterable[int]:
        """Lanes that can take one more batch; `busy` has the lane of each that is out."""

    def submit(self, lane: int, batch: list[Task]) -> Any:
        """A future of the rows of the batch's first points."""

    def has_ended(self, future: Any) -> bool: ...

    def rows(self, future: Any) -> list[Row]: ...


class Lanes:
    """A stretch of the points for each worker; who has come to its end takes half of another's.

    Neighbours so come to one worker, and share what is known. A batch is as long as a worker did
    of the last one in the time it has, or twice that if it did all of it.
    """

    def __init__(self, tasks: Sequence[Task], workers: int) -> None:
        each = -(-len(tasks) // workers) or 1
        self._stretches = [list(tasks[n * each : (n + 1) * each]) for n in range(workers)]
        self._size = 1

    @property
    def left(self) -> int:
        return sum(map(len, self._stretches))

    def batch(self, worker: int) -> list[Task]:
        """The next points for a worker; none when all are handed out."""
        if not self._stretches[worker]:
            longest = max(self._stretches, key=len)
            half = len(longest) // 2
            self._stretches[worker] = longest[half:]
            del longest[half:]
        stretch = self._stretches[worker]
        # Towards the end in smaller ones, so that all workers end together.
        size = min(self._size, -(-len(stretch) // 2))
        batch = stretch[:size]
        del stretch[:size]
        return batch

    def done(self, worker: int, batch: list[Task], rows: int) -> None:
        """So many of a batch's points are done; the others go back."""
        self._stretches[worker][:0] = batch[rows:]
        if batch:
            self._size = min(2 * rows, _MOST) if rows == len(batch) else max(1, rows)


def dealt_rows(
    workers: Workers, tasks: Sequence[Task], figures: int, cancel: threading.Event | None
) -> Iterator[list[Row]]:
    """The rows of points as they come; empty ones when workers are ready.

    The points of a worker that has ended are tried again once all others are done, one at a time
    with nothing beside them: it shows which it was, and one may need all of the memory.
    """
    lanes, again, ends = Lanes(tasks, workers.lanes), list[Task](), Counter[int]()
    out: dict[Any, tuple[int, list[Task]]] = {}
    landed = threading.Event()

    def send(lane: int, batch: list[Task]) -> None:
        future = workers.submit(lane, batch)
        out[future] = lane, batch
        future.add_done_callback(lambda _: landed.set())

    for lane in range(workers.lanes):
        send(lane, [])
    while lanes.left or again or out:
        for lane in workers.free([lane for lane, _ in out.values()]):
            if lanes.left:
                send(lane, lanes.batch(lane))
        if again and not out and not lanes.left:
            send(0, [again.pop()])
        if cancel is not None and cancel.is_set():
            raise Cancelled("stopped on request")
        landed.wait(_LOOK_S)
        landed.clear()
        # Looked at, not waited for: Dask calls nobody for what is lost with its worker.
        for future in [future for future in out if workers.has_ended(future)]:
            lane, batch = out.pop(future)
            try:
                rows = workers.rows(future)
            except WorkerEnded as error:
                ends.update(task[0] for task in batch if error.blamed)
                if len(batch) == 1 and ends[batch[0][0]] >= workers.most_ends:
                    yield [Row(batch[0][0], (None,) * figures, "", 0.0, workers.why)]
                else:
                    again += batch
            else:
                lanes.done(lane, batch, len(rows))
                yield rows
