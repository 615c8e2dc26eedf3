"""One door to every kind of picture file, and the check of its samples."""

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.scratch import Empty
from nodes.files.common.picture_info import PictureInfo, Samples
from nodes.files.formats import format_of
from nodes.files.store_folder import readable_picture

_BLOCK_SAMPLES = 1 << 20


def read_info(path: str | os.PathLike[str]) -> PictureInfo:
    """Describe a picture file of any supported kind without reading its samples.

    The kind is known by suffix, by content, and as ENVI by a header that lies beside the file or
    is the file: see `nodes.files.formats`.
    """
    file = readable_picture(path)
    return format_of(file).read_info(file)


def read_pixels(path: str | os.PathLike[str], band: int = 0, *, empty: Empty = np.empty) -> Samples:
    """Read one band of a picture file, counted from 0, into an array that `empty` makes.

    (rows, columns) in C order, as the numbers the file stores; float64 when it holds doubles,
    integers of 32 or more bits or text, else float32. Samples may be not finite, as those are
    that are missing by the header: see `check_finite`.
    """
    file = readable_picture(path)
    return format_of(file).read_band(file, band, empty=empty)


def check_finite(array: NDArray[Any], name: str, *, advice: str = "") -> None:
    """Refuse samples (rows, columns) that are NaN or infinite; name how many, and the first.

    `name` and `advice` are for the message. Works in blocks of rows, so that the memory it takes
    does not grow with the picture.
    """
    step = max(1, _BLOCK_SAMPLES // max(1, array.shape[1]))
    count = 0
    first: tuple[int, int] | None = None
    for start in range(0, array.shape[0], step):
        wrong = ~np.isfinite(array[start : start + step])
        bad_samples = int(np.count_nonzero(wrong))
        if bad_samples and first is None:
            row, column = divmod(int(np.argmax(wrong)), array.shape[1])
            first = (start + row, column)
        count += bad_samples
    if first is not None:
        many = "1 sample is" if count == 1 else f"{count} samples are"
        raise DataError(
            f"{name}: {many} not finite (NaN or infinite), the first "
            f"({array[first]}) at row {first[0]}, column {first[1]}" + (advice and f"; {advice}")
        )
