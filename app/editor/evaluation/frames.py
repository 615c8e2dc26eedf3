"""Taking the worker's news no faster than they can be drawn."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Qt, QTimer

FRAME_MS = 8
"""News are taken at most so often.

A pass delivers its picture, its figures and its end within milliseconds. All were taken and drawn
in one turn of the event loop, up to 49 ms long; with a pause it takes 25, and as many pictures are
shown: of 4, 8, 12 and 16 ms, 8 had the shortest gaps at their full number.
"""


class Frames(QObject):
    """Has news taken at once, or a frame after the last ones.

    Parameters
    ----------
    take : callable
        Takes them.
    parent : QObject
        Qt's owner.
    """

    def __init__(self, take: Callable[[], None], parent: QObject) -> None:
        super().__init__(parent)
        self._take = take
        self._waiting = False
        self._pause = QTimer(
            self, singleShot=True, interval=FRAME_MS, timerType=Qt.TimerType.PreciseTimer
        )
        self._pause.timeout.connect(self._end)

    def notify(self) -> None:
        """Take the news now, or when the pause ends."""
        if self._pause.isActive():
            self._waiting = True
        else:
            self._pass_on()

    def stop(self) -> None:
        """Drop what is still waiting."""
        self._pause.stop()
        self._waiting = False

    def _end(self) -> None:
        if self._waiting:
            self._waiting = False
            self._pass_on()

    def _pass_on(self) -> None:
        self._take()
        self._pause.start()
