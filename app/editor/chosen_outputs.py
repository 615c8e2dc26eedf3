"""Files to be written that the person has chosen in a dialog: a later run may write them."""

from __future__ import annotations

from pathlib import Path

from app.run.write_rules import read_record, remember_chosen


class ChosenOutputs:
    """Choices made for one document, kept in the user's record of its file."""

    def __init__(self) -> None:
        self._files: set[Path] = set()

    @property
    def files(self) -> tuple[Path, ...]:
        """What was chosen while this document was open."""
        return tuple(sorted(self._files))

    def forget(self) -> None:
        """Another document has been opened."""
        self._files.clear()

    def add(self, file: Path, network: Path | None) -> None:
        """A file was chosen; `network` is the document's file, None where it has none yet.

        Raises
        ------
        FileError
            If that cannot be remembered.
        """
        self._files.add(file)
        if network is not None:
            remember_chosen(network, [file])

    def saved(self, before: Path | None, now: Path) -> None:
        """The document is saved, perhaps in another file than before.

        Raises
        ------
        FileError
            If the choices cannot be remembered for it.
        """
        known = read_record(before).chosen if before is not None else frozenset()
        if known or self._files:
            remember_chosen(now, [*known, *self._files])
