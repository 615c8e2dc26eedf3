"""A slider dragged by the mouse in the window: pictures a second, and gaps of the event loop.

Given the side of the pictures, and if wanted the seconds of a drag, how many drags, and nodes with
their parameters (node.parameter), one after the other.
"""

import json
import math
import os
import sys
import time
from dataclasses import replace
from statistics import median

from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QSlider, QStyle, QStyleOptionSlider

from app.editor.window.files import open_named
from app.editor.window.main_window import MainWindow
from core.editing.document import Document
from core.editing.operations import set_parameter
from trial_window import PaintedPictures, live, settle, trial_window

NODE, PARAMETER = "aberration", "sigma_x_mrad"
MOVES_PER_S = 60
STEP_PX = 2
TICK_MS = 2


class Gaps:
    """How long the event loop did nothing else, by a timer that is always due."""

    def __init__(self) -> None:
        self.gaps: list[float] = []
        self._last = time.perf_counter()
        self._timer = QTimer(interval=TICK_MS, timerType=Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self._timer.start()

    def stop(self) -> list[float]:
        """Gaps in milliseconds."""
        self._timer.stop()
        return [1e3 * gap for gap in self.gaps]

    def _tick(self) -> None:
        now = time.perf_counter()
        self.gaps.append(now - self._last)
        self._last = now


def main(size: int, duration_s: float, times: int, *sliders: str) -> None:
    """Drag sliders of the Kodak chain on a picture of size², each time anew, and count."""
    with trial_window() as (_, window):
        for slider in sliders or (f"{NODE}.{PARAMETER}",):
            for _ in range(times):
                handle = open_slider(window, size, *slider.split("."))
                print(json.dumps({"size": size, **measured(window, handle, duration_s)}))


def measured(window: MainWindow, slider: QSlider, duration_s: float) -> dict[str, float]:
    """Drag the slider, and measure what was painted."""
    painted = PaintedPictures(window, window.viewers.images[1])
    gaps = Gaps()
    start = time.monotonic()
    drag(slider, duration_s)
    seconds = time.monotonic() - start
    gaps_ms = gaps.stop()
    settle(window)
    return {
        "seconds": seconds,
        "pictures": len(painted.times),
        "pictures_per_s": len(painted.times) / seconds,
        "previews": painted.reduced,
        "largest_gap_ms": max(gaps_ms),
        "median_gap_ms": median(gaps_ms),
        "gaps_over_30_ms": sum(gap > 30 for gap in gaps_ms),
        "gaps_over_50_ms": sum(gap > 50 for gap in gaps_ms),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else math.nan,
    }


def open_slider(
    window: MainWindow, size: int, node: str = NODE, parameter: str = PARAMETER
) -> QSlider:
    """Open the Kodak chain with pictures of size², nothing computed yet but what is shown."""
    library = window.session.library
    network = open_named("kodak_kir310", library=library)[0].network
    for side in ("width", "height"):
        network = set_parameter("scene", side, size).apply(network)
    window.files.show(Document(replace(network), library=library))
    settle(window)
    window.session.select([node])
    settle(window)
    # Of the present panel: that of the network before may not be deleted yet.
    slider = window.panels.panels[node].findChild(QSlider, f"slider.{parameter}")
    assert isinstance(slider, QSlider)
    return slider


def handle_of(slider: QSlider) -> QPoint:
    """Where the mouse takes hold of it."""
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    control, part = QStyle.ComplexControl.CC_Slider, QStyle.SubControl.SC_SliderHandle
    return slider.style().subControlRect(control, option, part, slider).center()


def drag(slider: QSlider, duration_s: float) -> None:
    """Press on the handle and move it to and fro, so that each move is another value.

    By a sine, moves near its turning points gave none, the more the narrower the slider was.
    """
    handle, left = handle_of(slider), Qt.MouseButton.LeftButton
    QTest.mousePress(slider, left, pos=handle)
    span, middle = round(slider.width() * 0.35), slider.width() // 2
    begin = time.monotonic()
    x, step = 0, STEP_PX
    for number in range(round(duration_s * MOVES_PER_S)):
        step = -step if abs(x + step) > span else step
        x += step
        QTest.mouseMove(slider, QPoint(middle + x, handle.y()))
        due = begin + (number + 1) / MOVES_PER_S
        live(max(due - time.monotonic(), 0.001))
    QTest.mouseRelease(slider, left, pos=QPoint(middle, handle.y()))


if __name__ == "__main__":
    size, duration_s, times, *dragged = (*sys.argv[1:], *("4", "1")[len(sys.argv) - 2 :])
    main(int(size), float(duration_s), int(times), *dragged)
