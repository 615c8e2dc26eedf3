"""Which pictures of a run lie on disk, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from core.scratch.scratch_disk import ScratchDisk

Shape = tuple[int, int]


class Made(Protocol):
    """A `core.evaluation.recipes.Recipe`."""

    @property
    def key(self) -> str: ...  # noqa: D102
    @property
    def by_rows(self) -> bool: ...  # noqa: D102


@dataclass(frozen=True)
class BlockRun:
    """A run in blocks.

    Parameters
    ----------
    disk : ScratchDisk
        Where pictures lie that memory is not to hold.
    shapes : mapping of key to (rows, columns)
        The pictures among its recipes that lie there.
    """

    disk: ScratchDisk
    shapes: Mapping[str, Shape]

    def slabs_of(self, recipe: Made) -> Shape | None:
        """Size of a picture that is made by blocks of rows; None for every other value."""
        return self.shapes.get(recipe.key) if recipe.by_rows else None
