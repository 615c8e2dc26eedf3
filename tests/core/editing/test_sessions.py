"""Whatever is done to a network, undo gives back the text of its file, and redo does it again."""

from __future__ import annotations

from random import Random

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.editing.links import check_new_wires
from core.errors import ImagechainError
from core.network.file import format_network, parse_network
from core.network.network import Network
from edited_networks import DRAGS, MAKERS, Editor, drawn_network
from macro_edits import MACRO_DRAGS, MACRO_MAKERS
from thorough import examples

LIMITS = settings(
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
SEEDS = st.integers(0, 2**32)
OPERATIONS = 100


class Sitting:
    """A document at which somebody works at random; every state it was in is written down."""

    def __init__(self, random: Random, network: Network, library, *, macros: bool = False) -> None:
        self.random = random
        self.makers, self.drags = (MACRO_MAKERS, MACRO_DRAGS) if macros else (MAKERS, DRAGS)
        self.document = Document(network, library=library)
        self.texts = {0: self.document.text()}
        self.kinds: set[str] = set()

    def work(self, count: int) -> None:
        gesture = None
        for _ in range(count):
            if self.random.random() < 0.2:
                gesture = self.random.choice([None, object()])
            if self.random.random() < 0.1:
                self.document.end_gesture()
            self.one(gesture)

    def one(self, gesture: object) -> None:
        maker = self.random.choice(self.drags if gesture is not None else self.makers)
        document = self.document
        position, network = document.history.position, document.network
        before = self.texts[position]
        operation = maker(Editor(self.random, network, document.library))
        if operation is None:
            return
        try:
            changed = document.do(operation, gesture)
        except ImagechainError:
            assert document.network is network
            assert document.history.position == position
            return
        text = document.text()
        assert changed == (text != before)
        self.kinds.add(maker.__name__)
        here = document.history.position
        assert here - position in ((0, 1) if gesture is None else (-1, 0, 1))
        self.texts = {at: text for at, text in self.texts.items() if at < here}
        self.texts[here] = text

    def walk(self, steps: int) -> None:
        for _ in range(steps):
            self.random.choice([self.document.undo, self.document.redo])()
            self.check()

    def check(self) -> None:
        assert self.document.text() == self.texts[self.document.history.position]

    def all_back_and_forth(self) -> None:
        end = self.document.history.position
        for at in reversed(range(end)):
            self.document.undo()
            assert self.document.history.position == at
            self.check()
        assert not self.document.history.undo_text
        assert not self.document.modified
        for _ in range(end):
            self.document.redo()
            self.check()
        assert not self.document.history.redo_text


def played(seed: int, network: Network, library, operations: int = OPERATIONS, **options) -> None:
    sitting = Sitting(Random(seed), network, library, **options)
    sitting.work(operations)
    sitting.all_back_and_forth()
    sitting.walk(operations)
    # From somewhere in the middle on: what was undone is forgotten.
    sitting.work(operations // 5)
    sitting.all_back_and_forth()


@settings(LIMITS, max_examples=8)
@given(seed=SEEDS)
def test_sessions_on_random_networks(seed, library):
    played(seed, drawn_network(Random(seed), library), library)


@settings(LIMITS, max_examples=examples(12))
@given(seed=SEEDS)
def test_sessions_with_macros(seed, library):
    played(seed, drawn_network(Random(seed), library), library, OPERATIONS // 2, macros=True)


def test_sessions_on_shipped_networks(library, shipped):
    for seed, network in enumerate(shipped.values()):
        played(seed, network, library, OPERATIONS // 4)


@settings(LIMITS, max_examples=10)
@given(seed=SEEDS)
def test_what_is_edited_can_always_be_saved_and_opened(seed, library):
    random = Random(seed)
    sitting = Sitting(random, drawn_network(random, library), library, macros=seed % 2 == 0)
    sitting.work(OPERATIONS)
    text = sitting.document.text()
    network = parse_network(text, library=library)
    assert format_network(network, library=library) == text
    check_new_wires(Network(nodes=network.nodes), network, library)


def test_sessions_take_every_kind_of_operation(library):
    missing = {maker.__name__ for maker in MACRO_MAKERS}
    for seed in range(60):
        network = drawn_network(Random(seed), library)
        sitting = Sitting(Random(seed), network, library, macros=True)
        sitting.work(OPERATIONS)
        missing -= sitting.kinds
        if not missing:
            break
    assert not missing
