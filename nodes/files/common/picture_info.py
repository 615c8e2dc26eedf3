"""What is known of a picture before its samples are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

MetadataValue = str | int | float
Samples = NDArray[np.floating[Any]]  # float32 or float64, (rows, columns), C order


@dataclass(frozen=True)
class PictureInfo:
    """Size, kind and header of a picture file.

    What the file does not give is None.

    Attributes
    ----------
    path
        The file that holds the samples (for ENVI the data file, not the header).
    rows, columns, bands
        Size; a band is a channel of a colour picture or a spectral band.
    unit
        Unit of the samples as the file words it.
    wavelengths_um, fwhm_um
        Centre and full width at half maximum of every band, µm.
    focal_length_mm
        Focal length, mm.
    fov_x_deg, fov_y_deg
        Field of view of the whole frame, degrees.
    dtype
        numpy's name of the stored samples, such as ``uint16``.
    kind
        ``envi``, ``npy``, ``text`` or the picture format (``tiff``, ``openexr``, ``png``, …).
    channels
        Names of the channels of a colour picture, such as R, G and B; empty where there is one
        channel or the bands are spectral.
    not_applied
        Fields of the header that would change the samples, which are delivered as stored.
    shares_um
        Share of every band in the sum of all, µm, where that is not what its width makes it.
    wavelengths_assumed
        The file names no unit of its wavelengths, which are taken as µm.
    lossy
        The file's compression leaves out what the eye would not miss.
    absent_chunks
        Files of a Zarr store that are not there, whose samples are missing.
    bad_bands
        Bands that the header marks as bad, counted from 0; sums leave them out.
    """

    path: Path
    rows: int
    columns: int
    bands: int
    dtype: str
    kind: str
    unit: str | None = None
    wavelengths_um: tuple[float, ...] | None = None
    fwhm_um: tuple[float, ...] | None = None
    focal_length_mm: float | None = None
    fov_x_deg: float | None = None
    fov_y_deg: float | None = None
    channels: tuple[str, ...] = ()
    not_applied: tuple[str, ...] = ()
    shares_um: tuple[float, ...] | None = None
    wavelengths_assumed: bool = False
    lossy: bool = False
    absent_chunks: int = 0
    bad_bands: tuple[int, ...] = ()


def delivered_dtype(stored: np.dtype[Any]) -> np.dtype[Any]:
    """Return the precision samples are delivered in.

    Double for doubles and for integers of 32 or more bits, which single precision would round;
    else single, which holds every 16-bit integer and half exactly. Integers of 64 bits beyond
    2⁵³ are rounded to the nearest double.
    """
    if stored.kind == "f":
        return np.dtype(np.float64 if stored.itemsize > 4 else np.float32)
    return np.dtype(np.float64 if stored.itemsize >= 4 else np.float32)


def metadata_text(metadata: Mapping[str, object]) -> str:
    """``key = value``, one on a line, as `nodes.files.header_fields` reads it."""
    return "\n".join(f"{key} = {' '.join(str(value).split())}" for key, value in metadata.items())
