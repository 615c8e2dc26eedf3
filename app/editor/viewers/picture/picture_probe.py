"""The probe of an image viewer: moved by the mouse or the arrow keys, shown in the status line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft
from PySide6.QtCore import QBuffer, QIODevice, QObject, Signal
from PySide6.QtGui import QImage

from app.editor.viewers.picture.picture_canvas import PictureCanvas
from app.editor.viewers.pixels.grey_levels import Levels, Table
from app.editor.viewers.pixels.picture_facts import Choices
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.viewers.pixels.probing import index_at, sample_text
from app.editor.viewers.viewer import StatusLine
from app.run.saving import metadata_of, save_array
from core.atomic import write_bytes
from core.chain.wires import Image
from core.errors import UsageError
from nodes.files.common.file_format import suffixes
from nodes.files.formats import PNG, SAVED


class PictureProbe(QObject):
    # place: the row and column of a picture, at its full size; None where it is on none
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
        """Show another picture's sample at the same place; `kept`: beside the kept one's."""
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


# Writing what an image viewer shows: the picture as it looks, or its samples.


def save_picture(picture: Picture, path: Path, table: Table, split: float = 0.5) -> None:
    """Write a picture by the suffix of the file.

    ``.png`` is what is shown, in its colours and levels; all else the samples, planes in the
    order of the FFT as the command line writes them. Of a wipe, `split` is the first one's share
    of the width; samples are those of the first. Another suffix, or a preview, is refused.
    """
    if not any(file_format.matches(path) for file_format in SAVED):
        raise UsageError(f"{path}: a picture is written as {' '.join(suffixes(*SAVED))}")
    if picture.reduced > 1:
        raise UsageError("the picture is still a preview: wait until it is shown at full size")
    if PNG.matches(path):
        write_bytes(path, shown_png(picture, table, split))
        return
    if picture.channels:
        raise UsageError(
            f"{path}: three bands shown as colours can only be saved as .png; or show one band"
        )
    samples: Any = picture.samples
    if picture.facts.kind == "plane":
        samples = scipy.fft.ifftshift(samples)
    spatial = isinstance(picture.value, Image) and picture.facts.kind == "picture"
    metadata = metadata_of(picture.value, samples.shape) if spatial else {}
    save_array(path, np.asarray(samples), metadata)


def shown_png(picture: Picture, table: Table, split: float = 0.5) -> bytes:
    """Encode what is shown, in its colours and levels, both sides of a wipe."""
    levels = np.ascontiguousarray(_wiped(picture, split, table))
    rows, columns = levels.shape[:2]
    formats = QImage.Format
    kind = formats.Format_RGB888 if levels.ndim == 3 else formats.Format_Indexed8
    image = QImage(levels.data, columns, rows, levels.strides[0], kind)
    if kind is formats.Format_Indexed8:
        image.setColorTable([0xFF000000 | int(r) << 16 | int(g) << 8 | int(b) for r, g, b in table])
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    image.save(buffer, "PNG")  # type: ignore[call-overload]
    return bytes(buffer.data().data())


def _wiped(picture: Picture, split: float, table: Table) -> Levels:
    """The levels on both sides of a wipe; the second picture's nearest ones if it is not as large.

    Without a second one, those of the picture. Where one side has colours of its own, both are
    colours, of the table where they have none.
    """
    levels, other = picture.grey, picture.other
    if other is None:
        return levels
    others = other.grey
    if levels.ndim != others.ndim:
        levels, others = (table[one] if one.ndim == 2 else one for one in (levels, others))
    rows, columns = levels.shape[:2]
    start = round(split * columns)
    down = (np.arange(rows) + 0.5) / rows * other.facts.rows
    right = (np.arange(start, columns) + 0.5) / columns * other.facts.columns
    both = levels.copy()
    both[:, start:] = others[np.ix_(down.astype(np.intp), right.astype(np.intp))]
    return both
