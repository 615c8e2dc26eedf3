"""Sittings at a document: random operations, undo, redo, save, reload; nothing differs after."""

from __future__ import annotations

from pathlib import Path

from cases import Case
from commands import ended

from app.editor.recovery_files import Autosave
from app.editor.window.documents.opening import open_network_file
from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.errors import ImagechainError
from core.network.file import format_network, parse_network, read_network
from edited_networks import DRAGS, MAKERS, Editor, drawn_network
from nodes.library import standard_library

NAME = "edited.json"


def try_sitting(case: Case) -> None:
    """Work on a drawn or a shipped network; every state it was in is remembered."""
    random, library = case.random, standard_library()
    if random.random() < 0.6:
        network = drawn_network(random, library)
    else:
        path = random.choice(list(shipped_networks().values()))
        network = read_network(path, library=library)
    _Sitting(case, Document(network, library=library)).work(random.randint(5, 60))


class _Sitting:
    """A document, what its history must lead to, and what its file must hold."""

    def __init__(self, case: Case, document: Document) -> None:
        self.case = case
        self.random = case.random
        self.document = document
        self.texts = {0: document.text()}
        self.saved: str | None = document.text()
        self.gesture: object = None
        self.autosave = Autosave(document, case.folder / "recovery")

    def work(self, steps: int) -> None:
        for _ in range(steps):
            chosen = self.random.random()
            if chosen < 0.66:
                self._edit()
            elif chosen < 0.82:
                self.random.choice((self.document.undo, self.document.redo))()
                self._expect_at_position()
            elif chosen < 0.88:
                self._save()
            elif chosen < 0.92:
                self._reload()
            elif chosen < 0.96:
                self._autosave()
            else:
                self.gesture = self.random.choice((None, object()))
                self.document.end_gesture()
            self._expect_modified()
        self._back_and_forth()
        self._save()
        ended(self.case, ["check", NAME])
        self.autosave.finish()
        left = list((self.case.folder / "recovery").glob("*"))
        self.case.expect(not left, f"finished, but recovery files are left: {left}")

    def _edit(self) -> None:
        document = self.document
        maker = self.random.choice(DRAGS if self.gesture is not None else MAKERS)
        operation = maker(Editor(self.random, document.network, document.library))
        if operation is None:
            return
        # What the text was when the document came to this state: it must not have moved since.
        position = document.history.position
        before = self.texts[position]
        try:
            changed = document.do(operation, self.gesture)
        except ImagechainError as error:
            same = (document.text(), document.history.position) == (before, position)
            self.case.expect(same, f"refused ({error}), but changed: {operation.text}")
            self.case.counts["edits refused"] += 1
            return
        text = document.text()
        self.case.expect(changed == (text != before), f"changed is {changed}: {operation.text}")
        here = document.history.position
        if changed:
            self.texts = {at: known for at, known in self.texts.items() if at < here}
        self.texts[here] = text
        parsed = parse_network(text, library=document.library)
        self.case.expect(parsed == document.network, f"read back it differs: {operation.text}")
        again = format_network(parsed, library=document.library)
        self.case.expect(again == text, f"written again it differs: {operation.text}")
        self.case.counts["edits"] += 1

    def _expect_at_position(self) -> None:
        at = self.document.history.position
        self.case.expect(self.document.text() == self.texts[at], f"not the state of step {at}")

    def _expect_modified(self) -> None:
        """A document that says it is not modified is as its file."""
        if not self.document.modified:
            same = self.document.text() == self.saved
            self.case.expect(same, "not modified, but other than its file")

    def _save(self) -> None:
        self.document.save(Path(NAME))
        self.saved = Path(NAME).read_text()
        self.case.expect(self.saved == self.document.text(), "the file is not the document")
        self.case.expect(not self.document.modified, "saved, but modified")
        self.case.counts["saves"] += 1

    def _reload(self) -> None:
        """Open the file in place of the document, as another window would."""
        if self.document.path is None:
            return
        try:
            self.document = open_network_file(Path(NAME), library=self.document.library).document
        except ImagechainError as error:
            self.case.expect(False, f"saved, but cannot be opened: {error}")
        self.case.expect(self.document.text() == self.saved, "opened, it differs from its file")
        self.autosave.finish()
        self.autosave = Autosave(self.document, self.case.folder / "recovery")
        self.texts = {0: self.document.text()}

    def _autosave(self) -> None:
        self.autosave.write_if_changed()
        there = self.autosave.path.exists()
        self.case.expect(there == self.document.modified, "recovery file and modified disagree")
        self.case.counts["autosaves"] += 1

    def _back_and_forth(self) -> None:
        end = self.document.history.position
        while self.document.history.undo_text:
            self.document.undo()
            self._expect_at_position()
        for _ in range(end):
            self.document.redo()
            self._expect_at_position()
