"""Queries that wait until edits pause, and what they leave alone."""

import threading
from dataclasses import dataclass

import numpy as np
import pytest

from app.editor.docks.tradeoff_view import SideStore, SideWork
from app.editor.evaluation import runner
from app.editor.evaluation.evaluator import Evaluator
from child_process import PATIENCE_S
from core.editing.operations import set_parameter
from core.evaluation.policy import Policy
from core.evaluation.recipes import Step
from core.evaluation.store import Store
from core.evaluation.work import Work
from editor_queries import Asking, Gate, Readouts, Samples


@dataclass(frozen=True)
class Waiting(Asking):
    """Asked once edits pause."""

    waits = True


@pytest.fixture
def evaluator(qtbot, opened):
    made = Evaluator(opened("first_steps"))
    yield made
    made.close()


def blur(session):
    node = next(n for n in session.network.nodes.values() if n.module == "gaussian_mtf")
    return node.id


def test_it_is_answered_last(evaluator, qtbot):
    order = []
    evaluator.answered.connect(lambda answer: order.append(answer.owner))
    session = evaluator._session
    evaluator.ask("late", [Waiting(lambda _: 1, urgency=0)])
    evaluator.ask("figures", [Readouts(blur(session))])
    evaluator.ask("picture", [Samples("back.image")])
    qtbot.waitUntil(lambda: len(order) == 3 and evaluator.idle)
    assert order == ["picture", "figures", "late"]


def test_while_edits_come_it_is_not_asked(evaluator, qtbot, monkeypatch):
    """Pictures follow each edit, the want waits for the pause."""
    session, moments, pictures = evaluator._session, [], []
    name = blur(session)
    evaluator.ask("picture", [Samples("back.image")])
    qtbot.waitUntil(lambda: evaluator.idle)
    evaluator.answered.connect(lambda answer: pictures.append(answer.owner))
    evaluator.ask("late", [Waiting(lambda _: moments.append(len(pictures)))])
    qtbot.waitUntil(lambda: len(moments) == 1)
    del moments[:], pictures[:]
    with monkeypatch.context() as patched:
        # However long a busy machine takes from one edit to the next, it is no pause.
        patched.setattr(runner, "PAUSE_S", PATIENCE_S)
        for number in range(5):
            pictures.clear()
            session.do(set_parameter(name, "sigma_x_mrad", 0.1 + 0.01 * number), gesture="drag")
            qtbot.waitUntil(lambda: "picture" in pictures)
        assert not moments
    session.do(set_parameter(name, "sigma_x_mrad", 0.7), gesture="drag")
    session.end_gesture()
    qtbot.waitUntil(lambda: bool(moments) and evaluator.idle)
    assert len(moments) == 1


def test_it_gives_way_to_an_edit_at_once(evaluator, qtbot):
    session, gate, told = evaluator._session, Gate(), []
    evaluator.answered.connect(told.append)
    evaluator.ask("picture", [Samples("back.image")])
    evaluator.ask("late", [Waiting(gate)])
    qtbot.waitUntil(lambda: gate.entered.is_set() and bool(told))
    del told[:]
    session.do(set_parameter(blur(session), "sigma_x_mrad", 0.77))
    qtbot.waitUntil(lambda: [a.owner for a in told] == ["picture"])
    gate.opened.set()
    qtbot.waitUntil(lambda: [a.owner for a in told] == ["picture", "late"])
    assert told[-1].value == "went on"


def test_cancelled_it_stays_away_until_the_next_edit(evaluator, qtbot):
    session, gate, told = evaluator._session, Gate(), []
    evaluator.answered.connect(told.append)
    evaluator.ask("late", [Waiting(gate)])
    qtbot.waitUntil(gate.entered.is_set)
    evaluator.cancel()
    qtbot.waitUntil(lambda: evaluator.idle)
    assert told == []
    gate.opened.set()
    session.do(set_parameter(blur(session), "sigma_x_mrad", 0.78))
    qtbot.waitUntil(lambda: [a.owner for a in told] == ["late"])


# --- work beside a pass ------------------------------------------------------------------------


def make(work, *, number):
    return np.full(1000, float(number))


def add(work, a, b):
    return a + b


def test_values_beside_a_pass_stay_beside_it():
    base = Store()
    main = Work(Policy(), base)
    known, new = Step.of(make, number=1), Step.of(make, number=2)
    first = main.value(known)
    before = base.used_bytes
    side = SideWork(main)
    both = Step.of(add, known, new)
    assert (side.value(both) == 3.0).all()
    assert known.key not in side.log.computed  # taken from the pass
    assert {new.key, both.key} <= side.log.computed
    assert base.used_bytes == before
    assert side.value(known) is first
    again = Step.of(add, new, known)
    side.value(again)
    assert side.store.used_bytes >= 3 * 8000  # its own it keeps


def test_it_stops_with_the_pass_and_works_in_its_threads():
    cancel = threading.Event()
    main = Work(Policy(threads=2), Store(), cancel)
    side = SideWork(main)
    seen = []
    side.for_each(seen.append, [1, 2, 3])
    assert sorted(seen) == [1, 2, 3]
    cancel.set()
    with pytest.raises(Exception, match="stopped on request"):
        side.check()


def test_a_side_store_forgets_its_own_alone():
    base = Store()
    base.get("a", lambda: np.ones(10))
    side = SideStore(base, 1000)
    for number in range(50):
        side.get(f"n{number}", lambda: np.ones(100))
    assert side.peek("n0", "gone") == "gone"
    assert (side.peek("a") == 1.0).all()
    assert len(base) == 1
