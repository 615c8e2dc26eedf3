"""Queries that wait until edits pause, and what they leave alone."""

from dataclasses import dataclass

import pytest

from app.editor.evaluation import runner
from app.editor.evaluation.evaluator import Evaluator
from child_process import PATIENCE_S
from core.editing.operations import set_parameter
from editor_queries import Asking, Readouts, Samples


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
