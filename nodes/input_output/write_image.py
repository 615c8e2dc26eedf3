"""Write Image: a picture into a file when a run asks for outputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.realize import realize
from core.chain.wires import Image
from core.errors import ParameterError
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from nodes.files.arrays import write_npy
from nodes.files.picture_writing import DTYPES, MetadataValue, write_picture
from nodes.files.read import check_finite

Format = Literal["by_suffix", "exr", "tif", "png", "npy"]
Dtype = Literal["automatic", "float", "double", "half", "uint8", "uint16"]
Files = list[tuple[Path, Callable[[Path], None]]]

_HOLDS: Mapping[str, tuple[str, ...]] = {**DTYPES, ".npy": ("float", "double")}
_SUFFIXES: Mapping[str, tuple[str, ...]] = {
    "exr": (".exr",),
    "tif": (".tif", ".tiff"),
    "png": (".png",),
    "npy": (".npy",),
}


class WriteImage(
    Module, key="write_image", title="Write Image", group="Input and output", sink=True
):
    """Write the picture to a file, only when a run asks for outputs.

    Integer types map `range_low` … `range_high` (empty: the picture's least and greatest sample)
    to the type's whole range. `automatic` is the evaluation's precision where the format holds
    it, and 16-bit integers for PNG.
    """

    path: Annotated[Path | None, Param("file to write, relative to the network file's folder")] = (
        None
    )
    format: Annotated[Format, Param("format of the file")] = "by_suffix"
    dtype: Annotated[Dtype, Param("type of the stored samples")] = "automatic"
    range_low: Annotated[
        float | None, Param("sample stored as 0 by integer types", zero_is_empty=False)
    ] = None
    range_high: Annotated[
        float | None, Param("sample stored as the largest integer", zero_is_empty=False)
    ] = None

    panel = (
        Section("File", ("path", "format", "dtype")),
        Section("Range of integer types", ("range_low", "range_high")),
    )

    def check(self) -> None:
        """Refuse an empty range."""
        low, high = self.range_low, self.range_high
        if low is not None and high is not None and low >= high:
            raise ParameterError("range_high", high, f"above range_low = {low:g}")

    def run(self, image: Image, here: NodeContext) -> None:
        """Check where and how to write."""
        suffix = self.target(here).suffix.lower()
        if self.dtype not in ("automatic", *_HOLDS[suffix]):
            allowed = f"automatic, or what a {suffix} file holds: {', '.join(_HOLDS[suffix])}"
            raise ParameterError("dtype", self.dtype, allowed)

    def target(self, here: NodeContext) -> Path:
        """The file, with the suffix of its format.

        Raises
        ------
        ParameterError
            No path, a suffix of no known format, or of another one than asked for.
        """
        if self.path is None:
            allowed = "a file name, relative to the network file's folder"
            raise ParameterError("path", None, allowed)
        suffix, path = self.path.suffix.lower(), here.folder / self.path
        if self.format == "by_suffix":
            if suffix not in _HOLDS:
                allowed = f"a name that ends in {', '.join(_HOLDS)}; or choose a format"
                raise ParameterError("path", self.path.as_posix(), allowed)
            return path
        wanted = _SUFFIXES[self.format]
        if suffix in wanted:
            return path
        if suffix in _HOLDS:
            raise ParameterError("format", self.format, f"by_suffix, or that of {self.path.name}")
        return path.with_name(path.name + wanted[0])

    def files(self, inputs: Mapping[str, Any], here: NodeContext, work: Work) -> Files:
        """Compute the picture; the file and what writes it."""
        image: Image = inputs["image"]
        target = self.target(here)
        samples = realize(image, work)
        dtype = self._stored(target.suffix.lower(), samples)
        if target.suffix.lower() == ".npy":
            return [(target, partial(write_array, samples=samples, dtype=dtype))]
        low, high = self._range(samples) if dtype.startswith("uint") else (None, None)
        writer = partial(
            write_picture, array=samples, dtype=dtype, low=low, high=high, metadata=_told(image)
        )
        return [(target, writer)]

    def _stored(self, suffix: str, samples: NDArray[Any]) -> str:
        if self.dtype != "automatic":
            return self.dtype
        if suffix == ".png":
            return "uint16"
        return "double" if samples.dtype == np.float64 and "double" in _HOLDS[suffix] else "float"

    def _range(self, samples: NDArray[Any]) -> tuple[float, float]:
        low = float(samples.min()) if self.range_low is None else self.range_low
        high = float(samples.max()) if self.range_high is None else self.range_high
        if high > low:
            return low, high
        # Every sample lies beyond the one end that was given, or all are equal.
        if self.range_high is not None:
            return math.nextafter(high, -math.inf), high
        return low, math.nextafter(low, math.inf)


def write_array(path: Path, *, samples: NDArray[Any], dtype: str) -> None:
    """Write ``.npy`` in the given precision.

    Raises
    ------
    DataError
        Samples beyond single precision.
    """
    with np.errstate(over="ignore"):  # reported below, with the place
        stored = samples.astype(np.float32 if dtype == "float" else np.float64, copy=False)
    check_finite(stored, f"{path.name} as {dtype}")
    write_npy(path, stored)


def _told(image: Image) -> dict[str, MetadataValue]:
    """What Read Image finds again in the file."""
    told: dict[str, MetadataValue] = {}
    if image.unit:
        told["unit"] = image.unit
    for name, interval, samples in (
        ("fov_x_deg", image.interval_x_mrad, image.columns),
        ("fov_y_deg", image.interval_y_mrad, image.rows),
    ):
        fov_deg = None if interval is None else math.degrees(interval * samples / 1000)
        if fov_deg is not None and fov_deg < 180:
            told[name] = fov_deg
    if image.header.focal_length_mm is not None:
        told["focal_length_mm"] = image.header.focal_length_mm
    return told
