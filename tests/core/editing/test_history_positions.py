"""Going to any position of the history, and the line of each step."""

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.editing.fields import set_network_field, set_parameter
from core.editing.nodes import Remove
from core.editing.operation import ABSENT
from core.errors import NetworkError
from core.network.linked_values import expression


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


def test_what_is_undone_is_still_there_until_another_edit(document):
    for number in range(3):
        document.do(set_network_field("name", f"name {number}"))
    document.go_to(1)
    assert (document.history.position, document.history.last) == (1, 3)
    document.do(set_network_field("name", "other"))
    assert (document.history.position, document.history.last) == (2, 2)


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
