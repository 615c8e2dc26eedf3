"""Whatever is done to a network, undo gives back the text of its file, and redo does it again."""

from random import Random

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.editing.wiring import check_new_wires
from core.network.file import format_network, parse_network
from core.network.network import Network
from edited_networks import drawn_network
from sittings import Sitting
from thorough import examples

LIMITS = settings(deadline=None, suppress_health_check=list(HealthCheck))
SEEDS = st.integers(0, 2**32)
OPERATIONS = 100


def drawn_sitting(seed, library, **options):
    random = Random(seed)
    return Sitting(random, Document(drawn_network(random, library), library=library), **options)


def play(sitting, operations=OPERATIONS):
    sitting.work(operations)
    sitting.back_and_forth()
    assert not sitting.document.redo_text
    for _ in range(operations):
        sitting.step()
    # From somewhere in the middle on: what was undone is forgotten.
    sitting.work(operations // 5)
    sitting.back_and_forth()


@settings(LIMITS, max_examples=examples(16))
@given(seed=SEEDS)
def test_sessions_on_random_networks(seed, library):
    play(drawn_sitting(seed, library))


@settings(LIMITS, max_examples=examples(12))
@given(seed=SEEDS)
def test_sessions_with_macros(seed, library):
    play(drawn_sitting(seed, library, macros=True), OPERATIONS // 2)


@settings(LIMITS, max_examples=10)
@given(seed=SEEDS)
def test_what_is_edited_can_always_be_saved_and_opened(seed, library):
    sitting = drawn_sitting(seed, library, macros=seed % 2 == 0)
    sitting.work(OPERATIONS)
    text = sitting.document.text()
    network = parse_network(text, library=library)
    assert format_network(network, library=library) == text
    check_new_wires(Network(nodes=network.nodes), network, library)


@settings(LIMITS, max_examples=examples(40))
@given(seed=SEEDS)
def test_what_is_saved_is_known_whatever_is_undone_redone_and_edited(seed, library, tmp_path):
    sitting = drawn_sitting(seed, library)
    sitting.document.save(tmp_path / "a.json", over=True)
    for _ in range(80):
        kind = sitting.random.choices(("edit", "step", "save", "end"), (9, 7, 2, 1))[0]
        if kind == "edit":
            if sitting.random.random() < 0.4:
                sitting.gesture = sitting.random.choice([None, "one drag", "another"])
            sitting.edit()
        elif kind == "step":
            sitting.step()
        elif kind == "save":
            sitting.save()
        else:
            sitting.document.end_gesture()
