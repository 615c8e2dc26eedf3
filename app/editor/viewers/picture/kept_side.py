"""How an image viewer shows a kept picture, A, beside the present one, B."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from app.editor.viewers.picture.picture_canvas import Sides
from app.editor.viewers.pixels.picture_choices import AUTOMATIC_LEVELS, Choices
from app.editor.viewers.pixels.picture_layers import KeptPicture
from app.editor.viewers.pixels.picture_query import Picture, PictureQuery

Way = Literal["flip", "wipe"]
NOW = "B  now"


@dataclass(frozen=True)
class KeptSide:
    """What a viewer's picture is compared with, and how."""

    # the kept picture; None where there is none of this wire, `missing` says why
    kept: KeptPicture | None
    name: str  # what the kept state is called
    way: Way  # A in the place of B, or A left of the wipe and B right of it
    missing: str = ""  # why there is nothing to compare with, in one line

    @property
    def title(self) -> str:
        """The name as it is written on the picture."""
        return f"A  {self.name}"


def query_beside(choices: Choices, side: KeptSide | None) -> PictureQuery | None:
    """The query of the wire that is chosen, with the kept picture in the place of another wire."""
    query = choices.query
    if query is None or side is None or side.kept is None or side.kept.port != choices.port:
        return query
    # Levels that were set for a difference are not those of the picture.
    of_difference = choices.compares and not isinstance(query.levels, str)
    levels = AUTOMATIC_LEVELS if of_difference else query.levels
    return replace(query, other=None, mode="alone", levels=levels, kept=side.kept)


@dataclass(frozen=True, eq=False)
class Prepared:
    """Both pictures as they were answered last: shown again at once while nothing has changed."""

    kept: KeptPicture
    picture: Picture

    def beside(self, picture: Picture, kept: KeptPicture) -> Picture:
        """The present picture with the kept one, if that was mapped to the same levels."""
        mine = self.picture
        alike = (
            kept is self.kept
            and mine.samples is picture.samples
            and (mine.levels, mine.mapping, mine.facts)
            == (picture.levels, picture.mapping, picture.facts)
        )
        return replace(picture, other=mine.other) if alike else picture


def sides_of(choices: Choices, side: KeptSide | None) -> tuple[Sides, str, str]:
    """Which picture lies where, and the names of the left and the right one."""
    if side is None:
        return "first left", choices.port or "", choices.other or ""
    if side.way == "flip":
        return "second alone", side.title, ""
    return "second left", side.title, NOW


def as_drawn(picture: Picture, side: KeptSide | None) -> Picture:
    """The picture that is on the left, or alone, with the other one on its right."""
    if side is None or picture.other is None:
        return picture
    alone = replace(picture, other=None)
    return picture.other if side.way == "flip" else replace(picture.other, other=alone)
