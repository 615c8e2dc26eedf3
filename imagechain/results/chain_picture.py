"""One picture of a result: samples with their unit, interval and band."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.run.saving import encode_png, grey_levels, metadata_of, robust_limits, save_array
from core.chain.wires import Image
from core.errors import ParameterError
from core.evaluation.recipes import Region
from core.evaluation.work import Work
from imagechain.parts.plain_errors import block, needed, plain_errors, png, stays_here, text

if TYPE_CHECKING:
    from xarray import DataArray

_WIDEST = 640  # on a page
_MOST_PX = 1024


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture that a chain has computed, at a port ``NODE.PORT``.

    Its samples are read-only, with the shape (rows, columns) or (frames, rows, columns).
    """

    port: str
    _image: Image = field(repr=False)
    samples: NDArray[Any] = field(repr=False)
    _work: Work = field(repr=False)
    _region: Region | None = field(repr=False)

    __reduce__ = stays_here

    @property
    def unit(self) -> str:
        """Unit of the samples."""
        return self._image.unit

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the samples."""
        return self.samples.shape

    @property
    def interval_mrad(self) -> tuple[float | None, float | None]:
        """Horizontal and vertical sampling interval, mrad; None if unknown."""
        return self._image.interval_x_mrad, self._image.interval_y_mrad

    @property
    def band_um(self) -> tuple[float, float] | None:
        """Cut-on and cut-off wavelength, µm; None if unknown."""
        return self._image.band_um

    @property
    def wavelengths_um(self) -> tuple[float, ...]:
        """Centre wavelengths of the bands, µm; empty if there are no separate bands."""
        return () if self._image.bands is None else self._image.bands.centres_um

    @plain_errors
    def band(self, index: int) -> NDArray[Any]:
        """Samples of one wavelength band, counted from 0; radiance is per µm."""
        bands = self._image.bands
        count = 0 if bands is None else bands.count
        if bands is None or not 0 <= index < count:
            allowed = f"0 to {count - 1}" if count else "the picture has no bands"
            raise ParameterError("band", index, allowed)
        samples = self._work.value(bands.band(index))
        samples = samples if self._region is None else self._region.cut(samples)
        samples.flags.writeable = False
        return samples.view()

    @plain_errors
    def cube(self) -> NDArray[Any]:
        """All wavelength bands, (bands, rows, columns), each as from `band`."""
        return np.stack([self.band(index) for index in range(max(1, len(self.wavelengths_um)))])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.samples, dtype=dtype, copy=copy)

    @plain_errors
    def to_xarray(self, *, bands: bool = False) -> DataArray:
        """Return a `DataArray` over y and x, mrad from the centre; unit and band are attributes.

        y increases downwards, as the rows do.

        Parameters
        ----------
        bands : bool
            Whether to return all bands, over wavelength (µm), y and x, instead of their sum.
        """
        xarray = needed("xarray", "pictures as DataArrays")
        image, region = self._image, self._region
        coordinates = {}
        spans = zip(
            ("y", "x"),
            image.shape,
            (image.interval_y_mrad, image.interval_x_mrad),
            (slice(None), slice(None)) if region is None else region.slices,
            strict=True,
        )
        for axis, length, interval, part in spans:
            if interval is not None:
                places = (np.arange(length) - (length - 1) / 2.0) * interval
                coordinates[axis] = (axis, places[part], {"units": "mrad"})
        samples, unit = (self.cube(), self._band_unit) if bands else (self.samples, self.unit)
        attributes: dict[str, Any] = {"units": unit}
        for name, interval in zip(("x", "y"), self.interval_mrad, strict=True):
            if interval is not None:
                attributes[f"interval_{name}_mrad"] = interval
        if self.band_um is not None:
            attributes["band_um"] = list(self.band_um)
        if bands:
            units = {"units": "µm"}
            coordinates["wavelength"] = ("wavelength", np.array(self.wavelengths_um), units)
        first = "wavelength" if bands else "frame"
        array: DataArray = xarray.DataArray(
            samples,
            dims=(first, "y", "x")[-samples.ndim :],
            coords=coordinates,
            attrs=attributes,
            name=self.port,
        )
        return array

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the samples in the format of the file's suffix, with unit and field of view."""
        target = Path(fspath(path))
        samples = self._first("a file with one picture")
        save_array(target, samples, metadata_of(self._image, samples.shape))
        return target

    @property
    def _band_unit(self) -> str:
        density = self._image.bands is not None and self._image.bands.density
        return f"{self.unit}/µm" if density else self.unit

    def to_png(self, most_px: int | None = None) -> bytes:
        """Return the first frame as an 8-bit grey PNG, scaled to its 0.1 to 99.9 % quantiles.

        Parameters
        ----------
        most_px : int, optional
            Largest number of rows or columns; larger pictures are reduced by averaging pixels.
        """
        samples = self.samples[0] if self.samples.ndim == 3 else self.samples
        samples = samples if most_px is None else _reduced(samples, most_px)
        return encode_png(grey_levels(*robust_limits(samples), samples))

    def _first(self, what: str) -> NDArray[Any]:
        if self.samples.ndim == 3:
            raise ParameterError("frames", len(self.samples), f"must be 1 for {what}")
        return self.samples

    def __repr__(self) -> str:
        size = " × ".join(map(str, self.shape))
        return f"<Picture {self.port}: {size} {self.samples.dtype}, {self.unit or 'no unit'}>"

    def _repr_html_(self) -> str:
        width = min(_WIDEST, self.samples.shape[-1])
        picture = png(self.to_png(_MOST_PX), alt=self.port, width=width)
        return block(picture, text(repr(self)[1:-1]))


def _reduced(samples: NDArray[Any], most_px: int) -> NDArray[Any]:
    """Means of as many neighbours as leave at most so many rows and columns."""
    rows, columns = samples.shape
    down, across = -(-rows // most_px), -(-columns // most_px)
    if down == across == 1:
        return samples
    made = np.empty((rows // down, columns // across), samples.dtype)
    for row in range(len(made)):  # one after the other: the picture may be larger than memory
        lines = samples[row * down : (row + 1) * down, : made.shape[1] * across]
        made[row] = lines.reshape(down, -1, across).mean(axis=(0, 2), dtype=np.float64)
    return made
