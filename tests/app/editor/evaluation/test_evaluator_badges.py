"""What the worker says of the nodes' state, and of a pass that takes long."""

import numpy as np
import pytest

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import STALE, Badge
from app.editor.session import Session
from core.editing.document import Document
from core.editing.operations import set_node_field, set_parameter
from editor_queries import Readouts, Samples, SlowCopy
from linked_network import linked_network
from nodes.library import standard_library

SCENE = ("test_scene", {"kind": "two_panel", "width": 48, "height": 40})
GEOMETRY = {"detector_x_um": 25.0, "detector_y_um": 25.0, "focal_length_mm": 200.0}


def chain(**jitter):
    """A scene through one MTF and back."""
    return linked_network(
        {
            "scene": SCENE,
            "init": ("init_trans", GEOMETRY),
            "jitter": ("jitter_mtf", jitter),
            "back": ("back_transform", {}),
        }
    )


@pytest.fixture
def slow_session(qtbot):
    made = Session({**standard_library(), "slow_copy": SlowCopy})
    yield made
    made.deleteLater()


@pytest.fixture
def evaluator(slow_session):
    made = Evaluator(slow_session)
    yield made
    made.close()
    made.deleteLater()


@pytest.fixture
def open_network(qtbot, slow_session, evaluator):
    """Open a network, and wait until nothing is left to do."""

    def opened(what, *queries):
        evaluator.ask("viewer", queries)
        slow_session.open(Document(what, library=slow_session.library))
        settle(qtbot, evaluator)
        return slow_session

    return opened


def settle(qtbot, evaluator):
    qtbot.waitUntil(lambda: evaluator.idle)


def test_an_error_stands_on_its_node_and_the_rest_goes_on(evaluator, open_network, qtbot):
    answers = []
    evaluator.answered.connect(answers.append)
    session = open_network(chain(sigma_mrad=1.0), Samples("back.image"), Samples("scene.image"))
    answers.clear()
    session.do(set_parameter("jitter", "sigma_mrad", -1.0))
    session.do(set_parameter("scene", "delta_K", 3.0))
    settle(qtbot, evaluator)
    errors = {answer.query.port: answer.error for answer in answers}
    assert "sigma_mrad = -1.0 mrad is not allowed" in str(errors["back.image"])
    assert errors["back.image"].node == "jitter"
    assert errors["scene.image"] is None
    badges = evaluator.badges
    assert badges["jitter"].kind == "error"
    assert "σ = -1.0 mrad is not allowed" in badges["jitter"].text
    assert badges["back"] == Badge("incomplete", "waiting for jitter")
    assert set(badges) == {"jitter", "back"}
    session.undo()
    session.undo()
    settle(qtbot, evaluator)
    assert evaluator.badges == {}


def test_an_error_met_while_computing_stands_on_its_node(evaluator, open_network, tmp_path, qtbot):
    path = tmp_path / "broken.npy"
    np.save(path, np.array([[1.0, np.nan], [2.0, 3.0]]))
    reading = linked_network(
        {
            "file": ("read_image", {"path": str(path)}),
            "bits": ("interpolate", {"width": 5}),
            "other": ("test_scene", {"width": 8, "height": 8, "kind": "uniform"}),
        }
    )
    session = open_network(reading, Samples("bits.image"), Samples("other.image"))
    badges = evaluator.badges
    assert badges["file"].kind == "error"
    assert badges["bits"] == Badge("incomplete", "waiting for file")
    assert set(badges) == {"file", "bits"}
    session.do(set_parameter("other", "delta_K", 3.0))  # the error stands, unasked again
    settle(qtbot, evaluator)
    assert evaluator.badges == badges
    session.do(set_parameter("file", "missing", "mean"))
    settle(qtbot, evaluator)
    assert evaluator.badges == {}


def test_inputs_that_are_not_connected_are_named(evaluator, open_network):
    nodes = {"jitter": ("jitter_mtf", {}), "back": ("back_transform", {})}
    open_network(linked_network(nodes))
    text = "not connected: context needs a context, magnitude needs a magnitude"
    assert evaluator.badges == {
        "jitter": Badge("incomplete", text),
        "back": Badge("incomplete", "waiting for jitter"),
    }


def test_what_changes_too_little_is_skipped_with_its_bound(evaluator, open_network, qtbot):
    session = open_network(chain(sigma_mrad=1e-6), Samples("back.image"))
    badge = evaluator.badges["jitter"]
    assert badge.kind == "skipped"
    assert "below the error budget" in badge.text
    bound = float(badge.text.split("(")[1].removeprefix("at most ").split()[0])
    assert 0 < bound < np.finfo(np.float32).eps / 8
    # Looked at in the pass before this, it is known still when nobody asks for the picture anew.
    evaluator.ask("panel", [Readouts("init")])
    settle(qtbot, evaluator)
    assert evaluator.badges["jitter"] == badge
    session.do(set_parameter("jitter", "sigma_mrad", 1.0))
    settle(qtbot, evaluator)
    assert "jitter" not in evaluator.badges


def test_a_node_held_back_keeps_its_picture_until_all_is_generated(evaluator, open_network, qtbot):
    answers = []
    evaluator.answered.connect(answers.append)
    port = Samples("back.image")
    session = open_network(chain(sigma_mrad=1.0), port)
    first = answers[-1].value
    session.do(set_node_field("jitter", "auto", False))
    session.do(set_parameter("jitter", "sigma_mrad", 3.0))
    settle(qtbot, evaluator)
    assert evaluator.badges == {"jitter": Badge("stale", STALE)}
    assert len(answers) == 1
    evaluator.generate()
    settle(qtbot, evaluator)
    assert evaluator.badges == {}
    assert len(answers) == 2
    assert not np.array_equal(answers[-1].value, first)
    session.do(set_parameter("jitter", "sigma_mrad", 5.0))
    session.do(set_parameter("jitter", "sigma_mrad", 3.0))  # as it was generated: stale no more
    settle(qtbot, evaluator)
    assert evaluator.badges == {}
    assert len(answers) == 2


def test_a_long_pass_says_where_it_is(evaluator, open_network, qtbot):
    told, badges = [], []
    evaluator.busy_changed.connect(told.append)
    evaluator.badges_changed.connect(badges.append)
    slow = ("slow_copy", {"ns_per_sample": 4e5})  # 1920 samples: 0.77 s
    network = linked_network({"scene": SCENE, "slow": slow}, [("scene.image", "slow.image")])
    open_network(network, Samples("scene.image"), Samples("slow.image"))
    assert told[-1] is None
    during = told[:-1]
    assert 1 <= len(during) <= 6  # ten a second at most
    assert all(busy.node == "slow" and busy.seconds > 0.33 for busy in during)
    assert all((busy.done, busy.wanted) == (1, 2) for busy in during)
    assert badges == [{"slow": Badge("running", "computing")}, {}]
