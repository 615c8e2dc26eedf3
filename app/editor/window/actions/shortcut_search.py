"""Which shortcuts a search finds: by words of the action, by the text of keys, by keys pressed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

OR = "  or  "


@dataclass(frozen=True)
class ShortcutRow:
    """One line of the list.

    Parameters
    ----------
    menu, action, keys, meaning : str
        As they are shown.
    sequences : tuple of str
        Each of its key combinations, as ``Ctrl+S``; none of what the mouse does.
    """

    menu: str
    action: str
    keys: str
    meaning: str
    sequences: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """All that is shown of it."""
        return " ".join((self.menu, self.action, self.keys, self.meaning)).casefold()


def rows_for(rows: Sequence[ShortcutRow], text: str) -> list[ShortcutRow]:
    """The rows that have every word of a text, first those whose keys or action it is.

    Parameters
    ----------
    rows : sequence of ShortcutRow
        All of them.
    text : str
        What was typed; nothing finds all.
    """
    whole, words = text.casefold().strip(), text.casefold().split()

    def rank(row: ShortcutRow) -> int:
        if "".join(words) in [one.casefold() for one in row.sequences]:
            return 0
        return 1 if row.action.casefold().startswith(whole) else 2

    having = [row for row in rows if all(word in row.text for word in words) or not rank(row)]
    return sorted(having, key=rank) if words else having


def rows_of_keys(rows: Sequence[ShortcutRow], pressed: Sequence[str]) -> list[ShortcutRow]:
    """The rows that have one of these key combinations."""
    wanted = {one.casefold() for one in pressed}
    return [row for row in rows if wanted & {one.casefold() for one in row.sequences}]
