"""Sittings at a document: random operations, undo, redo, save, reload; nothing differs after."""

from __future__ import annotations

from pathlib import Path

from cases import Case
from commands import ended

from app.editor.recovery_files import Autosave
from app.editor.window.files import open_network_file
from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.network.file import format_network, read_network
from core.network.parsing import parse_network
from edited_networks import drawn_network
from nodes.library import standard_library
from sittings import Sitting

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


class _Sitting(Sitting):
    """A sitting with a file and a recovery file."""

    def __init__(self, case: Case, document: Document) -> None:
        super().__init__(case.random, document, macros=case.random.random() < 0.5)
        self.case = case
        self.autosave = Autosave(document, case.folder / "recovery")

    def work(self, count: int) -> None:
        for _ in range(count):
            chosen = self.random.random()
            if chosen < 0.66:
                self.edit()
                self._read_back()
            elif chosen < 0.82:
                self.step()
            elif chosen < 0.88:
                self.save(Path(NAME))
            elif chosen < 0.92:
                self._reload()
            elif chosen < 0.96:
                self.autosave.write_if_changed()
                there = self.autosave.path.exists()
                same = there == self.document.modified
                self.case.expect(same, "recovery file and modified disagree")
            else:
                self.gesture = self.random.choice((None, object()))
                self.document.end_gesture()
        self.back_and_forth()
        self.save(Path(NAME))
        ended(self.case, ["check", NAME])
        self.autosave.finish()
        left = list((self.case.folder / "recovery").glob("*"))
        self.case.expect(not left, f"finished, but recovery files are left: {left}")
        self.case.counts.update(self.counts)

    def _read_back(self) -> None:
        text, library = self.document.text(), self.document.library
        parsed = parse_network(text, library=library)
        self.case.expect(parsed == self.document.network, "read back it differs")
        self.case.expect(
            format_network(parsed, library=library) == text, "written again it differs"
        )

    def _reload(self) -> None:
        """Open the file in place of the document, as another window would."""
        if self.document.path is None:
            return
        self.document = open_network_file(Path(NAME), library=self.document.library).document
        self.case.expect(self.document.text() == self.saved[0], "opened, it differs from its file")
        self.autosave.finish()
        self.autosave = Autosave(self.document, self.case.folder / "recovery")
        self.states = [self.saved]
