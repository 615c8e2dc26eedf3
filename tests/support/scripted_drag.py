"""Edits that come as those of a drag do, until enough has been seen."""

from dataclasses import dataclass, field
from typing import Any

from PySide6.QtCore import QTimer

INTERVAL_MS = 10  # a mouse moves about every 8 to 16 ms


@dataclass
class Drag:
    """What was seen: the number of edits, pictures of full and of reduced size, other answers."""

    edits: int = 0
    full: list[Any] = field(default_factory=list)
    previews: list[Any] = field(default_factory=list)
    rest: list[Any] = field(default_factory=list)

    def note(self, answer):
        if answer.query.urgency > 0:
            self.rest.append(answer)
        elif answer.reduced > 1:
            self.previews.append(answer)
        else:
            self.full.append(answer)


def drag(qtbot, session, evaluator, edits, enough):
    """Drive edits through the session in one gesture, while the event loop runs.

    They go on as long as `enough` of the `Drag` says no, which is told what was seen so far.
    """
    seen, timer = Drag(), QTimer(interval=INTERVAL_MS)

    def edit():
        session.do(next(edits), gesture="scripted drag")
        seen.edits += 1

    timer.timeout.connect(edit)
    evaluator.answered.connect(seen.note)
    timer.start()
    try:
        qtbot.waitUntil(lambda: enough(seen))
    finally:
        timer.stop()
        evaluator.answered.disconnect(seen.note)
        session.end_gesture()
    return seen
