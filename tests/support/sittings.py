"""A document at which somebody works at random, and what its history must lead to."""

from collections import Counter
from random import Random

from core.editing.document import Document
from core.errors import ImagechainError
from edited_networks import DRAGS, MAKERS, Editor
from macro_edits import MACRO_DRAGS, MACRO_MAKERS


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
