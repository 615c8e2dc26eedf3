"""Whatever is done to a network, undo gives back the text of its file, and redo does it again."""

from collections import Counter
from random import Random

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.editing.macros import at_level, expose, group, hide, rename_exposed, ungroup
from core.editing.operations import ABSENT, Operation, set_parameter
from core.editing.wiring import check_new_wires
from core.errors import ImagechainError
from core.modules.declaration import declaration
from core.network.file import format_network, parse_network
from core.network.linked_values import expression, resolved
from core.network.macro import SEPARATOR, face_of_macro, macros_in, unfolded
from core.network.network import Network
from edited_networks import DRAGS, MAKERS, Editor, Maker, drawn_network
from thorough import examples


def _level(e: Editor) -> tuple[tuple[str, ...], Network]:
    """The network, or the inside of any macro."""
    levels: list[tuple[tuple[str, ...], Network]] = [((), e.network)]
    levels += [(tuple(name.split(SEPARATOR)), node.macro) for name, node in macros_in(e.network)]
    return e.random.choice([level for level in levels if SEPARATOR not in "".join(level[0])])


def _group(e: Editor) -> Operation | None:
    path, level = _level(e)
    if not level.nodes:
        return None
    names = e.random.sample(list(level.nodes), e.random.randint(1, min(4, len(level.nodes))))
    where = "".join(f"{macro}{SEPARATOR}" for macro in path)
    try:
        return at_level(path, group(level, e.library, names, "camera", where)[1])
    except ImagechainError:  # a way leads out and back in
        return None


def _ungroup(e: Editor) -> Operation | None:
    path, level = _level(e)
    macros = [name for name, node in level.nodes.items() if node.macro and not node.disabled]
    where = "".join(f"{macro}{SEPARATOR}" for macro in path)
    return (
        at_level(path, ungroup(level, e.library, e.random.choice(macros), where)[1])
        if macros
        else None
    )


def _inner(e: Editor) -> str | None:
    names = [name for name in unfolded(e.network).nodes if name not in e.network.nodes]
    return e.random.choice(names) if names else None


def _expose(e: Editor) -> Operation | None:
    name = _inner(e)
    module = e.library.get(unfolded(e.network).nodes[name].module) if name else None
    if name is None or module is None:
        return None
    names = [parameter.name for parameter in declaration(module).parameters]
    try:
        return expose(e.network, name, e.random.choice(names)) if names else None
    except ImagechainError:  # shown already
        return None


def _shown(e: Editor) -> tuple[str, str] | None:
    shown = [
        (macro, name)
        for macro, node in macros_in(e.network)
        for name in face_of_macro(node.macro).parameters
    ]
    return e.random.choice(shown) if shown else None


def _hide(e: Editor) -> Operation | None:
    shown = _shown(e)
    try:
        value_of = resolved(e.network, library=e.library).value
        return hide(e.network, *shown, value_of) if shown else None
    except ImagechainError:  # another follows it
        return None


def _rename_exposed(e: Editor) -> Operation | None:
    shown = _shown(e)
    new = f"called{e.random.choice('_ ')}{e.random.randint(0, 20)}"
    return rename_exposed(e.network, *shown, new) if shown else None


def _set(e: Editor) -> Operation | None:
    """A value inside, or by the macro's own name of it."""
    shown, name = _shown(e), _inner(e)
    value = e.random.choice([0.5, 1, 2.0, ABSENT])
    if shown and e.random.random() < 0.6:
        return set_parameter(*shown, value)
    parameter = e.random.choice(["sigma_mrad", "strange"])
    return set_parameter(name, parameter, value) if name else None


def _follow(e: Editor) -> Operation | None:
    """An expression that names a macro's parameter, a node inside, or one that is not there."""
    shown, name = _shown(e), _inner(e)
    leaders = [f"'{one}'.f_number * 2" for one in (name, "camera", "strange") if one]
    if shown:
        leaders += [f"'{shown[0]}'.{shown[1]}"] * 2
        return set_parameter(*shown, expression(e.random.choice(leaders)))
    return None


def _work_inside(e: Editor) -> Operation | None:
    path, level = _level(e)
    if not path:
        return None
    inner = Editor(e.random, level, e.library)
    step = e.random.choice(MAKERS)(inner)
    return at_level(path, step) if step is not None else None


MACRO_MAKERS: tuple[Maker, ...] = (
    *MAKERS, _group, _group, _group, _ungroup, _expose, _expose, _hide, _rename_exposed, _set,
    _set, _follow, _work_inside, _work_inside, _work_inside,
)  # fmt: skip
MACRO_DRAGS: tuple[Maker, ...] = (*DRAGS, _set, _work_inside)


class Sitting:
    """Edits, undoes, redoes and saves. `counts` has how often each kind of edit was done.

    Every state the document was in is written down as a list of one text, so that two of the same
    text are still two.
    """

    def __init__(self, random: Random, document: Document, *, macros: bool = False) -> None:
        self.random, self.document = random, document
        self.makers, self.drags = (MACRO_MAKERS, MACRO_DRAGS) if macros else (MAKERS, DRAGS)
        self.states = [[document.text()]]
        self.saved = self.states[0]
        self.gesture: object = None
        self.counts: Counter[str] = Counter()

    def work(self, count: int) -> None:
        """Edit, beginning and ending drags."""
        for _ in range(count):
            if self.random.random() < 0.2:
                self.gesture = self.random.choice([None, object()])
            if self.random.random() < 0.1:
                self.document.end_gesture()
            self.edit()

    def edit(self) -> None:
        document = self.document
        maker = self.random.choice(self.drags if self.gesture is not None else self.makers)
        operation = maker(Editor(self.random, document.network, document.library))
        if operation is None:
            return
        network, before = document.network, document.position
        try:
            changed = document.do(operation, self.gesture)
        except ImagechainError:
            assert document.network is network, f"refused, but changed: {operation.text}"
            assert document.position == before
            self.counts["refused"] += 1
            return
        took = document.position - before
        differs = document.text() != self.states[before][0]
        # A macro has a seed, and its file none: there the text may stay.
        assert changed == differs or (changed and self.makers is MACRO_MAKERS), operation.text
        assert took in ((0, 1) if self.gesture is None else (-1, 0, 1)), operation.text
        if changed:
            # A step more, or joined to the one before, or back where the gesture began.
            del self.states[before + (took == 1) :]
            if took >= 0:
                self.states.append([document.text()])
        self.counts[maker.__name__] += 1
        self.check()

    def step(self) -> None:
        """Undo, redo, or go to any place in the history."""
        document = self.document
        place = self.random.randint(0, document.last)
        self.random.choice([document.undo, document.redo, lambda: document.go_to(place)])()
        self.check()

    def save(self, path=None) -> None:
        self.document.save(path)
        self.saved = self.states[self.document.position]
        assert self.document.path.read_text() == self.saved[0], "the file is not the document"
        self.check()

    def check(self) -> None:
        """The text is that of this place in the history; without it being modified, the file's."""
        state = self.states[self.document.position]
        assert self.document.text() == state[0]
        assert self.document.modified == (state is not self.saved)

    def back_and_forth(self) -> None:
        """Undo to the start, and do it all again."""
        end = self.document.position
        for at in reversed(range(end)):
            undone = self.document.undo_text
            self.document.undo()
            assert self.document.position == at
            assert self.document.redo_text == undone
            self.check()
        assert not self.document.undo_text
        for _ in range(end):
            self.document.redo()
            self.check()


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
