"""What the window is told of each pass: which ones followed a change."""

import pytest

from app.editor.evaluation.evaluator import Evaluator
from core.editing.operations import set_parameter
from editor_queries import Readouts, Samples

FINAL = [Samples("back.image")]


@pytest.fixture
def evaluator(opened):
    session = opened("first_steps")
    made = Evaluator(session)
    yield made
    made.close()
    made.deleteLater()


@pytest.fixture
def told(evaluator, qtbot):
    """Whether each pass over full pictures was told as one that followed a change, up to idleness.

    On a slow machine previews come before them.
    """
    passes = []
    evaluator.pass_done.connect(passes.append)

    def since_last():
        qtbot.waitUntil(lambda: evaluator.idle)
        found = [done.after_edit for done in passes if not done.cancelled and done.reduced == 1]
        passes.clear()
        return found

    return since_last


def test_what_is_looked_at_in_addition_follows_no_change(evaluator, session, told):
    evaluator.ask("viewer", FINAL)
    assert told() == [True]
    evaluator.ask("panel", [Readouts("blur")])
    assert told() == [False]
    evaluator.ask("other viewer", [Samples("scene.image")])
    assert told() == [False]
    session.do(set_parameter("blur", "sigma_x_mrad", 0.5))
    assert told() == [True]
    evaluator.ask("third viewer", [Samples("init.magnitude")])
    assert told() == [False]
