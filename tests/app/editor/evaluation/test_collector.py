"""Garbage is collected in the window's thread, and all of it only in quiet moments."""

import gc
import threading
import weakref

import pytest

from app.editor.evaluation.evaluator import Collector
from child_process import PATIENCE_S


class Ring:
    """An object that only the collector frees."""

    def __init__(self, freed):
        self.itself = self
        weakref.finalize(self, lambda: freed.append(threading.current_thread()))


@pytest.fixture(autouse=True)
def _python_collects(qapp):
    """As where a window starts; in the editor's tests Python does not."""
    gc.enable()
    yield
    gc.disable()


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
