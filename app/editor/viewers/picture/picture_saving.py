"""Writing what an image viewer shows: the picture as it looks, or its samples."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft
from PySide6.QtCore import QBuffer, QIODevice
from PySide6.QtGui import QImage

from app.editor.viewers.pixels.colour_maps import Table
from app.editor.viewers.pixels.grey_levels import Levels
from app.editor.viewers.pixels.picture_query import Picture
from app.run.saving import metadata_of, save_array
from core.atomic import write_bytes
from core.chain.wires import Image
from core.errors import UsageError
from nodes.files.common.file_format import suffixes
from nodes.files.formats import PNG, SAVED


def save_picture(picture: Picture, path: Path, table: Table, split: float = 0.5) -> None:
    """Write a picture by the suffix of the file.

    ``.png`` is what is shown, in its colours and levels; all else the samples, planes in the
    order of the FFT as the command line writes them. Of a wipe, `split` is the first one's share
    of the width; samples are those of the first.

    Raises
    ------
    UsageError
        For another suffix, and for a preview.
    ImagechainError
        From the writer.
    """
    if not any(file_format.matches(path) for file_format in SAVED):
        raise UsageError(f"{path}: a picture is written as {' '.join(suffixes(*SAVED))}")
    if picture.reduced > 1:
        raise UsageError("the picture is a preview still: wait until it is shown at full size")
    if PNG.matches(path):
        write_bytes(path, shown_png(picture, table, split))
        return
    if picture.channels:
        raise UsageError(f"{path}: colours of three bands are written as .png, or show one band")
    samples: Any = picture.samples
    if picture.facts.kind == "plane":
        samples = scipy.fft.ifftshift(samples)
    spatial = isinstance(picture.value, Image) and picture.facts.kind == "picture"
    metadata = metadata_of(picture.value, samples.shape) if spatial else {}
    save_array(path, np.asarray(samples), metadata)


def shown_png(picture: Picture, table: Table, split: float = 0.5) -> bytes:
    """Encode what is shown, in its colours and levels, both sides of a wipe."""
    levels = wiped(picture, split, table)
    return _colour_png(levels) if levels.ndim == 3 else _png(levels, table)


def wiped(picture: Picture, split: float, table: Table | None = None) -> Levels:
    """The levels on both sides of a wipe; the second picture's nearest ones if it is not as large.

    Without a second one, those of the picture. Where one side has colours of its own, both are
    colours, of the table where they have none.
    """
    levels, other = picture.grey, picture.other
    if other is None:
        return levels
    others = other.grey
    if levels.ndim != others.ndim and table is not None:
        levels, others = (table[one] if one.ndim == 2 else one for one in (levels, others))
    rows, columns = levels.shape[:2]
    start = round(split * columns)
    down = (np.arange(rows) + 0.5) / rows * other.facts.rows
    right = (np.arange(start, columns) + 0.5) / columns * other.facts.columns
    both = levels.copy()
    both[:, start:] = others[np.ix_(down.astype(np.intp), right.astype(np.intp))]
    return both


def _png(shown: Levels, table: Table) -> bytes:
    levels = np.ascontiguousarray(shown)
    rows, columns = levels.shape
    image = QImage(levels.data, columns, rows, columns, QImage.Format.Format_Indexed8)
    image.setColorTable([0xFF000000 | int(r) << 16 | int(g) << 8 | int(b) for r, g, b in table])
    return _encoded(image)


def _colour_png(shown: Levels) -> bytes:
    levels = np.ascontiguousarray(shown)
    rows, columns, _ = levels.shape
    return _encoded(QImage(levels.data, columns, rows, 3 * columns, QImage.Format.Format_RGB888))


def _encoded(image: QImage) -> bytes:
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    image.save(buffer, "PNG")  # type: ignore[call-overload]
    return bytes(buffer.data().data())
