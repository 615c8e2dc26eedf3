"""Garbage is collected in the window's thread, and all of it only in quiet moments."""

import gc
import threading
import weakref

import pytest

from app.editor.evaluation import evaluator as evaluator_module
from app.editor.evaluation.evaluator import Collector, Evaluator
from child_process import PATIENCE_S
from editor_queries import Asking


class Ring:
    """An object that only the collector frees."""

    def __init__(self, freed):
        self.itself = self
        weakref.finalize(self, lambda: freed.append(threading.current_thread()))


@pytest.fixture(autouse=True)
def _python_collects(qapp):
    """As where a window starts; in the editor's tests Python does not."""
    qapp.setProperty("imagechain_collectors", 0)  # a long computation of another test may hold on
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


def test_where_collecting_is_off_it_stays_so(qtbot):
    gc.disable()
    made = Collector(lambda: True)
    made.start()
    made.stop()
    assert not gc.isenabled()
    made.deleteLater()


@pytest.mark.parametrize("first_to_stop", [0, 1])
def test_of_several_the_last_switches_it_on(qtbot, first_to_stop):
    both = [Collector(lambda: True), Collector(lambda: True)]
    for each in both:
        each.start()
    both.pop(first_to_stop).stop()
    assert not gc.isenabled()
    (last,) = both
    last.stop()
    assert gc.isenabled()


def test_it_is_off_from_the_first_line_of_an_evaluation_to_its_last(session, qtbot, monkeypatch):
    monkeypatch.setattr(evaluator_module, "JOIN_S", 0.0)
    entered, leave, seen = threading.Event(), threading.Event(), []

    def long_computation(_passing):
        entered.set()
        leave.wait(PATIENCE_S)

    def note(_frame, _event, _about):
        if threading.current_thread().name == "imagechain evaluation":
            seen.append(gc.isenabled())

    threading.setprofile(note)
    try:
        evaluator = Evaluator(session)
        evaluator.ask("viewer", [Asking(long_computation)])
        qtbot.waitUntil(entered.is_set)
    finally:
        threading.setprofile(None)
    assert set(seen) == {False}
    (thread,) = (each for each in threading.enumerate() if each.name == "imagechain evaluation")
    evaluator.close()
    assert thread.is_alive()
    assert not gc.isenabled()
    leave.set()
    thread.join(PATIENCE_S)
    evaluator.deleteLater()


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
