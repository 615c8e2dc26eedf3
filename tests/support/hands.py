"""A person's hands: real mouse and key events, sent to the X server by xdotool.

They are sent from a thread: while a drag goes on, Qt runs a loop of its own and returns to nobody.
"""

import subprocess
import threading
import time
from functools import partial

from PySide6.QtCore import QCoreApplication, QEventLoop, QPoint

from child_process import PATIENCE_S

PAUSE = 0.012  # between two movements: a quick hand
STEPS = 6
STILL = 6  # looks at a widget that find it in its place


class Hands:
    """Moves the pointer to points of the screen, presses buttons and keys."""

    def click(self, point, *, button=1, times=1):
        x, y = _xy(point)
        self._run([["mousemove", x, y], ["sleep", "0.02"], ["click", "--repeat", times, button]])

    def double_click(self, point):
        x, y = _xy(point)
        self._run([["mousemove", x, y], ["click", "--repeat", "2", "--delay", "40", "1"]])

    def drag(self, start, end, *, button=1, hold=0.0):
        """Press at one point, move in steps, release at the other."""
        (x0, y0), (x1, y1) = _xy(start), _xy(end)
        moves = []
        for step in range(1, STEPS + 1):
            part = step / STEPS
            x, y = round(x0 + (x1 - x0) * part), round(y0 + (y1 - y0) * part)
            moves += [["mousemove", x, y], ["sleep", PAUSE]]
        jiggle = [["mousemove", x1 + 1, y1], ["mousemove", x1, y1], ["sleep", 0.03 + hold]]
        press = [["mousemove", x0, y0], ["sleep", 0.03], ["mousedown", button], ["sleep", 0.03]]
        self._run([*press, *moves, *jiggle, ["mouseup", button], ["sleep", 0.03]])

    def wheel(self, point, clicks):
        x, y = _xy(point)
        button = 4 if clicks > 0 else 5
        self._run([["mousemove", x, y], ["click", "--repeat", abs(clicks), button]])

    def type(self, text):
        self._run([["type", "--delay", "6", "--", text]])

    def enter(self, text, *first):
        """Keys, then a text over what is there, and Return."""
        keys = ["key", "--delay", "12", *first, "ctrl+a"]
        self._run([keys, ["type", "--delay", "6", "--", text]])
        self.keys("Return")

    def keys(self, *names):
        """Keys as xdotool calls them: ``ctrl+z``, ``Tab``, ``question``."""
        self._run([["key", "--delay", "12", *names]])

    def _run(self, commands):
        # One program does them one after the other: to start it takes longer than a movement.
        words = [str(word) for command in commands for word in command]
        call = partial(subprocess.run, ["xdotool", *words], check=True, timeout=PATIENCE_S)
        thread = threading.Thread(target=call)
        thread.start()
        while thread.is_alive():
            process_events(0.004)
        process_events(0.02)


def process_events(seconds):
    """Let the window live for a while."""
    end = time.monotonic() + seconds
    while True:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 5)
        if time.monotonic() >= end:
            return
        time.sleep(0.001)


def wait_until(condition, what, seconds=PATIENCE_S):
    """Let the window live until something is so."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"waited {seconds:g} s in vain: {what}"
        process_events(0.01)


def wait_still(widget, seconds=PATIENCE_S):
    """Wait until a widget stays where it is: a panel just opened is laid out in several steps."""
    end = time.monotonic() + seconds
    place, since = None, 0
    while since < STILL:
        assert time.monotonic() < end, f"{widget.objectName()} has moved for {seconds:g} s"
        process_events(0.02)
        now = widget.mapToGlobal(QPoint(0, 0)), widget.size()
        place, since = now, since + 1 if now == place else 0


def centre(widget):
    """The middle of a widget on the screen."""
    return widget.mapToGlobal(widget.rect().center())


def _xy(point):
    return (point.x(), point.y()) if isinstance(point, QPoint) else point
