"""What one evaluation requested, and what of it had to be computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from core.evaluation.recipes import Recipe
    from core.evaluation.region import Region


class EvaluationLog:
    """Notes of one evaluation; nothing that is computed depends on them.

    Each note is one operation on a built-in dict or set, which threads may share.

    Attributes
    ----------
    requested : dict of key to Recipe
        Recipes whose value was requested.
    parts : dict of (key, Region) to Recipe
        Pictures of which a region was requested.
    computed : set of str or (key, Region)
        Those of both whose computation was begun.
    looked_at : set of str
        Keys of spectra and transfer functions of which an array was made.
    """

    def __init__(self) -> None:
        self.requested: dict[str, Recipe] = {}
        self.parts: dict[tuple[str, Region], Recipe] = {}
        self.computed: set[str | tuple[str, Region]] = set()
        self.looked_at: set[str] = set()

    def add(self, other: EvaluationLog) -> None:
        """Take over the notes of another evaluation."""
        self.requested.update(other.requested)
        self.parts.update(other.parts)
        self.computed |= other.computed
        self.looked_at |= other.looked_at

    def reused(self) -> list[Recipe]:
        """Recipes whose value, or the requested part of it, was there already."""
        whole = [recipe for key, recipe in list(self.requested.items()) if key not in self.computed]
        return whole + [
            recipe
            for (key, region), recipe in list(self.parts.items())
            if key not in self.requested and (key, region) not in self.computed
        ]
