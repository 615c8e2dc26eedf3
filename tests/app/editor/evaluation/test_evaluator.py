"""The worker behind the window, with the real engine and Qt's event loop."""

import gc
import sys
import threading
from itertools import count

import numpy as np
import pytest

from app.editor.evaluation import evaluator as evaluator_module
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer
from child_process import PATIENCE_S
from core.chain.engine import Engine, PlannedNode
from core.editing.document import Document
from core.editing.operations import set_parameter
from core.evaluation.work import Policy
from core.network.network import Network
from editor_queries import Asking, Gate, Readouts, Samples
from scripted_drag import drag

FINAL = Samples("frame_grabber.image")


@pytest.fixture
def answers(evaluator):
    got = []
    evaluator.answered.connect(got.append)
    return got


@pytest.fixture
def small(opened, session, library):
    """The Kodak network at 64² in the session."""
    network = opened("kodak_kir310").network
    for name in ("width", "height"):
        network = network.with_parameter("scene", name, 64)
    network = network.with_parameter("pupil", "size_x", 64).with_parameter("pupil", "size_y", 64)
    network = network.with_parameter("pupil", "radius", 22.5)
    session.open(Document(network, library=library))
    return session


@pytest.fixture
def settled(qtbot, evaluator):
    return lambda: qtbot.waitUntil(lambda: evaluator.idle)


def computed_afresh(network, port, library):
    """The port's samples by an engine of its own."""
    engine = Engine(library)
    return engine.value(engine.plan(network), port, engine.work(Policy()))


def test_what_is_wanted_is_answered_and_pictures_come_first(evaluator, answers, small, settled):
    evaluator.ask("panel", [Readouts("electronics")])
    evaluator.ask("viewer", [FINAL])
    settled()
    assert [answer.owner for answer in answers] == ["viewer", "panel"]
    picture, figures = answers
    assert picture.error is None
    assert picture.reduced == 1
    truth = computed_afresh(small.network, FINAL.port, small.library)
    assert np.array_equal(picture.value, truth)
    # Table 5.4 of Tantalo 1996 for 1024 samples; 1/(2τ) goes with the number of samples.
    assert figures.value["bandwidth_Hz"] == pytest.approx(294912.0 * 64 / 1024)
    assert evaluator.plan.network is small.network
    # What an edit does not change is not answered again.
    evaluator.ask("viewer", [FINAL, Samples("back.image")])
    settled()
    answers.clear()
    small.do(set_parameter("electronics", "amplifier_snr", 77.0))
    settled()
    assert [answer.query for answer in answers if answer.owner == "viewer"] == [FINAL]


def test_a_burst_of_edits_shows_pictures_meanwhile(evaluator, answers, small, settled, qtbot):
    evaluator.ask("viewer", [FINAL])
    settled()
    answers.clear()
    steps = (set_parameter("aberration", "sigma_x_mrad", 0.05 + 0.01 * i) for i in count())
    seen = drag(qtbot, small, evaluator, steps, lambda so_far: len(so_far.full) >= 5)
    settled()
    generations = [answer.generation for answer in answers]
    assert generations == sorted(generations)
    assert len([answer for answer in answers if answer.reduced == 1]) <= seen.edits
    last = 0.05 + 0.01 * (seen.edits - 1)
    assert small.network.nodes["aberration"].params["sigma_x_mrad"] == last
    truth = computed_afresh(small.network, FINAL.port, small.library)
    assert np.array_equal(answers[-1].value, truth)
    small.undo()  # the drag was one step
    assert small.network.nodes["aberration"].params["sigma_x_mrad"] == 0.1


def test_edits_that_come_while_a_pass_runs_make_one_more(evaluator, answers, small, settled, qtbot):
    gate, done, told = Gate(), [], []
    evaluator.pass_done.connect(done.append)
    evaluator.ask("viewer", [Asking(gate), Asking(told.append)])
    qtbot.waitUntil(gate.entered.is_set)
    done.clear()  # that of opening the document
    for snr in range(50, 60):
        small.do(set_parameter("electronics", "amplifier_snr", float(snr)))
    gate.opened.set()
    settled()
    params = [passing.plan.network.nodes["electronics"].params for passing in told]
    # One pass for all ten edits; the one that ran is given up where it has taken long already.
    assert [each["amplifier_snr"] for each in params] in ([100.0, 59.0], [59.0])
    assert len(done) <= 2


class Waiting(Asking):
    """Asked once edits pause."""

    waits = True


def test_what_waits_is_answered_last(evaluator, answers, small, settled):
    evaluator.ask("late", [Waiting(lambda _: 1, urgency=0)])
    evaluator.ask("figures", [Readouts("electronics")])
    evaluator.ask("picture", [FINAL])
    settled()
    assert [answer.owner for answer in answers] == ["picture", "figures", "late"]


def test_an_answer_older_than_the_newest_is_dropped(evaluator, answers, small, settled):
    evaluator.ask("viewer", [FINAL])
    settled()
    newest = answers[-1].generation
    outbox = evaluator._outbox
    outbox.deliver(Answer(newest - 1, "viewer", FINAL, "late"))
    evaluator._take_news()
    outbox.deliver(Answer(newest, "viewer", FINAL, "in time"))
    evaluator._take_news()
    assert [answer.value for answer in answers[1:]] == ["in time"]


def test_an_open_document_is_not_waited_for_by_the_next(evaluator, answers, small, settled, qtbot):
    gate = Gate()  # never opened: only a stop ends it
    evaluator.ask("viewer", [Asking(gate)])
    qtbot.waitUntil(gate.entered.is_set)
    evaluator.ask("viewer", [FINAL])
    small.open(Document(small.network, library=small.library))
    settled()
    assert [answer.query for answer in answers] == [FINAL]


def test_cancelling_stops_the_pass_until_the_next_edit(evaluator, answers, small, settled, qtbot):
    gate, done = Gate(), []
    evaluator.pass_done.connect(done.append)
    evaluator.ask("viewer", [FINAL])
    evaluator.ask("panel", [Asking(gate)])
    qtbot.waitUntil(gate.entered.is_set)
    evaluator.cancel()
    settled()
    assert done[-1].cancelled
    assert not any(each.cancelled for each in done[:-1])
    assert [answer.owner for answer in answers] == ["viewer"]
    evaluator.ask("other", [Samples("back.image")])  # is answered; what was stopped stays so
    settled()
    assert [answer.owner for answer in answers] == ["viewer", "other"]
    gate.opened.set()
    small.do(set_parameter("electronics", "amplifier_snr", 77.0))
    settled()
    assert [answer.owner for answer in answers[2:]] == ["viewer", "panel"]
    assert not done[-1].cancelled


def test_closing_joins_the_thread_and_gives_python_its_old_pace_back(
    session, qtbot, small, monkeypatch
):
    usual = 0.005  # an evaluator of another test may still be about
    sys.setswitchinterval(usual)
    evaluator = Evaluator(session)
    gate = Gate()
    evaluator.ask("viewer", [Asking(gate)])
    qtbot.waitUntil(gate.entered.is_set)
    assert sys.getswitchinterval() < usual
    names = {thread.name for thread in threading.enumerate()}
    assert "imagechain evaluation" in names
    monkeypatch.setattr(evaluator_module, "JOIN_S", PATIENCE_S)
    evaluator.close()
    assert "imagechain evaluation" not in {thread.name for thread in threading.enumerate()}
    assert sys.getswitchinterval() == usual
    assert evaluator.idle
    small.do(set_parameter("electronics", "amplifier_snr", 77.0))  # is followed no more
    evaluator.close()
    evaluator.deleteLater()


def test_opening_twenty_documents_leaves_nothing_behind(evaluator, small, settled):
    evaluator.ask("viewer", [FINAL])
    store = evaluator._runner._engine.store
    used, threads, planned = [], [], []
    for number in range(20):
        network = small.network.with_parameter("electronics", "amplifier_snr", 50.0 + number)
        small.open(Document(network, library=small.library))
        settled()
        used.append(store.used_bytes)
        threads.append(threading.active_count())
        if number % 10 == 9:
            gc.collect()
            planned.append(sum(isinstance(each, PlannedNode) for each in gc.get_objects()))
    # A slow machine also holds what a preview was made of, which is less than the network's own.
    assert 0 < max(used) <= 2 * min(used)
    assert threads[-1] <= threads[0]
    # What earlier tests have left may be gone only in the end; a preview has a plan of its own.
    assert 0 < planned[-1] < 4 * len(small.network.nodes)
    small.open(Document(Network(), library=small.library))
    settled()
    assert store.used_bytes == 0


def test_no_two_wants_hinder_each_other(evaluator, answers, small, settled):
    """An error of ours is one line; the thread goes on, and nothing is printed."""

    def runs_out(passing):
        raise MemoryError

    def fails(passing):
        return {}["nothing"]

    def divides(passing):
        return float(np.log(np.zeros(1))[0])

    queries = [Asking(function) for function in (runs_out, fails, divides)]
    evaluator.ask("viewer", [*queries, FINAL])
    settled()
    by_query = {answer.query: answer for answer in answers}
    assert "not enough memory" in str(by_query[queries[0]].error)
    assert str(by_query[queries[1]].error) == "internal error: KeyError: 'nothing'"
    assert by_query[queries[2]].value == -np.inf
    assert by_query[FINAL].error is None


def test_only_passes_that_follow_a_change_say_so(small, evaluator, settled):
    """Not those for what is looked at in addition; on a slow machine previews come before."""
    passes = []
    evaluator.pass_done.connect(passes.append)

    def since_last():
        settled()
        found = [done.after_edit for done in passes if not done.cancelled and done.reduced == 1]
        passes.clear()
        return found

    evaluator.ask("viewer", [FINAL])
    assert since_last() == [True]
    evaluator.ask("panel", [Readouts("electronics")])
    assert since_last() == [False]
    evaluator.ask("other viewer", [Samples("scene.image")])
    assert since_last() == [False]
    small.do(set_parameter("electronics", "amplifier_snr", 77.0))
    assert since_last() == [True]
    evaluator.ask("third viewer", [Samples("init.magnitude")])
    assert since_last() == [False]
