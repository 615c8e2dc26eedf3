"""Undo, redo, going to any position, the lines of the steps, and the modified mark."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.editing.operations import ABSENT, Move, Remove, Restored, set_network_field, set_parameter
from core.errors import NetworkError
from core.network.file import load_network
from core.network.linked_values import expression
from core.network.network import Network


@pytest.fixture
def document(kodak, library):
    return Document(kodak, library=library)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10**6))
def test_every_position_gives_the_text_it_had(kodak, library, seed):
    """Against the texts noted while the steps were done one by one."""
    random, document = Random(seed), Document(kodak, library=library)
    texts = [document.text()]
    for number in range(random.randint(1, 8)):
        document.do(set_network_field("name", f"name {number}"))
        texts.append(document.text())
    for _ in range(12):
        position = random.randrange(len(texts))
        document.go_to(position)
        assert document.history.position == position
        assert document.text() == texts[position]
        assert document.modified == (position != 0)


def test_the_listeners_are_called_once_for_many_steps(document):
    for number in range(5):
        document.do(set_network_field("name", f"name {number}"))
    calls = []
    document.listen(lambda before, after: calls.append((before.name, after.name)))
    document.go_to(2)
    document.go_to(5)
    document.go_to(5)
    assert calls == [("name 4", "name 1"), ("name 1", "name 4")]


def test_the_saved_position_is_known_until_no_step_leads_there(document, tmp_path):
    document.do(set_network_field("name", "a"))
    document.save(tmp_path / "a.json")
    assert document.history.saved == 1
    document.go_to(0)
    assert document.history.saved == 1
    document.do(set_network_field("name", "b"))
    assert document.history.saved is None


@pytest.mark.parametrize("position", [-1, 2])
def test_a_position_that_is_not_there_is_refused_with_the_range(document, position):
    document.do(set_network_field("name", "a"))
    before = document.network
    with pytest.raises(NetworkError, match=f"no position {position}: it goes from 0 to 1"):
        document.go_to(position)
    assert document.network is before


def test_a_gesture_does_not_go_on_after_going_away_and_back(document):
    document.do(set_parameter("init", "f_number", 3.0), gesture="drag")
    document.go_to(0)
    document.go_to(1)
    document.do(set_parameter("init", "f_number", 4.0), gesture="drag")
    assert document.history.last == 2


def test_lines_say_what_a_value_was_and_is(document):
    had = document.network.nodes["init"].params.get("f_number", "default")
    steps = [
        (set_parameter("init", "f_number", 3.5), f"Set init.f_number: {had} → 3.5"),
        (
            set_parameter("init", "f_number", expression("2*2")),
            "Link init.f_number: 3.5 → = 2*2",
        ),
        (set_parameter("init", "f_number", ABSENT), "Reset init.f_number: = 2*2 → default"),
        (Remove(("init",)), "Delete init"),
    ]
    for operation, _ in steps:
        document.do(operation)
    lines = [document.history.line(position) for position in range(len(steps) + 1)]
    assert lines == ["", *(line for _, line in steps)]


def test_a_drag_is_one_line_from_its_first_value_to_its_last(document):
    document.do(set_parameter("init", "f_number", 2.25))
    for value in (2.5, 3.0, 7.25):
        document.do(set_parameter("init", "f_number", value), gesture="drag")
    assert document.history.line(2) == "Set init.f_number: 2.25 → 7.25"


def test_a_line_stays_one_line_and_short(document):
    document.do(set_parameter("init", "f_number", "a\nb" + "x" * 500))
    line = document.history.line(1)
    assert "\n" not in line
    assert len(line) < 100


def test_going_back_is_one_step(library):
    kept = load_network(shipped_networks()["first_steps"], library=library)
    document = Document(kept, library=library)
    document.do(set_parameter("blur", "sigma_x_mrad", 3.0))
    document.do(Remove(("blur",)))
    changed = document.text()
    steps = document.history.position
    assert document.do(Restored(kept, "Go back to Snapshot 1"))
    assert document.network is kept
    assert document.history.position == steps + 1
    assert document.history.undo_text == "Go back to Snapshot 1"
    document.undo()
    assert document.text() == changed
    document.redo()
    assert document.network == kept
    assert not document.do(Restored(kept, "Go back to Snapshot 1"))  # it is there already


def test_a_drag_back_to_what_was_saved_is_saved(document, tmp_path):
    document.do(Move({"init": (1.0, 0)}), gesture="drag")
    document.save(tmp_path / "a.json")
    document.do(Move({"init": (2.0, 0)}), gesture="drag")
    assert document.modified
    document.do(Move({"init": (1.0, 0)}), gesture="drag")
    assert not document.modified


def test_a_drag_back_to_where_it_began_after_an_undo_is_not_what_was_saved(document, tmp_path):
    document.do(Remove(("slices",)))
    document.save(tmp_path / "a.json")
    document.undo()
    document.do(Move({"init": (1.0, 0)}), gesture="drag")
    document.do(Move({"init": (480.0, 0)}), gesture="drag")
    assert document.history.position == 0
    assert document.modified


def test_the_empty_network_that_nobody_touched_is_no_work(library):
    assert not Document(Network(), library=library).modified
    assert Document(Network(), library=library, saved=False).modified
