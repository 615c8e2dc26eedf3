"""Writing frames of a picture, each with temporal noise of its own, into one file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from app.run.saving import real_array
from core.chain.frame_sequence import at_frame
from core.chain.wires import Image
from core.errors import FileError
from core.evaluation.region import Region
from core.evaluation.work import Work
from nodes.files.read import check_finite

MOST_FRAMES = 1_000_000


def save_frames(
    image: Image, path: Path, work: Work, *, port: str, frames: int, region: Region | None = None
) -> None:
    """Write a ``.npy`` of shape (frames, rows, columns), one frame after the other.

    Raises
    ------
    ImagechainError
        From computing, or if the file cannot be written.
    """
    rows, columns = (region.rows, region.columns) if region else image.shape
    try:
        file = np.lib.format.open_memmap(
            path, mode="w+", dtype=work.policy.dtype, shape=(frames, rows, columns)
        )
        recipes = (at_frame(image.recipe, number) for number in range(frames))
        for number, made in enumerate(work.one_by_one(recipes, region)):
            work.check()
            frame = real_array(made, work)
            check_finite(frame, port)
            file[number] = frame
        file.flush()
    except OSError as error:
        raise FileError(f"cannot write {path.name}: {error.strerror or error}") from error
