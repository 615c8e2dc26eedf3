"""Frames of a window on the screen, taken at times of the clip, and their writing as a GIF.

What is done to the window is done from a thread, since Qt runs a loop of its own while something
is dragged. Every frame waits until all is computed and drawn: a slow machine makes the same clip.
"""

import io
import subprocess
import threading
import time
from concurrent.futures import Future
from dataclasses import dataclass

import numpy as np
from PIL import Image
from PySide6.QtCore import QObject, QPointF, QRect, Qt, Signal
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QApplication

from child_process import PATIENCE_S

CAPTION_HEIGHT = 44
QUIET_LOOKS, LOOK_S = 4, 0.02  # so often in turn nothing is computed before a frame is taken
COLOURS = 255  # one is left for what stays as it was
GREYS, COLOURED = 120, 24  # of them greys; by how much the channels of a colour differ
ARROW = ((0, 0), (0, 17), (4, 13.4), (6.8, 19.6), (9.6, 18.4), (6.9, 12.4), (12.2, 12.2))
PAPER, INK, PRESSED = "#15181b", "#e8eaed", "#f2c94c"


class MainThread(QObject):
    """Has functions called in the thread it was made in, also from inside a drag."""

    _posted = Signal(object)

    def __init__(self):
        super().__init__()
        self._posted.connect(lambda work: work(), Qt.ConnectionType.QueuedConnection)

    def call(self, function):
        """What the function gives, or raises."""
        answer = Future()

        def work():
            try:
                answer.set_result(function())
            except Exception as error:  # it belongs to the thread that waits
                answer.set_exception(error)

        self._posted.emit(work)
        return answer.result(PATIENCE_S)


@dataclass
class Pointer:
    """Where the mouse is on the screen, and whether its button is down."""

    x: float
    y: float
    down: bool = False


class Clip:
    """A pointer and keys that move at the clip's pace, a caption, and the frames so far.

    Parameters
    ----------
    window : MainWindow
        It fills the screen.
    frames_per_s : float
        Of the clip; fewer make a short one of the same session.
    """

    def __init__(self, window, frames_per_s):
        self.window, self.frames_per_s = window, frames_per_s
        self.main = MainThread()
        size = window.size()
        self.pointer = Pointer(0.62 * size.width(), 0.22 * size.height())
        self.caption = ""
        self.frames = []

    def play(self, session):
        """Run a session, a function of this clip, in a thread while the window lives here."""
        app, failures = QApplication.instance(), []

        def work():
            try:
                session(self)
            except BaseException as error:
                failures.append(error)
            finally:
                self.main.call(app.quit)

        thread = threading.Thread(target=work)
        thread.start()
        app.exec()
        thread.join(PATIENCE_S)
        if failures:
            raise failures[0]

    def ask(self, function):
        """What a function gives in the window's thread."""
        return self.main.call(function)

    # What the hand does; every one of these takes its time of the clip

    def rest(self, seconds):
        """Nothing moves."""
        for _ in range(max(1, round(seconds * self.frames_per_s))):
            self.frame()

    def glide(self, point, seconds, least=1):
        """Move to a point of the screen, slowly at both ends."""
        x0, y0 = self.pointer.x, self.pointer.y
        count = max(least, round(seconds * self.frames_per_s))
        for number in range(1, count + 1):
            part = number / count
            part = part * part * (3 - 2 * part)
            self.pointer.x = x0 + (point.x() - x0) * part
            self.pointer.y = y0 + (point.y() - y0) * part
            self._mouse("mousemove", round(self.pointer.x), round(self.pointer.y))
            self.frame()

    def press(self):
        """Hold the button down."""
        self._mouse("mousedown", 1)
        self.pointer.down = True
        self.frame()

    def release(self):
        """Let the button go."""
        self._mouse("mouseup", 1)
        self.pointer.down = False
        self.frame()

    def click(self, times=1, held_key=None):
        """Press and let go, at once: a double-click must not be slow."""
        if held_key:
            self._mouse("keydown", held_key)
        self._mouse("click", "--repeat", times, "--delay", 30, 1)
        if held_key:
            self._mouse("keyup", held_key)
        self.pointer.down = True
        self.frame()
        self.pointer.down = False
        self.frame()

    def keys(self, *names):
        """Keys as xdotool calls them."""
        self._mouse("key", "--delay", 12, *names)
        self.frame()

    def type(self, text):
        """A frame for each letter."""
        for letter in text:
            self._mouse("type", "--", letter)
            self.frame()

    def until(self, condition, what):
        """The window has to come to this, without a frame meanwhile."""
        end = time.monotonic() + PATIENCE_S
        while not self.ask(condition):
            assert time.monotonic() < end, f"waited {PATIENCE_S:g} s in vain: {what}"
            time.sleep(LOOK_S)

    def frame(self):
        """Wait until all is computed and drawn, and take the screen."""
        quiet, end = 0, time.monotonic() + PATIENCE_S
        while quiet < QUIET_LOOKS:
            assert time.monotonic() < end, "the window computes without an end"
            time.sleep(LOOK_S)
            quiet = quiet + 1 if self.ask(lambda: self.window.evaluator.idle) else 0
        self.frames.append(self.ask(self._taken))

    def _taken(self):
        grabbed = QApplication.primaryScreen().grabWindow(0).toImage()
        whole = QImage(
            grabbed.width(), grabbed.height() + CAPTION_HEIGHT, QImage.Format.Format_RGB888
        )
        whole.fill(QColor(PAPER))
        with QPainter(whole) as painter:
            painter.drawImage(0, 0, grabbed)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            _draw_pointer(painter, self.pointer)
            font = QFont(painter.font())
            font.setPixelSize(20)
            painter.setFont(font)
            painter.setPen(QColor(INK))
            strip = QRect(0, grabbed.height(), whole.width(), CAPTION_HEIGHT)
            painter.drawText(strip, Qt.AlignmentFlag.AlignCenter, self.caption)
        return _pillow(whole)

    def _mouse(self, *words):
        subprocess.run(["xdotool", *map(str, words)], check=True, timeout=PATIENCE_S)


def _draw_pointer(painter, pointer):
    """What a grabbed screen lacks."""
    tip = QPointF(pointer.x, pointer.y)
    if pointer.down:
        painter.setPen(QPen(QColor(PRESSED), 2.5))
        painter.drawEllipse(tip, 13, 13)
    arrow = QPainterPath(tip)
    for x, y in ARROW[1:]:
        arrow.lineTo(tip + QPointF(x, y))
    arrow.closeSubpath()
    painter.setPen(QPen(QColor("black"), 1.4))
    painter.setBrush(QColor("white"))
    painter.drawPath(arrow)
    painter.setBrush(Qt.BrushStyle.NoBrush)


def _pillow(image):
    size, line = (image.width(), image.height()), image.bytesPerLine()
    return Image.frombytes("RGB", size, bytes(image.constBits()), "raw", "RGB", line, 1)


def gif(frames, *, frames_per_s):
    """An endless GIF in one palette; of a frame, what differs from the one before.

    Parameters
    ----------
    frames : list of Image
        In RGB, all of one size.
    frames_per_s : float
        How fast it is played; GIF counts in hundredths of a second.
    """
    palette = _palette(frames[:: max(1, len(frames) // 12)])
    plain = [one.quantize(palette=palette, dither=Image.Dither.NONE) for one in frames]
    written = io.BytesIO()
    plain[0].save(
        written,
        "GIF",
        save_all=True,
        append_images=plain[1:],
        duration=round(100 / frames_per_s) * 10,
        loop=0,
        disposal=1,
        optimize=True,
    )
    return written.getvalue()


def _palette(frames):
    """Greys and colours in shares of their own: the few lines in colour would lose theirs."""
    samples = np.concatenate([np.asarray(one).reshape(-1, 3) for one in frames])
    coloured = np.ptp(samples.astype(int), axis=1) > COLOURED
    entries = []
    for chosen, count in ((samples[~coloured], GREYS), (samples[coloured], COLOURS - GREYS)):
        if len(chosen):
            row = Image.fromarray(np.ascontiguousarray(chosen[None]))
            cut = row.quantize(count, method=Image.Quantize.MEDIANCUT)
            entries += cut.getpalette()[: 3 * count]
    palette = Image.new("P", (1, 1))
    palette.putpalette(entries)
    return palette
