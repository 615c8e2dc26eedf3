"""What the window is told of each pass: which ones followed a change."""

import pytest

from app.editor.evaluation.evaluator import Evaluator
from core.editing.document import Document
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


def test_to_generate_all_and_to_open_are_changes(evaluator, session, library, told):
    evaluator.ask("viewer", FINAL)
    told()
    evaluator.generate()
    assert told() == [True]
    session.open(Document(session.network, library=library))
    assert told() == [True]


def test_what_is_wanted_once_a_document_is_planned_is_in_its_first_pass(
    evaluator, session, library, told
):
    """Nothing is computed before the window could choose by the plan, and pictures come first."""
    evaluator.ask("panel", [Readouts("blur")])
    told()
    answered = []
    evaluator.answered.connect(lambda answer: answered.append(answer.owner))
    seen = []
    evaluator.planned.connect(lambda plan: seen.append((list(plan.nodes), list(answered))))
    evaluator.planned.connect(lambda _: evaluator.ask("viewer", FINAL))
    evaluator.pass_done.connect(lambda _: answered.append("done"))
    session.open(Document(session.network, library=library))
    assert told() == [True]
    assert seen == [(list(evaluator.plan.nodes), [])]
    assert sorted(answered) == ["done", "panel", "viewer"]
    assert answered[-1] == "done"
    evaluator.ask("other viewer", [Samples("scene.image")])
    assert told() == [False]
