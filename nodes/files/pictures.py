"""Pictures by OpenImageIO: EXR, TIFF (float, tiled, BigTIFF), HDR, PNG, FITS, JPEG and more.

Samples are the numbers that the file stores: an 8-bit 200 reads 200.0, colour is not multiplied by
alpha, and integers of a packed depth (12 bits, say) have their own range. FITS is scaled by BZERO
and BSCALE, its last row at the top; a TIFF that counts white as 0 is turned to black as 0.
"""

import contextlib
import os
import re
import sys
import threading
import zlib
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.atomic import atomic_file
from core.errors import FileError
from core.machine import Empty
from nodes.files import picture_info
from nodes.files.fits_header import check_sums, read_fits_header, refuse_unsupported
from nodes.files.stored_bytes import StoredBytes, checked_band, first_bytes, stored_bytes
from nodes.files.tiff_reading import check_deflate, is_deflated, read_plain_tiff

# Rows that a format packs together: 256 of DWAB, fewer of all others.
_STRIP_ROWS, _STRIP_BYTES = 256, 1 << 25
# These two invent a picture or draw on the terminal instead of reading the file.
_NOT_FORMATS = ("null", "term")
_NUMPY_NAMES = {
    "half": "float16",
    "float": "float32",
    "double": "float64",
    "uint": "uint32",
    "int": "int32",
}
_BLANK_BYTES = 16
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_START = b"\xff\xd8\xff"
_JPEG_SCAN = b"\xff\xda"
_JPEG_END = b"\xff\xd9"
_FITS_START = b"SIMPLE  ="
_ADVICE = re.compile(
    r"\s*\([^()]*(\?|maybe )[^()]*\)"
    r"|(^|(?<=[.!]))\s*([^.!?()]*\?+|(Please|Perhaps|Maybe)\b[^.!]*[.!]?)"
    r"|,?\s*(or maybe|please)\b[^.!]*"
)

_LOSSY_PACKING = ("jpeg", "webp", "pxr24", "b44", "b44a", "dwaa", "dwab", "lossy")
_MAIN_HEADER = 1 << 16  # bytes, that hold the main header
_CODING_STYLE = b"\xff\x52\x00"  # marker, and the first byte of the length
_WAVELETS_AT = 13  # bytes from that marker on
_IRREVERSIBLE = 0
_READABLE = {"uint8", "int8", "uint16", "int16", "uint64", "int64", *_NUMPY_NAMES.values()}

# Measured on 4096² floats: zip costs TIFF 2.4 s against 0.3 s and saves a tenth.
_COMPRESSION = {"openexr": "zips", "tiff": "none"}
_ROWS_COMPARED = 256
_BIGTIFF_BYTES = 4_000_000_000  # classic TIFF ends at 2³² bytes, directory included

# OpenImageIO 3.2 says so after every TIFF without Exif data, all of whose samples are in place.
_FALSE_ALARM = "failed TIFFWriteCustomDirectory() of the Exif data"

# Descriptor 2 belongs to the whole process: two threads that redirect it at once could restore it
# in the wrong order and lose it for good.
_DESCRIPTOR_LOCK = threading.Lock()
_STDERR = 2


def read_info(path: Path) -> picture_info.PictureInfo:
    refuse_unsupported(path)
    with _opened(path) as picture:
        return _info(path, picture)


def read_band(path: Path, band: int = 0, *, empty: Empty = np.empty) -> picture_info.Samples:
    """Read one channel, in the order red, green, blue, alpha, others."""
    refuse_unsupported(path)
    refuse_damaged(path)
    with _opened(path) as picture:
        info = _info(path, picture)
        band = checked_band(band, info.bands, path)
        if empty is np.empty:
            picture_info.refuse_oversized(info)
        misread = info.kind == "tiff" and _is_misread(picture, path)
        if misread or (info.kind == "tiff" and is_deflated(path)):
            size = info.rows, info.columns, info.bands
            plain = read_plain_tiff(path, size, band, empty=empty)
            if plain is not None:
                return plain
            if misread:
                raise FileError(
                    f"{path}: 64-bit samples in tiles or a single row cannot be read from this "
                    "file; allowed: photometric interpretation 1 (black is 0) or 2 (RGB), with "
                    "FillOrder 1"
                )
            check_deflate(path)
        values = _values(path, picture, info)
        samples = empty(
            (info.rows, info.columns), picture_info.delivered_dtype(np.dtype(info.dtype))
        )
        for rows, stored in _strips(path, picture, band):
            samples[rows] = values(stored)
    return samples


def write_by_oiio(
    path: Path, stored: NDArray[Any], metadata: Mapping[str, picture_info.MetadataValue]
) -> None:
    """Write samples (rows, columns, channels) as they are, metadata as ``key = value`` lines."""
    # Imported when needed: 30 ms that a run without picture files need not pay.
    import OpenImageIO

    with atomic_file(path) as temporary:
        with _quiet_stderr():
            output = OpenImageIO.ImageOutput.create(path.suffix.removeprefix(".").lower())
            if output is None:
                raise FileError(f"cannot write {path}: {OpenImageIO.geterror()}")
            spec = _spec(stored, metadata, str(output.format_name()))
            opened = output.open(os.fspath(temporary), spec)
            written = opened and output.write_image(stored)
            closed = output.close()
            # A PNG on a full disk reports success and leaves only the message.
            complaint = _complaint(output.geterror()).replace(os.fspath(temporary), str(path))
        if not (written and closed and not complaint and _reads_as(temporary, stored)):
            raise FileError(f"cannot write {path}: {complaint or 'the disk may be full'}")


def _values(path: Path, picture: Any, info: picture_info.PictureInfo) -> Callable[[Array], Array]:
    if info.kind == "fits":
        return read_fits_header(path).values
    return partial(_at_own_depth, bits=_stored_bits(path, picture.spec(), info.kind))


def _stored_bits(path: Path, spec: Any, kind: str) -> int:
    if kind == "png":
        return png_bit_depth(first_bytes(path, 32)) or 0
    return int(spec.get_int_attribute("oiio:BitsPerSample", 0))


def _strips(path: Path, picture: Any, band: int) -> Iterator[tuple[slice, Array]]:
    """The rows of a channel in turn, so that the memory beside the picture stays small."""
    spec = picture.spec()
    kind = _channel_type(spec, band)
    step = max(1, _STRIP_BYTES // (_STRIP_ROWS * spec.width * 8)) * _STRIP_ROWS
    if spec.tile_width:
        step = -(-step // spec.tile_height) * spec.tile_height
    for start in range(0, spec.height, step):
        end = min(start + step, spec.height)
        top, left = spec.y + start, spec.x
        try:
            if spec.tile_width:
                tiles = (left, left + spec.width, top, top + end - start, 0, 1)
                stored = picture.read_tiles(*tiles, band, band + 1, kind)
            else:
                stored = picture.read_scanlines(top, top + end - start, 0, band, band + 1, kind)
        except (MemoryError, RuntimeError, ValueError) as error:
            raise FileError(f"{path}: cannot be read: {error or 'out of memory'}") from error
        if stored is None or picture.has_error:
            raise _unread(path, _message(picture.geterror))
        if stored.size != (end - start) * spec.width:
            raise FileError(f"{path}: damaged: rows {start} to {end} are incomplete")
        yield slice(start, end), stored.reshape(end - start, spec.width)


def _unread(path: Path, message: str) -> FileError:
    """A packing that this build of the library does not support is no damage."""
    if "support is not configured" in message:
        return FileError(
            f"{path}: cannot be read: {message}; allowed compression: none, deflate or LZW"
        )
    return FileError(f"{path}: damaged: {message}")


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    _refuse_blank(path)
    # Imported when needed: 30 ms that a network without picture files need not pay.
    import OpenImageIO

    with _quiet_stderr():
        wishes = OpenImageIO.ImageSpec()
        wishes.attribute("oiio:UnassociatedAlpha", 1)  # else colour is multiplied by alpha
        try:
            picture = OpenImageIO.ImageInput.open(os.fspath(path), wishes)
        except (MemoryError, RuntimeError, ValueError) as error:
            raise FileError(f"{path}: cannot be opened: {error or 'out of memory'}") from error
        if picture is None:
            message = _message(OpenImageIO.geterror)
            if message.startswith("OpenImageIO could not find a format reader"):
                message = "it is not a picture in a known format"
            raise FileError(f"{path}: cannot be opened: {message}")
        try:
            yield picture
        finally:
            picture.close()


def _refuse_blank(path: Path) -> None:
    """Refuse a file that begins with zeros, as one does that was made but never filled.

    Every format begins with something else. The library looks through all of such a file, which
    takes it more than a minute per 500 MB, and cannot be stopped.
    """
    if not any(first_bytes(path, _BLANK_BYTES)):
        raise FileError(
            f"{path}: not a picture, or never written: its first {_BLANK_BYTES} bytes are 0"
        )


def _info(path: Path, picture: Any) -> picture_info.PictureInfo:
    spec = picture.spec()
    kind = str(picture.format_name())
    if kind in _NOT_FORMATS:
        raise FileError(f"{path}: unknown format {path.suffix or '(no suffix)'}")
    if spec.deep or spec.depth > 1:
        raise FileError(f"{path}: contains a volume or deep samples; allowed: plain 2-D pictures")
    if spec.width < 1 or spec.height < 1 or spec.nchannels < 1:
        raise FileError(
            f"{path}: the first picture in this file has no samples, or the file's header is "
            "damaged"
        )
    kinds = [str(_channel_type(spec, band)) for band in range(spec.nchannels)]
    stored = {_NUMPY_NAMES.get(kind, kind) for kind in kinds}
    if not stored <= _READABLE:
        raise FileError(f"{path}: samples of type {', '.join(sorted(stored))} are not supported")
    attributes = _attributes(spec)
    description = str(attributes.get("ImageDescription", ""))
    compression = str(attributes.get("compression", ""))
    common = picture_info.header_fields(attributes, description=description, where=str(path))
    info = picture_info.PictureInfo(
        path=path,
        rows=spec.height,
        columns=spec.width,
        bands=spec.nchannels,
        dtype=max(stored, key=_precision),
        kind=kind,
        channels=() if kind == "fits" else _channel_names(spec),  # planes of a cube are no colours
        lossy=_is_lossy(path, kind=kind, compression=compression),
        **common,
    )
    if kind == "tiff":
        is_deflated(path)  # refused where its packing can be read in two ways
    bits = _stored_bits(path, spec, kind) or 8 * np.dtype(info.dtype).itemsize
    picture_info.refuse_impossible(info, compression=compression, bits=bits)
    if kind != "tiff":  # of which rows are read one after the other
        picture_info.refuse_oversized(info)
    if kind == "fits":
        read_fits_header(path)  # refused where it cannot be used, before samples are read
    return info


def _is_lossy(path: Path, *, kind: str, compression: str) -> bool:
    """Whether samples of a file are others than those that were stored in it.

    Source: ITU-T T.800, table A.20 (JPEG 2000: irreversible wavelets are those of 9 and 7 taps);
    RFC 9649 (WebP: a chunk named VP8L has no loss).
    """
    if kind == "jpeg" or compression.partition(":")[0].lower() in _LOSSY_PACKING:
        return True
    if kind == "webp":
        return b"VP8L" not in first_bytes(path, _MAIN_HEADER)
    if kind == "jpeg2000":
        start = first_bytes(path, _MAIN_HEADER)
        place = start.find(_CODING_STYLE)
        return place >= 0 and start[place + _WAVELETS_AT :][:1] == bytes([_IRREVERSIBLE])
    return False


def _channel_names(spec: Any) -> tuple[str, ...]:
    try:
        names = tuple(str(name) for name in spec.channelnames)
    except UnicodeDecodeError:  # a damaged name
        names = ()
    if len(names) != spec.nchannels:
        names = tuple(f"channel {band}" for band in range(spec.nchannels))
    colours = spec.nchannels - (spec.alpha_channel >= 0)
    return names if colours > 1 else ()


def _is_misread(picture: Any, path: Path) -> bool:
    """Whether the library delivers uninitialised memory; other tiles it misreads are refused."""
    spec = picture.spec()
    bits = spec.get_int_attribute("oiio:BitsPerSample", 0)
    if spec.tile_width == 0:
        return bool(bits == 64 and spec.height == 1)
    colour = spec.get_int_attribute("tiff:PhotometricInterpretation", 0)
    if bits == 64 and colour not in (1, 2):
        raise FileError(
            f"{path}: tiles of 64-bit samples with photometric interpretation {colour} cannot be "
            "read; allowed: 1 (black is 0) or 2 (RGB)"
        )
    cmyk = colour == 5
    if 16 < bits < 32 or cmyk:
        what = "CMYK" if cmyk else f"{bits}-bit"
        raise FileError(
            f"{path}: tiles of {what} samples cannot be read; store the picture in strips"
        )
    return bool(bits == 64)


def _precision(name: str) -> tuple[int, str]:
    """Order of sample types: channels of mixed type are all delivered as the most precise."""
    return picture_info.delivered_dtype(np.dtype(name)).itemsize, name


def _channel_type(spec: Any, band: int) -> Any:
    return spec.channelformats[band] if spec.channelformats else spec.format


def _attributes(spec: Any) -> dict[str, picture_info.FieldValue]:
    """Return the header's texts and numbers; what is no text in any encoding is left out."""
    fields: dict[str, picture_info.FieldValue] = {}
    for attribute in spec.extra_attribs:
        with contextlib.suppress(UnicodeDecodeError):
            value = attribute.value
            if isinstance(value, str | int | float):
                fields[str(attribute.name)] = value
    return fields


def _message(geterror: Callable[[], str]) -> str:
    try:
        lines = geterror().splitlines()
    except UnicodeDecodeError:  # the library quotes bytes of a damaged file
        lines = []
    # Its questions and advice, as in "… 0x0. Possible corrupt input?", help nobody here.
    told = _ADVICE.sub("", lines[0]).strip(" .") if lines else ""
    return told or "the file is damaged"


def _at_own_depth(stored: Array, *, bits: int) -> Array:
    """Undo the stretching of packed integers (12 bits, say) to the full range of 8 or 16."""
    full = 8 * stored.dtype.itemsize
    if stored.dtype.kind != "u" or not 0 < bits < full:
        return stored
    own_range, full_range = 2**bits - 1, 2**full - 1
    return np.rint(stored * np.float64(own_range / full_range))


def _spec(
    stored: NDArray[Any], metadata: Mapping[str, picture_info.MetadataValue], format_name: str
) -> Any:
    import OpenImageIO

    rows, columns, channels = stored.shape
    dtype = {numpy: name for name, numpy in _NUMPY_NAMES.items()}.get(
        stored.dtype.name, stored.dtype.name
    )
    spec = OpenImageIO.ImageSpec(columns, rows, channels, dtype)
    spec.attribute("oiio:UnassociatedAlpha", 1)  # four channels are samples, not a cut-out
    spec.attribute("DateTime", "")  # else the clock gets into the file
    if format_name in _COMPRESSION:
        spec.attribute("compression", _COMPRESSION[format_name])
    if stored.nbytes > _BIGTIFF_BYTES:
        spec.attribute("tiff:bigtiff", 1)
    if metadata:
        spec.attribute("ImageDescription", picture_info.metadata_text(metadata))
    return spec


def _complaint(messages: str) -> str:
    lines = (line.strip() for line in messages.splitlines())
    return next((line for line in lines if line and line != _FALSE_ALARM), "")


def _reads_as(file: Path, stored: NDArray[Any]) -> bool:
    """Whether the file gives back every bit: on a full disk the last flush fails unseen."""
    rows, _, channels = stored.shape
    try:
        refuse_damaged(file)
        if rows == 1 and stored.dtype == np.float64:  # which the library misreads
            bands = [read_band(file, band) for band in range(channels)]
            return np.stack(bands, axis=2).tobytes() == stored.tobytes()
        with _opened(file) as picture:
            spec = picture.spec()
            same = (spec.height, spec.width, spec.nchannels) == stored.shape
            for start in range(0, rows if same else 0, _ROWS_COMPARED):
                end = min(start + _ROWS_COMPARED, rows)
                block = picture.read_scanlines(start, end, 0, 0, channels, spec.format)
                # As bytes: a NaN is not equal to itself.
                same = same and block is not None and block.tobytes() == stored[start:end].tobytes()
            picture.geterror()  # fetched, or it is printed when the process ends
    except FileError:
        return False
    return same


@contextlib.contextmanager
def _quiet_stderr() -> Iterator[None]:
    """Silence the library, which prints what it reports too; one thread at a time."""
    with _DESCRIPTOR_LOCK, contextlib.ExitStack() as stack:
        try:
            saved = os.dup(_STDERR)
        except OSError:  # a windowed process has no stderr, so there is nothing to silence
            saved = -1
        if saved >= 0:
            stack.callback(os.close, saved)
            null = os.open(os.devnull, os.O_WRONLY)
            stack.callback(os.close, null)
            if sys.stderr is not None:
                sys.stderr.flush()
            os.dup2(null, _STDERR)
            stack.callback(os.dup2, saved, _STDERR)
        yield


def refuse_damaged(path: Path) -> None:
    """Raise `FileError` for what a checksum or an end marker of the format gives away.

    That is a PNG with a broken chunk, a FITS whose sums do not fit, a JPEG that was cut off: its
    decoder fills what is missing with grey and reports nothing.
    """
    with stored_bytes(path) as content:
        if content[:8] == _PNG_SIGNATURE:
            _check_png(content, path)
        elif content[:9] == _FITS_START:
            check_sums(read_fits_header(path))
        elif content[:3] == _JPEG_START and content.rfind(_JPEG_END) < content.rfind(_JPEG_SCAN):
            raise FileError(f"{path}: this JPEG file is truncated: its end marker is missing")


def png_bit_depth(head: bytes) -> int | None:
    """Bits of a sample of a greyscale PNG given its first bytes; None for every other file."""
    if len(head) < 26 or not head.startswith(_PNG_SIGNATURE) or head[25] not in (0, 4):
        return None
    return head[24]


def _check_png(content: StoredBytes, path: Path) -> None:
    place = len(_PNG_SIGNATURE)
    while place + 12 <= len(content):
        length, kind = content.unpack(">I4s", place)
        end = place + 12 + length
        if end > len(content):
            break
        checksum = 0
        for covered in content.pieces(place + 4, end - 4):
            checksum = zlib.crc32(covered, checksum)
        if checksum != int.from_bytes(content[end - 4 : end], "big"):
            name = kind.decode("ascii", "replace")
            raise FileError(f"{path}: this PNG file is damaged: wrong checksum in chunk {name}")
        if kind == b"IEND":
            return
        place = end
    raise FileError(f"{path}: this PNG file is truncated: its end chunk is missing")
