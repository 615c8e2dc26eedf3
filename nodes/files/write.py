"""One door to writing every kind of picture file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from numpy.typing import ArrayLike

from core.errors import FileError, ParameterError
from nodes.files.common.file_format import suffixes
from nodes.files.common.picture_info import MetadataValue
from nodes.files.common.stored_samples import as_picture, as_stored
from nodes.files.formats import WRITTEN, written_format


def write_picture(
    path: str | os.PathLike[str],
    array: ArrayLike,
    *,
    dtype: str = "float",
    low: float | None = None,
    high: float | None = None,
    metadata: Mapping[str, MetadataValue] | None = None,
) -> None:
    """Write a picture (rows, columns[, channels]) atomically; the same samples give the same bytes.

    Float and double samples read back bit for bit. For `uint8` and `uint16`, `low` and `high`
    are the values that become black and white (0 and 255 or 65535; linear, nearest, clipped);
    without them the samples must be whole numbers within the range already. `metadata` are what
    `read_info` finds again where the format has room: ``unit``, ``focal_length_mm``, ``fov_x_deg``
    and ``fov_y_deg``.
    """
    file = Path(os.fspath(path))
    suffix, kind = file.suffix.lower(), written_format(file)
    if kind is None or kind.write is None:
        allowed = ", ".join(suffixes(*WRITTEN))
        raise FileError(f"{path}: unknown picture suffix {suffix!r}; allowed: {allowed}")
    if dtype not in kind.dtypes:
        allowed = f"a {suffix} file holds {', '.join(kind.dtypes)}"
        raise ParameterError("dtype", dtype, allowed)
    kind.write(file, as_stored(as_picture(array), dtype, low, high), metadata or {})
