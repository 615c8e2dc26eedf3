"""Garbage is collected in the window's thread, and all of it only in quiet moments."""

import gc
import threading
import weakref

import pytest

from app.editor.evaluation.collector import Collector
from child_process import PATIENCE_S


class Ring:
    """An object that only the collector frees."""

    def __init__(self, freed):
        self.itself = self
        weakref.finalize(self, lambda: freed.append(threading.current_thread()))


@pytest.fixture
def quiet():
    return [True]


@pytest.fixture
def collector(qtbot, quiet):
    made = Collector(lambda: quiet[0])
    made.start()
    yield made
    made.stop()
    made.deleteLater()


def test_python_does_not_collect_by_itself_meanwhile(collector):
    assert not gc.isenabled()
    collector.stop()
    assert gc.isenabled()
    collector.stop()
    assert gc.isenabled()


def test_where_collecting_is_off_it_stays_so(qtbot):
    gc.disable()
    try:
        made = Collector(lambda: True)
        made.start()
        made.stop()
        assert not gc.isenabled()
    finally:
        gc.enable()
        made.deleteLater()


def test_what_another_thread_leaves_is_freed_in_this_one(collector, qtbot):
    freed = []
    count = gc.get_threshold()[0] + 300  # more than Python lets be before it collects

    def leave():
        for _ in range(count):
            Ring(freed)

    thread = threading.Thread(target=leave)
    thread.start()
    thread.join(PATIENCE_S)
    assert not freed
    qtbot.waitUntil(lambda: len(freed) == count)
    assert set(freed) == {threading.current_thread()}


def test_all_is_looked_through_only_in_quiet_moments(collector, quiet, qtbot):
    gone_through = []

    def note(phase, about):
        if phase == "stop":
            gone_through.append(about["generation"])

    quiet[0] = False
    gc.collect()
    for _ in range(gc.get_threshold()[2] + 1):
        gc.collect(1)  # Python would look through all at the next occasion
    gc.callbacks.append(note)
    try:
        qtbot.wait(500)
        assert 2 not in gone_through
        quiet[0] = True
        qtbot.waitUntil(lambda: 2 in gone_through)
    finally:
        gc.callbacks.remove(note)
