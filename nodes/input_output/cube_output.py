"""Writing all bands of a picture into an ENVI file, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.atomic import atomic_file, write_text
from core.chain.wires import Image
from core.evaluation.recipes import Recipe
from core.evaluation.region import Region
from core.evaluation.work import Work
from core.spectrum.band_stack import BandStack
from nodes.files.common.picture_info import MetadataValue
from nodes.files.frames.envi_frames import envi_header_text
from nodes.files.frames.frame_series import FrameSeries
from nodes.files.read import check_finite

Array = NDArray[Any]
_BYTES_AT_ONCE = 1 << 26
_BANDS_AT_ONCE = 16
_TOUCHING = 1e-9  # of the wavelength, by which bands that touch may overlap by rounding


@dataclass(frozen=True)
class Cube:
    """The bands of a picture, as they are written.

    Parameters
    ----------
    image : Image
        A picture with bands.
    dtype : dtype
        float32 or float64.
    metadata : mapping
        What is known of the picture: field of view, focal length; of its unit, the bands'.
    region : Region, optional
        Rows and columns that are written, all if not given.
    """

    image: Image
    dtype: np.dtype[Any]
    metadata: Mapping[str, MetadataValue] = field(default_factory=dict)
    region: Region | None = None

    @property
    def bands(self) -> BandStack:
        """The bands."""
        assert self.image.bands is not None
        return self.image.bands

    @property
    def series(self) -> FrameSeries:
        """Size, type and header."""
        bands, unit = self.bands, _plain(self.image.unit)
        header: dict[str, MetadataValue | tuple[float, ...]] = {**self.metadata}
        header["unit"] = f"{unit}/um" if bands.density else unit
        header["wavelength_units"] = "Micrometers"
        header["wavelength"] = bands.centres_um
        header["fwhm"] = bands.widths_um
        if _overlapping(bands):  # would be shared once more where it is read
            header["band_shares"] = bands.widths_um
        shape = self.image.shape if self.region is None else self.region.shape
        return FrameSeries(bands.count, *shape, self.dtype.newbyteorder("<"), header, "bands")

    def write(self, path: Path, work: Work, *, name: str) -> None:
        """Write the data file: what is in memory at a time is a few bands.

        Raises
        ------
        DataError
            A sample is not finite; `name` is what the picture is called there.
        FileError
            The file cannot be written; what was there is as it was.
        """
        dtype = self.series.dtype
        with atomic_file(path) as temporary, temporary.open("wb") as file:
            for several in work.one_by_one(self._recipes(), forgetting=True):
                work.check()
                for band in several:
                    cut = band if self.region is None else self.region.cut(band)
                    check_finite(cut, name)
                    file.write(np.ascontiguousarray(cut, dtype).data)

    def write_header(self, path: Path) -> None:
        """Write the header that belongs beside it."""
        write_text(path, envi_header_text(self.series))

    def _recipes(self) -> Iterator[Recipe]:
        """The bands, as many together as are read in one pass over a file."""
        count = self.bands.count
        of_band = self.image.rows * self.image.columns * 8
        step = min(max(1, _BYTES_AT_ONCE // of_band), _BANDS_AT_ONCE)
        for start in range(0, count, step):
            chosen = range(start, min(start + step, count))
            yield self.bands.sums(
                tuple(tuple(float(place == one) for place in range(count)) for one in chosen)
            )


def _overlapping(bands: BandStack) -> bool:
    """Whether shares of the spectrum, laid about their wavelengths, overlap."""
    order = np.argsort(bands.centres_um)
    centres, halves = np.array(bands.centres_um)[order], np.array(bands.widths_um)[order] / 2.0
    low, high = centres - halves, centres + halves
    return bool(np.any(np.maximum.accumulate(high)[:-1] > low[1:] * (1.0 + _TOUCHING)))


def _plain(unit: str) -> str:
    """A unit in the characters of old headers."""
    return unit.replace("²", "^2").replace("µ", "u")
