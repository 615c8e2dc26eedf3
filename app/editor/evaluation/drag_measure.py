"""How many pictures a second a drag shows, and how long the window stands still meanwhile."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from PySide6.QtCore import QEventLoop, QObject, Qt, QTimer

from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from core.editing.operation import Operation

TICK_MS = 5
GESTURE = "drag measure"


@dataclass
class Drag:
    """What was seen during a drag.

    Parameters
    ----------
    seconds : float
        How long it was.
    edits : int
        How many there were.
    full, previews : list of float
        Moments at which a picture came, since the start, in seconds.
    rest : int
        Number of other answers.
    gaps : list of float
        Times between two turns of the event loop, where `TICK_MS` is due, in seconds.
    """

    seconds: float = 0.0
    edits: int = 0
    full: list[float] = field(default_factory=list)
    previews: list[float] = field(default_factory=list)
    rest: int = 0
    gaps: list[float] = field(default_factory=list)

    @property
    def pictures_per_second(self) -> float:
        """Pictures of full and reduced size."""
        return (len(self.full) + len(self.previews)) / self.seconds

    @property
    def longest_gap(self) -> float:
        """Longest time for which the event loop stood still, in seconds."""
        return max(self.gaps, default=0.0)


def measure_drag(
    session: Session,
    evaluator: Evaluator | None,
    edits: Iterator[Operation],
    *,
    seconds: float = 2.0,
    interval_ms: int = 10,
) -> Drag:
    """Drive edits through the session's document as a drag does, and watch.

    Parameters
    ----------
    session : Session
        Its document is edited in one gesture.
    evaluator : Evaluator or None
        Whose answers count; None measures the event loop alone.
    edits : iterator of Operation
        One for each step of the drag; the measurement ends early if there are no more.
    seconds : float
        How long to drag.
    interval_ms : int
        Time between edits; a mouse moves about every 8 to 16 ms.
    """
    watcher = _Watcher(session, edits)
    if evaluator is not None:
        evaluator.answered.connect(watcher.answer)
    watcher.run(seconds, interval_ms)
    if evaluator is not None:
        evaluator.answered.disconnect(watcher.answer)
    session.end_gesture()
    return watcher.drag


class _Watcher(QObject):
    """Edits and takes notes by timers of the event loop."""

    def __init__(self, session: Session, edits: Iterator[Operation]) -> None:
        super().__init__()
        self.drag = Drag()
        self._session, self._edits = session, edits
        self._loop = QEventLoop(self)
        self._edit_timer = QTimer(self, timerType=Qt.TimerType.PreciseTimer)
        self._edit_timer.timeout.connect(self.edit)
        self._tick_timer = QTimer(self, timerType=Qt.TimerType.PreciseTimer, interval=TICK_MS)
        self._tick_timer.timeout.connect(self.tick)

    def run(self, seconds: float, interval_ms: int) -> None:
        """Drag for so long."""
        QTimer.singleShot(round(seconds * 1000), self._loop.quit)
        self._edit_timer.start(interval_ms)
        self._tick_timer.start()
        self._start = self._last = time.perf_counter()
        self._loop.exec()
        self.tick()
        self._edit_timer.stop()
        self._tick_timer.stop()
        self.drag.seconds = time.perf_counter() - self._start

    def edit(self) -> None:
        """Make one step."""
        operation = next(self._edits, None)
        if operation is None:
            self._loop.quit()
            return
        self._session.do(operation, gesture=GESTURE)
        self.drag.edits += 1

    def tick(self) -> None:
        """Note how long the event loop took to come round."""
        now = time.perf_counter()
        self.drag.gaps.append(now - self._last)
        self._last = now

    def answer(self, answer: Any) -> None:
        """Count an answer."""
        at = time.perf_counter() - self._start
        if answer.want.urgency > 0:
            self.drag.rest += 1
        elif answer.reduced > 1:
            self.drag.previews.append(at)
        else:
            self.drag.full.append(at)
