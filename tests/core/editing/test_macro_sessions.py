"""Whatever is done to macros, undo gives back the text of the file, and redo does it again."""

from __future__ import annotations

from random import Random

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.errors import ImagechainError
from core.network.file import parse_network
from edited_networks import Editor, drawn_network
from macro_edits import MACRO_DRAGS, MACRO_MAKERS
from thorough import examples

LIMITS = settings(
    deadline=None,
    max_examples=examples(25),
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
OPERATIONS = 60


def work(random, document):
    """Texts of the document by its place in the history, after random operations."""
    texts, kinds, gesture = {0: document.text()}, set(), None
    for _ in range(OPERATIONS):
        if random.random() < 0.2:
            gesture = random.choice([None, object()])
            document.end_gesture()
        maker = random.choice(MACRO_MAKERS if gesture is None else MACRO_DRAGS)
        before = document.network
        operation = maker(Editor(random, document.network, document.library))
        if operation is None:
            continue
        try:
            document.do(operation, gesture)
        except ImagechainError:
            assert document.network is before
            continue
        kinds.add(maker.__name__)
        place = document.history.position
        texts = {at: text for at, text in texts.items() if at < place}
        texts[place] = document.text()
    return texts, kinds


@LIMITS
@given(seed=st.integers(0, 2**32))
def test_undo_and_redo_give_the_same_files(seed, library):
    random = Random(seed)
    document = Document(drawn_network(random, library), library=library)
    texts, _ = work(random, document)
    for text in texts.values():
        assert parse_network(text, library=library)
    end = document.history.position
    for place in reversed(range(end)):
        document.undo()
        assert document.text() == texts[place]
    for place in range(1, end + 1):
        document.redo()
        assert document.text() == texts[place]


def test_each_kind_of_operation_takes_place(library):
    names = {"_group", "_ungroup", "_expose", "_hide", "_rename_exposed", "_set", "_follow"}
    missing = names | {"_work_inside"}
    for seed in range(60):
        random = Random(seed)
        document = Document(drawn_network(random, library), library=library)
        missing -= work(random, document)[1]
        if not missing:
            break
    assert not missing
