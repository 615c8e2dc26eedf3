"""How many frames or bands a file holds, of which size and type, and what is known of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from nodes.files.common.picture_info import MetadataValue


@dataclass(frozen=True)
class FrameSeries:
    """Frames of one size and type.

    Attributes
    ----------
    frames, rows, columns
        How many, and the size of each.
    dtype
        Of the samples.
    metadata
        Texts and numbers of all frames, as `nodes.files.write.write_picture` takes them; a tuple is
        a list with a number for each frame.
    what
        What they are: bands of wavelength are written as frames are.
    """

    frames: int
    rows: int
    columns: int
    dtype: np.dtype[Any]
    metadata: Mapping[str, MetadataValue | tuple[float, ...]] = field(default_factory=dict)
    what: str = "frames"

    @property
    def shape(self) -> tuple[int, int]:
        return self.rows, self.columns

    @property
    def frame_bytes(self) -> int:
        return self.rows * self.columns * self.dtype.itemsize

    @property
    def size_text(self) -> str:
        size = f"{self.rows} × {self.columns} samples"
        return size if self.frames == 1 else f"{self.frames} {self.what} of {size}"
