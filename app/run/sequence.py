"""Writing frames of a picture, each with temporal noise of its own, into one file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from app.run.saving import real_array
from core.chain.frame_sequence import at_frame
from core.chain.wires import Image
from core.errors import FileError
from core.evaluation.region import Region
from core.evaluation.work import Work
from nodes.files.arrays import write_npy_header
from nodes.files.read import check_finite

MOST_FRAMES = 1_000_000


def save_frames(
    image: Image,
    path: Path,
    work: Work,
    *,
    port: str,
    frames: int,
    region: Region | None = None,
    done: Callable[[int], None] | None = None,
) -> None:
    """Write a ``.npy`` of shape (frames, rows, columns), one frame after the other.

    `done` is called after each with the number of frames that are written.

    Raises
    ------
    ImagechainError
        From computing, or if the file cannot be written.
    """
    rows, columns = (region.rows, region.columns) if region else image.shape
    recipes = (at_frame(image.recipe, number) for number in range(frames))
    try:
        # Not mapped into memory: a disk that is full then ends the process (SIGBUS).
        with path.open("wb") as file:
            write_npy_header(file, (frames, rows, columns), work.policy.dtype)
            for number, made in enumerate(work.one_by_one(recipes, region), start=1):
                work.check()
                frame = real_array(made, work)
                check_finite(frame, port)
                file.write(np.ascontiguousarray(frame).data)
                if done is not None:
                    done(number)
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error
