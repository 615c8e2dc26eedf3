"""Collecting Python's garbage in the window's thread, and the long way only in quiet moments.

A collection of all objects stops every thread, longer the more there are (14 ms of 42 000), and
starts when a computation allocates most: the event loop stood still for 105 to 142 ms while a scene
was drawn, 18 to 53 ms without it. It may also take widgets apart in a worker's thread, which Qt
does not allow.
"""

from __future__ import annotations

import gc
from collections.abc import Callable

from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtGui import QGuiApplication

LOOK_MS = 200


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
        """Collect here from now on; nothing where Python does not collect by itself."""
        if gc.isenabled():
            gc.disable()
            self._timer.start()

    def stop(self) -> None:
        """Switch Python's own collection on again, if it was on before."""
        if self._timer.isActive():
            self._timer.stop()
            gc.enable()

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
