"""Writing frames of a picture, each with temporal noise of its own, into one file."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from app.run.saving import metadata_of, real_array
from core.chain.frame_sequence import at_frame
from core.chain.wires import Image
from core.errors import UsageError
from core.evaluation.policy import Policy
from core.evaluation.recipes import number_bits
from core.evaluation.region import Region
from core.evaluation.work import Work
from core.scratch.scratch_disk import is_on_disk
from nodes.files.formats import TIFF
from nodes.files.frames.frame_series import FrameSeries
from nodes.files.frames.frame_writing import (
    FrameFormat,
    frame_format,
    frame_suffixes,
    write_frames,
)
from nodes.files.frames.tiled_tiff import write_tiled_tiff
from nodes.files.read import check_finite

MOST_FRAMES = 1_000_000


_COLLECTED = 256  # frames between two collections of what refers to itself: 4 MB of small ones


def format_for_frames(port: str, path: Path) -> FrameFormat:
    """The format of the frames' file.

    Raises
    ------
    UsageError
        Saying which there are.
    """
    kind = frame_format(path)
    if kind is None:
        words = " ".join(frame_suffixes())
        raise UsageError(f"--save {port}={path}: --frames of an image are written as {words}")
    return kind


def series_of(
    image: Image, kind: FrameFormat, policy: Policy, *, frames: int, region: Region | None
) -> FrameSeries:
    """The frames of a picture, or of a region of it, as that format stores them."""
    shape = region.shape if region else image.shape
    stored = kind.stored_type(policy.dtype, number_bits(image.recipe))
    return FrameSeries(frames, *shape, stored, metadata_of(image, shape))


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
    """Write frames one after the other: they take the memory of a few, whatever their number.

    `done` is called after each with the number of frames that are written.

    Raises
    ------
    ImagechainError
        From computing, or if the file cannot be written.
    """
    kind = format_for_frames(port, path)
    series = series_of(image, kind, work.policy, frames=frames, region=region)
    recipes = (at_frame(image.recipe, number) for number in range(frames))

    def made() -> Iterator[NDArray[Any]]:
        for number, value in enumerate(work.one_by_one(recipes, region, forgetting=True)):
            if number % _COLLECTED == _COLLECTED - 1:
                gc.collect()  # the recipes of a frame refer to one another
            work.check()
            frame = real_array(value, work)
            check_finite(frame, port)
            yield frame

    if frames == 1 and TIFF.matches(path):
        (frame,) = made()
        if is_on_disk(frame):
            write_tiled_tiff(path, series, frame)
            return
        write_frames(path, kind, series, [frame], done)
        return
    write_frames(path, kind, series, made(), done)
