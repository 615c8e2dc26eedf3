"""Whether work counts as saved, against a list of every state the document has been in."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.editing.fields import set_network_field, set_parameter
from core.editing.nodes import Move, Remove
from core.errors import ImagechainError
from core.network.network import Network
from edited_networks import DRAGS, MAKERS, Editor, drawn_network

LIMITS = settings(
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@pytest.fixture
def document(kodak, library):
    return Document(kodak, library=library)


def name_it(document, name, gesture=None):
    document.do(set_network_field("name", name), gesture)


def test_an_edit_after_an_undo_of_what_was_saved_counts_as_work(document, tmp_path):
    """The saved state stood where the new step stands now, by number."""
    name_it(document, "saved")
    document.save(tmp_path / "a.json")
    document.undo()
    name_it(document, "another")
    assert document.history.position == 1
    assert document.modified


def test_nothing_leads_back_to_what_was_saved_and_then_cut_off(document, tmp_path):
    name_it(document, "one")
    name_it(document, "saved")
    document.save(tmp_path / "a.json")
    document.undo()
    document.undo()
    name_it(document, "two")
    for step in (document.undo, document.redo, document.redo):
        step()
        assert document.modified
    name_it(document, "three")
    assert document.history.position == 2
    assert document.modified


def test_a_drag_joined_to_the_saved_step_counts_as_work(document, tmp_path):
    document.do(set_parameter("init", "f_number", 3.0), gesture="drag")
    document.do(set_parameter("init", "f_number", 4.0), gesture="drag")
    document.save(tmp_path / "a.json")
    document.do(set_parameter("init", "f_number", 5.0), gesture="drag")
    assert document.modified
    document.undo()
    assert document.network.nodes["init"].params["f_number"] == 4.0
    assert not document.modified


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


class Model:
    """The states that undo and redo lead to, as texts; no marks, no positions of its own kind.

    A state is a list of one text, so that two of the same text are still two.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.states = [[document.text()]]
        self.at = 0
        self.saved = self.states[0]

    def check(self) -> None:
        text, document = self.document.text(), self.document
        assert text == self.states[self.at][0]
        assert document.modified == (self.states[self.at] is not self.saved)
        if not document.modified:
            assert text == document.path_text, "what counts as saved is what the file holds"


class Filed(Document):
    """A document that can be compared with its file."""

    @property
    def path_text(self) -> str:
        assert self.path is not None
        return self.path.read_text()


@settings(LIMITS, max_examples=20)
@given(seed=st.integers(0, 2**32))
def test_whatever_is_saved_undone_redone_and_edited(seed, library, tmp_path):
    random = Random(seed)
    document = Filed(drawn_network(random, library, 6), library=library)
    document.save(tmp_path / "a.json", over=True)
    play(document, random, 80)


def play(document: Filed, random: Random, count: int) -> None:
    model, gesture = Model(document), None
    for _ in range(count):
        kind = random.choices(("edit", "undo", "redo", "save", "end"), (9, 4, 3, 2, 1))[0]
        if kind == "edit":
            if random.random() < 0.4:
                gesture = random.choice([None, "one drag", "another"])
            edit(model, random, gesture)
        elif kind == "undo":
            document.undo()
            model.at = max(model.at - 1, 0)
        elif kind == "redo":
            document.redo()
            model.at = min(model.at + 1, len(model.states) - 1)
        elif kind == "save":
            document.save()
            model.saved = model.states[model.at]
        else:
            document.end_gesture()
        model.check()


def edit(model: Model, random: Random, gesture: str | None) -> None:
    document = model.document
    before = document.history.position
    maker = random.choice(DRAGS if gesture is not None else MAKERS)
    operation = maker(Editor(random, document.network, document.library))
    if operation is None:
        return
    try:
        changed = document.do(operation, gesture)
    except ImagechainError:
        return
    if changed:
        took = document.history.position - before
        if took == 1:
            del model.states[before + 1 :]
            model.states.append([document.text()])
        elif took == 0:  # joined to the step before
            del model.states[before:]
            model.states.append([document.text()])
        else:  # back where the gesture began
            del model.states[before:]
        model.at = document.history.position


def test_the_empty_network_that_nobody_touched_is_no_work(library):
    assert not Document(Network(), library=library).modified
    assert Document(Network(), library=library, saved=False).modified
