"""Undo, redo, going to any position, the lines of the steps, and the modified mark."""

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.editing.operations import ABSENT, remove_nodes, restored, set_network_field, set_parameter
from core.network.file import load_network
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


def test_lines_say_what_a_value_was_and_is(document):
    had = document.network.nodes["init"].params.get("f_number", "default")
    steps = [
        (set_parameter("init", "f_number", 3.5), f"Set init.f_number: {had} → 3.5"),
        (set_parameter("init", "f_number", expression("2*2")), "Link init.f_number: 3.5 → = 2*2"),
        (set_parameter("init", "f_number", ABSENT), "Reset init.f_number: = 2*2 → default"),
        (remove_nodes(("init",)), "Delete init"),
    ]
    for operation, _ in steps:
        document.do(operation)
    lines = [document.history.line(position) for position in range(len(steps) + 1)]
    assert lines == ["", *(line for _, line in steps)]


def test_going_back_is_one_step(library):
    kept = load_network(shipped_networks()["first_steps"], library=library)
    document = Document(kept, library=library)
    document.do(set_parameter("blur", "sigma_x_mrad", 3.0))
    document.do(remove_nodes(("blur",)))
    changed = document.text()
    steps = document.history.position
    assert document.do(restored(kept, "Go back to Snapshot 1"))
    assert document.network is kept
    assert document.history.position == steps + 1
    assert document.history.undo_text == "Go back to Snapshot 1"
    document.undo()
    assert document.text() == changed
    document.redo()
    assert document.network == kept
    assert not document.do(restored(kept, "Go back to Snapshot 1"))  # it is there already
