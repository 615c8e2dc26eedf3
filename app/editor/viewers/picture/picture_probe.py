"""The probe of an image viewer: moved by the mouse or the arrow keys, shown in the status line."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from app.editor.viewers.picture.picture_canvas import PictureCanvas
from app.editor.viewers.pixels.picture_choices import Choices
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.viewers.pixels.picture_text import sample_text
from app.editor.viewers.pixels.probing import index_at
from app.editor.viewers.status_line import StatusLine


class PictureProbe(QObject):
    """Shows the sample at one place of the picture.

    Parameters
    ----------
    canvas : PictureCanvas
        Signals where the cursor is, and marks the place; Qt's owner.
    status : StatusLine
        Where the sample is shown.

    Signals
    -------
    placed(place)
        The row and column of a picture, at its full size; None where it is on none.
    """

    placed = Signal(object)

    def __init__(self, canvas: PictureCanvas, status: StatusLine) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._status = status
        self._picture: Picture | None = None
        self._choices = Choices()
        self._kept = False
        self._place: tuple[int, int] | None = None
        canvas.pointed.connect(self._point_at)
        canvas.stepped.connect(self._step)

    def show_picture(
        self, picture: Picture | None, choices: Choices, *, kept: bool = False
    ) -> None:
        """Show the sample of another picture; at the same place, if it has such axes.

        With `kept` its other half is what was kept of it, and both samples are named.
        """
        before = self._picture
        if self._place and before and picture and before.facts.kind == picture.facts.kind:
            row, column = self._place
            x, y = before.facts.across.at(column), before.facts.along.at(row)
            self._place = index_at(picture.facts, x, y)
        else:
            self._place = None
        self._picture, self._choices, self._kept = picture, choices, kept
        self._show_sample()

    def _point_at(self, place: Any) -> None:
        """The cursor is there."""
        self._place = None
        if place is not None and self._picture is not None:
            self._place = index_at(self._picture.facts, *place)
        self._canvas.mark(None)
        self._show_sample()

    def _step(self, columns: int, rows: int) -> None:
        """Go on by so many samples, from the middle if there is no place yet."""
        if self._picture is None:
            return
        facts = self._picture.facts
        row, column = self._place or (facts.rows // 2, facts.columns // 2)
        row = min(facts.rows - 1, max(0, row + rows))
        column = min(facts.columns - 1, max(0, column + columns))
        self._place = row, column
        self._canvas.mark((facts.across.at(column), facts.along.at(row)))
        self._show_sample()

    def _show_sample(self) -> None:
        text = sample_text(self._picture, self._place, self._choices, kept=self._kept)
        self._status.show_more(text)
        self.placed.emit(self._full_place if text else None)

    @property
    def _full_place(self) -> tuple[int, int] | None:
        """Of the picture at full size, where a preview counts its samples too."""
        picture = self._picture
        if picture is None or self._place is None or picture.facts.kind != "picture":
            return None
        row, column = self._place
        return round(picture.facts.along.at(row)), round(picture.facts.across.at(column))
