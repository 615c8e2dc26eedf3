"""Small picture files of every kind, with what their formats guard by a checksum."""

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from picture_samples import by_openimageio

Array = NDArray[Any]
Span = tuple[int, int]


@dataclass(frozen=True)
class Made:
    """A whole file, what it holds, and the spans of bytes that a checksum of its format covers."""

    kind: str
    suffix: str
    content: bytes
    truth: Array
    guarded: tuple[Span, ...] = ()
    beside: dict[str, bytes] = field(default_factory=dict)
    store: str = ""  # the folder that is read, where the file is one of many in it


def tiff(folder: Path, rng: np.random.Generator) -> Made:
    """Compression, layout, sample type, predictor and size of directory by chance."""
    compression = str(rng.choice(["zip", "lzw", "packbits", "none"], p=[0.55, 0.2, 0.15, 0.1]))
    dtype = str(rng.choice(["uint8", "uint16", "int16", "uint32", "float", "double"]))
    options: dict[str, Any] = {"compression": compression}
    if compression in ("zip", "lzw"):
        options["tiff:predictor"] = int(rng.choice([1, 3 if dtype in ("float", "double") else 2]))
    if rng.random() < 0.25:
        options["tiff:bigtiff"] = 1
    channels = int(rng.choice([1, 1, 1, 3]))
    if channels > 1 and rng.random() < 0.5:
        options["planarconfig"] = "separate"
    tile = 0
    if rng.random() < 0.4:
        tile = 16
        if dtype == "double" and compression not in ("zip", "none"):
            dtype = "float"
    else:
        options["tiff:RowsPerStrip"] = int(rng.choice([1, 7, 16, 64]))
    truth = _samples(rng, dtype, channels)
    content = _by_library(folder, "a.tif", truth, options, tile)
    guarded = tuple(_tiff_blocks(content)) if compression == "zip" else ()
    layout = "tiles" if tile else "strips"
    return Made(f"tiff {compression} {layout}", ".tif", content, truth[:, :, 0], guarded)


def png(folder: Path, rng: np.random.Generator) -> Made:
    """Everything behind the signature is covered by the checksums of the chunks."""
    dtype = str(rng.choice(["uint8", "uint16"]))
    truth = _samples(rng, dtype, int(rng.choice([1, 1, 3, 4])))
    content = _by_library(folder, "a.png", truth, {}, 0)
    return Made("png", ".png", content, truth[:, :, 0], ((8, len(content)),))


def exr(folder: Path, rng: np.random.Generator) -> Made:
    """Chunks that zip made shorter end in a checksum; the others have none."""
    compression = str(
        rng.choice(["zip", "zips", "rle", "piz", "none"], p=[0.4, 0.3, 0.1, 0.1, 0.1])
    )
    dtype = str(rng.choice(["half", "float"]))
    truth = _samples(rng, dtype, int(rng.choice([1, 3])))
    tile = 16 if rng.random() < 0.3 else 0
    content = _by_library(folder, "a.exr", truth, {"compression": compression}, tile)
    guarded = tuple(_zlib_streams(content)) if compression.startswith("zip") else ()
    return Made(f"exr {compression}", ".exr", content, truth[:, :, 0], guarded)


def fits(folder: Path, rng: np.random.Generator) -> Made:
    """Cards of every kind that changes samples, some files with DATASUM and CHECKSUM."""
    bits, kind = [(8, "u1"), (16, "i2"), (32, "i4"), (-32, "f4"), (-64, "f8")][rng.integers(5)]
    rows, columns = rng.integers(5, 40, 2)
    stored = (rng.normal(size=(rows, columns)) * 40 + 100).astype(kind)
    zero, scale = float(rng.integers(-5, 5) * 2.5), float(rng.integers(1, 5) / 4)
    cards = {"SIMPLE": "T", "BITPIX": bits, "NAXIS": 2, "NAXIS1": columns, "NAXIS2": rows}
    cards |= {"BZERO": f"{zero}D0", "BSCALE": f"{scale}E0", "FOCALLEN": 100.0}
    data = stored.astype(stored.dtype.newbyteorder(">")).tobytes()
    data += bytes(-len(data) % 2880)
    summed = bool(rng.random() < 0.5)
    if summed:
        cards["DATASUM"] = f"'{ones_sum(data)}'"
    text = "".join(f"{key:<8}= {value!s:>20}".ljust(80) for key, value in cards.items())
    head = (text + "END".ljust(80)).encode()
    head += b" " * (-len(head) % 2880)
    truth = stored[::-1].astype(np.float64) * scale + zero
    guarded = ((len(head), len(head) + len(data)),) if summed else ()
    return Made("fits datasum" if summed else "fits", ".fits", head + data, truth, guarded)


def ones_sum(data: bytes) -> int:
    """Sum of 32-bit words in ones' complement: Pence and others, 2012, FITS checksum."""
    total = int(np.frombuffer(data, ">u4").sum(dtype=np.uint64))
    while total >> 32:
        total = (total & 0xFFFFFFFF) + (total >> 32)
    return total


def envi(folder: Path, rng: np.random.Generator) -> Made:
    """A cube and its header; neither has a checksum."""
    rows, columns, bands = (int(size) for size in rng.integers(2, 12, 3))
    cube = rng.normal(size=(rows, columns, bands)).astype("<f4")
    header = (
        f"ENVI\nsamples = {columns}\nlines = {rows}\nbands = {bands}\nheader offset = 0\n"
        "file type = ENVI Standard\ndata type = 4\ninterleave = bip\nbyte order = 0\n"
        "data ignore value = -9999\ndata units = W/m^2/sr/um\nwavelength units = um\n"
        f"wavelength = {{{', '.join(str(8 + 0.25 * band) for band in range(bands))}}}\n"
    )
    beside = {".img.hdr": header.encode()}
    return Made("envi", ".img", cube.tobytes(), cube[:, :, 0].astype(np.float64), (), beside)


def npy(folder: Path, rng: np.random.Generator) -> Made:
    """No checksum."""
    truth = rng.normal(size=rng.integers(2, 40, 2)).astype(str(rng.choice(["f4", "f8"])))
    path = folder / "a.npy"
    np.save(path, truth)
    return Made("npy", ".npy", path.read_bytes(), truth)


def zarr(folder: Path, rng: np.random.Generator) -> Made:
    """A chunk of a store, with its description and the other chunks beside it; no checksum."""
    import numcodecs
    import zarr as library

    truth = _samples(rng, str(rng.choice(["uint8", "int16", "float", "double"])), 1)[:, :, 0]
    version, how = int(rng.choice([2, 3])), {}
    if version == 2:
        choices = (None, numcodecs.GZip(), numcodecs.Zlib(), numcodecs.Blosc(), numcodecs.LZ4())
    else:
        codecs = library.codecs
        choices = (None, codecs.GzipCodec(), codecs.BloscCodec(), codecs.ZstdCodec())
        if rng.random() < 0.3:
            how["shards"] = (32, 32)
    place = folder / "made.zarr"
    packing = int(rng.integers(len(choices)))
    array = library.create_array(
        place, shape=truth.shape, chunks=(16, 16), dtype=truth.dtype, zarr_format=version,
        compressors=choices[packing], overwrite=True, **how,
    )  # fmt: skip
    array[...] = truth
    files = {
        f".zarr/{file.relative_to(place)}": file.read_bytes()
        for file in sorted(place.rglob("*"), key=lambda file: file.name not in _STORE_TEXTS)
        if file.is_file()
    }
    chosen = str(rng.choice([name for name in files if Path(name).name not in _STORE_TEXTS]))
    content = files.pop(chosen)
    return Made(f"zarr {version}", chosen, content, truth, (), files, ".zarr")


_STORE_TEXTS = ("zarr.json", ".zarray")
KINDS: dict[str, tuple[float, Callable[[Path, np.random.Generator], Made]]] = {
    "tiff": (0.5, tiff),
    "png": (0.1, png),
    "exr": (0.15, exr),
    "fits": (0.1, fits),
    "envi": (0.1, envi),
    "npy": (0.05, npy),
    "zarr": (0.1, zarr),
}


def _samples(rng: np.random.Generator, dtype: str, channels: int) -> Array:
    rows, columns = rng.integers(20, 70, 2)
    y, x = np.mgrid[:rows, :columns]
    smooth = 0.5 + 0.3 * np.sin(x / 7.0) * np.cos(y / 5.0) + 0.05 * rng.random((rows, columns))
    planes = np.stack([np.roll(smooth, 3 * plane, axis=0) for plane in range(channels)], axis=2)
    numpy_type = np.dtype({"half": "f2", "float": "f4", "double": "f8"}.get(dtype, dtype))
    if numpy_type.kind == "f":
        return planes.astype(numpy_type)
    return (planes * min(np.iinfo(numpy_type).max, 60000)).astype(numpy_type)


def _by_library(folder: Path, name: str, truth: Array, options: dict[str, Any], tile: int) -> bytes:
    options = {**options, "oiio:UnassociatedAlpha": 1}
    by_openimageio(folder / name, truth, tile=(tile, tile) if tile else None, **options)
    return (folder / name).read_bytes()


def _tiff_blocks(content: bytes) -> list[Span]:
    """Places of strips or tiles in a little-endian TIFF file."""
    big = content[2] == 43
    (place,) = struct.unpack_from("<Q" if big else "<I", content, 8 if big else 4)
    (count,) = struct.unpack_from("<Q" if big else "<H", content, place)
    place += 8 if big else 2
    found: dict[int, tuple[int, ...]] = {}
    for _ in range(count):
        tag, kind, number = struct.unpack_from("<HHQ" if big else "<HHI", content, place)
        letter = {3: "H", 4: "I", 16: "Q"}.get(kind)
        inside = place + (12 if big else 8)
        if letter is not None and tag in (273, 279, 324, 325):
            if number * struct.calcsize(letter) > (8 if big else 4):
                (inside,) = struct.unpack_from("<Q" if big else "<I", content, inside)
            found[tag] = struct.unpack_from(f"<{number}{letter}", content, inside)
        place += 20 if big else 12
    starts, sizes = found.get(273) or found[324], found.get(279) or found[325]
    return [(start, start + size) for start, size in zip(starts, sizes, strict=True)]


def _zlib_streams(content: bytes) -> list[Span]:
    """Spans that are whole zlib streams, by trying every place that can begin one."""
    spans, place = [], 0
    while place + 6 < len(content):
        if content[place] == 0x78 and int.from_bytes(content[place : place + 2], "big") % 31 == 0:
            stream = zlib.decompressobj()
            try:
                stream.decompress(content[place:])
            except zlib.error:
                pass
            else:
                if stream.eof:
                    end = len(content) - len(stream.unused_data)
                    if end - place > 20:
                        spans.append((place, end))
                        place = end
                        continue
        place += 1
    return spans
