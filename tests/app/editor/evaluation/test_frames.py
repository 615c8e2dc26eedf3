"""News are passed on at once, and then no faster than they can be drawn."""

import time

import pytest
from PySide6.QtCore import QObject

from app.editor.evaluation.evaluator import FRAME_MS, Frames


@pytest.fixture
def taken():
    return []


@pytest.fixture
def frames(qtbot, taken):
    parent = QObject()
    yield Frames(lambda: taken.append(time.perf_counter()), parent)
    parent.deleteLater()


def test_those_that_come_soon_after_are_passed_on_together(frames, taken, qtbot):
    for _ in range(5):
        frames.notify()
    assert len(taken) == 1
    qtbot.waitUntil(lambda: len(taken) == 2)
    assert taken[1] - taken[0] >= 0.9 * FRAME_MS / 1000
    qtbot.wait(4 * FRAME_MS)
    assert len(taken) == 2
    frames.notify()
    assert len(taken) == 3
