"""Pictures by OpenImageIO: EXR, TIFF (float, tiled, BigTIFF), HDR, PNG, FITS, JPEG and more.

Samples are delivered as the numbers the file stores: an 8-bit 200 reads 200.0, never 200/255,
and colour is not multiplied by alpha. Integers of a packed depth (4, 10, 12 bits) have their own
range, not the one of the container. FITS samples are scaled by BZERO and BSCALE as the format
asks, with the row that FITS stores last at the top. A TIFF that counts white as 0 is delivered
with black as 0. A band is a channel of the first picture in the file.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from nodes.files.damage import png_bit_depth, refuse_damaged
from nodes.files.header_fields import FieldValue, header_fields
from nodes.files.paths import checked_band, first_bytes, readable_file
from nodes.files.picture_info import PictureInfo, Samples, delivered_dtype
from nodes.files.picture_writing import DTYPES as WRITABLE_DTYPES
from nodes.files.picture_writing import write_picture
from nodes.files.quiet import quiet_stderr
from nodes.files.tiled_tiff import read_tiled_doubles

__all__ = ["SUFFIXES", "WRITABLE_DTYPES", "read_band", "read_info", "write_picture"]

# Pictures by their suffix, whatever .hdr lies beside them; others are known by their content.
SUFFIXES = (".exr", ".tif", ".tiff", ".png", ".jpg", ".jpeg", ".jp2", ".bmp", ".fits", ".fit")
# These two invent a picture or draw on the terminal instead of reading the file.
_NOT_FORMATS = ("null", "term")
_NUMPY_NAMES = {
    "half": "float16",
    "float": "float32",
    "double": "float64",
    "uint": "uint32",
    "int": "int32",
}
_READABLE = {"uint8", "int8", "uint16", "int16", "uint64", "int64", *_NUMPY_NAMES.values()}


def read_info(path: str | os.PathLike[str]) -> PictureInfo:
    """Read size, sample type and header of a picture, not its samples.

    Raises
    ------
    FileError
        The file is missing, damaged or of an unknown format, or holds no plain 2-D picture.
    """
    file = readable_file(path)
    with _opened(file) as picture:
        return _info(file, picture)


def read_band(path: str | os.PathLike[str], band: int = 0) -> Samples:
    """Read one channel.

    Parameters
    ----------
    path
        A picture file.
    band
        Channel, counted from 0 in the order red, green, blue, alpha, others.

    Returns
    -------
    numpy.ndarray
        (rows, columns), C order; float64 when the file holds doubles or integers of 32 or more
        bits, else float32.

    Raises
    ------
    FileError
        As `read_info`; damage among the samples; there is no such channel.
    """
    file = readable_file(path)
    refuse_damaged(file)
    with _opened(file) as picture:
        info = _info(file, picture)
        band = checked_band(band, info.bands, file)
        if _is_misread(picture, file):
            return read_tiled_doubles(file, band)
        try:
            stored = picture.read_image(0, 0, band, band + 1, _channel_type(picture.spec(), band))
        except (MemoryError, RuntimeError, ValueError) as error:
            raise FileError(f"{file}: cannot be read: {error or 'out of memory'}") from error
        if stored is None or picture.has_error:
            raise FileError(f"{file}: is damaged: {_message(picture.geterror)}")
        attributes = _attributes(picture.spec())
        bits = picture.spec().get_int_attribute("oiio:BitsPerSample", 0)
    if info.kind == "png":
        bits = png_bit_depth(first_bytes(file, 32)) or 0
    samples = _at_own_depth(stored.reshape(info.rows, info.columns), bits)
    if info.kind == "fits":
        samples = _scaled(samples, attributes, file)
    dtype = delivered_dtype(np.dtype(info.dtype))
    return np.ascontiguousarray(samples, dtype=dtype)


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    # Imported when needed: 30 ms that a network without picture files need not pay.
    import OpenImageIO

    with quiet_stderr():
        wishes = OpenImageIO.ImageSpec()
        wishes.attribute("oiio:UnassociatedAlpha", 1)  # else colour is multiplied by alpha
        try:
            picture = OpenImageIO.ImageInput.open(os.fspath(path), wishes)
        except (MemoryError, RuntimeError, ValueError) as error:
            raise FileError(f"{path}: cannot be opened: {error or 'out of memory'}") from error
        if picture is None:
            raise FileError(f"{path}: cannot be opened: {_message(OpenImageIO.geterror)}")
        try:
            yield picture
        finally:
            picture.close()


def _info(path: Path, picture: Any) -> PictureInfo:
    spec = picture.spec()
    kind = str(picture.format_name())
    if kind in _NOT_FORMATS:
        raise FileError(f"{path}: unknown format {path.suffix or '(no suffix)'}")
    if spec.deep or spec.depth > 1:
        raise FileError(f"{path}: holds a volume or deep samples; allowed: plain 2-D pictures")
    if spec.width < 1 or spec.height < 1 or spec.nchannels < 1:
        raise FileError(f"{path}: its first picture has no samples or its header is damaged")
    stored = {_numpy_name(_channel_type(spec, band)) for band in range(spec.nchannels)}
    if not stored <= _READABLE:
        raise FileError(f"{path}: samples of type {', '.join(sorted(stored))} are not supported")
    attributes = _attributes(spec)
    description = str(attributes.get("ImageDescription", ""))
    common = header_fields(attributes, description=description, where=str(path))
    return PictureInfo(
        path=path,
        rows=spec.height,
        columns=spec.width,
        bands=spec.nchannels,
        unit=common.unit,
        wavelengths_um=None,
        fwhm_um=None,
        focal_length_mm=common.focal_length_mm,
        fov_x_deg=common.fov_x_deg,
        fov_y_deg=common.fov_y_deg,
        dtype=max(stored, key=_precision),
        kind=kind,
    )


def _is_misread(picture: Any, path: Path) -> bool:
    """Whether the library would deliver uninitialised memory for these tiles of doubles.

    Other kinds of tile that it is known to misread are refused.
    """
    spec = picture.spec()
    if picture.format_name() != "tiff" or spec.tile_width == 0:
        return False
    bits = spec.get_int_attribute("oiio:BitsPerSample", 0)
    cmyk = spec.get_int_attribute("tiff:PhotometricInterpretation", 0) == 5
    if 16 < bits < 32 or cmyk:
        what = "CMYK" if cmyk else f"{bits}-bit"
        raise FileError(f"{path}: tiles of {what} samples cannot be read; store strips instead")
    return bool(bits == 64)


def _precision(name: str) -> tuple[int, str]:
    """Order of sample types: channels of mixed type are all delivered as the most precise."""
    return delivered_dtype(np.dtype(name)).itemsize, name


def _channel_type(spec: Any, band: int) -> Any:
    return spec.channelformats[band] if spec.channelformats else spec.format


def _numpy_name(kind: Any) -> str:
    return _NUMPY_NAMES.get(str(kind), str(kind))


def _attributes(spec: Any) -> dict[str, FieldValue]:
    """Return the header's texts and numbers; what is no text in any encoding is left out."""
    found: dict[str, FieldValue] = {}
    for attribute in spec.extra_attribs:
        with contextlib.suppress(UnicodeDecodeError):
            value = attribute.value
            if isinstance(value, str | int | float):
                found[str(attribute.name)] = value
    return found


def _message(geterror: Callable[[], str]) -> str:
    try:
        lines = geterror().splitlines()
    except UnicodeDecodeError:  # the library quotes bytes of a damaged file
        lines = []
    return lines[0].strip() if lines else "the file is damaged"


def _at_own_depth(stored: NDArray[Any], bits: int) -> NDArray[Any]:
    """Undo the stretching of packed integers (12 bits, say) to the full range of 8 or 16."""
    full = 8 * stored.dtype.itemsize
    if stored.dtype.kind != "u" or not 0 < bits < full:
        return stored
    own_range, full_range = 2**bits - 1, 2**full - 1
    return np.rint(stored * np.float64(own_range / full_range))


def _scaled(stored: NDArray[Any], attributes: dict[str, FieldValue], path: Path) -> NDArray[Any]:
    """Physical values of FITS: BZERO + BSCALE × stored."""
    cards = {key.lower(): value for key, value in attributes.items()}
    try:
        zero, scale = (float(str(cards.get(key, of))) for key, of in (("bzero", 0), ("bscale", 1)))
    except ValueError as error:
        raise FileError(f"{path}: BZERO or BSCALE is no number: {error}") from error
    if zero == 0 and scale == 1:
        return stored
    return stored * scale + zero
