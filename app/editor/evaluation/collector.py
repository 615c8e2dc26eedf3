"""Collecting Python's garbage in the window's thread, and the long way only in quiet moments.

A collection of all objects stops every thread, longer the more there are (14 ms of 42 000), and
starts when a computation allocates most: the event loop stood still for 105 to 142 ms while a scene
was drawn, 18 to 53 ms without it. It may also take widgets apart in a worker's thread, which Qt
does not allow: what is left of a closed window holds widgets, and the process hangs or crashes.
"""

from __future__ import annotations

import gc
from collections.abc import Callable

from PySide6.QtCore import QCoreApplication, QObject, Qt, QTimer
from PySide6.QtGui import QGuiApplication

LOOK_MS = 200
# Properties of the application: collectors at work in its process, and whether Python's own
# collection was on before the first.
_COUNT, _WAS_ON = "imagechain_collectors", "imagechain_collection_was_on"


class Collector(QObject):
    """Takes the place of Python's own collector from `start` to `stop`.

    Parameters
    ----------
    is_quiet : callable
        Whether a stop of a tenth of a second would go unnoticed.
    parent : QObject, optional
        Qt's owner.
    """

    def __init__(self, is_quiet: Callable[[], bool], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._is_quiet = is_quiet
        self._timer = QTimer(self, interval=LOOK_MS)
        self._timer.timeout.connect(self._look)

    def start(self) -> None:
        """Collect here from now on; to be called before the first thread begins."""
        if not self._timer.isActive():
            self._timer.start()
            _count(1)

    def stop(self, *, resume: bool = True) -> None:
        """Collect no more; the last one switches Python's own collection on if it was on before.

        Parameters
        ----------
        resume : bool
            False where a thread goes on computing: Python's own collection stays off.
        """
        if self._timer.isActive():
            self._timer.stop()
            if resume:
                _count(-1)

    def _look(self) -> None:
        """Collect what is due by Python's own thresholds."""
        due = [count > most for count, most in zip(gc.get_count(), gc.get_threshold(), strict=True)]
        resting = QGuiApplication.mouseButtons() == Qt.MouseButton.NoButton
        if due[2] and resting and self._is_quiet():
            gc.collect()
        elif due[1]:
            gc.collect(1)
        elif due[0]:
            gc.collect(0)


def _count(change: int) -> None:
    """Note that one more, or one less, collects; Python's switch is that of the whole process."""
    application = QCoreApplication.instance()
    before = application.property(_COUNT) or 0
    application.setProperty(_COUNT, before + change)
    if before == 0:
        application.setProperty(_WAS_ON, gc.isenabled())
        gc.disable()
    elif before + change == 0 and application.property(_WAS_ON):
        gc.enable()
