"""Samples that a picture file must keep to the last bit, and files of them from scratch."""

import struct
import zlib

import numpy as np

SPECIAL = [np.nan, np.inf, -np.inf, -0.0, 1e-45, 3.4e38, 0.1]
_FORMATS = {"u": 1, "i": 2, "f": 3}
_ENVI_TYPES = {"f4": 4, "f8": 5, "u2": 12}
_INTERLEAVES = {"bsq": (2, 0, 1), "bil": (0, 2, 1), "bip": (0, 1, 2)}


def samples_of(kind, rows=5, columns=7):
    """All numbers of a frame differ; whole ones reach both ends of their type."""
    values = np.arange(rows * columns).reshape(rows, columns)
    if kind[0] == "f":
        return (values / 8 - 1).astype(kind)
    info = np.iinfo(kind)
    values = values.astype(kind)
    values[0, :2] = info.min, info.max
    return values


def by_openimageio(path, samples, *, tile=None, **attributes):
    """Write a picture by the library itself, compressed and laid out as its attributes say."""
    import OpenImageIO

    samples = np.ascontiguousarray(samples if samples.ndim == 3 else samples[..., None])
    rows, columns, channels = samples.shape
    kinds = {"float16": "half", "float32": "float", "float64": "double", "uint32": "uint"}
    kind = kinds.get(samples.dtype.name, samples.dtype.name)
    spec = OpenImageIO.ImageSpec(columns, rows, channels, kind)
    if tile:
        spec.tile_width, spec.tile_height = tile
    for name, value in attributes.items():
        spec.attribute(name, value)
    output = OpenImageIO.ImageOutput.create(str(path))
    assert output.open(str(path), spec)
    assert output.write_image(samples)
    assert output.close()
    output.geterror()


def tiff(samples, *, strip_rows=0, tile=0, order="<", big=False, packed=False):
    """A TIFF, and where each of its strips or tiles lies: plain, or packed by deflate."""
    rows, columns = samples.shape
    if tile:
        down, across = -(-rows // tile), -(-columns // tile)
        padded = np.zeros((down * tile, across * tile), samples.dtype)
        padded[:rows, :columns] = samples
        parts = padded.reshape(down, tile, across, tile).swapaxes(1, 2).reshape(-1, tile, tile)
    else:
        strip_rows = strip_rows or rows
        parts = [samples[start : start + strip_rows] for start in range(0, rows, strip_rows)]
    stored = samples.dtype.newbyteorder(order)
    blocks = [np.ascontiguousarray(part, stored).tobytes() for part in parts]
    blocks = [zlib.compress(block) for block in blocks] if packed else blocks
    sizes = [len(block) for block in blocks]
    places = [(16 if big else 8) + sum(sizes[:index]) for index in range(len(blocks))]
    directory = places[-1] + sizes[-1]
    fields = [(256, [columns]), (257, [rows]), (258, [8 * samples.itemsize]), (262, [1])]
    fields += [(259, [8 if packed else 1]), (277, [1]), (339, [_FORMATS[samples.dtype.kind]])]
    if tile:
        fields += [(322, [tile]), (323, [tile]), (324, places), (325, sizes)]
    else:
        fields += [(273, places), (278, [strip_rows]), (279, sizes)]
    word, count, entry = ("Q", "Q", "HHQ8s") if big else ("I", "H", "HHI4s")
    width = struct.calcsize(word)
    beyond = directory + struct.calcsize(order + count) + len(fields) * (12 + 8 * big) + width
    entries, tail = b"", b""
    for tag, values in sorted(fields):
        content = struct.pack(f"{order}{len(values)}I", *values)
        if len(content) > width:
            content, tail = struct.pack(order + word, beyond + len(tail)), tail + content
        entries += struct.pack(order + entry, tag, 4, len(values), content.ljust(width, b"\0"))
    head = {"<": b"II", ">": b"MM"}[order]
    if big:
        head += struct.pack(order + "HHHQ", 43, 8, 0, directory)
    else:
        head += struct.pack(order + "HI", 42, directory)
    content = head + b"".join(blocks) + struct.pack(order + count, len(fields)) + entries
    return content + bytes(width) + tail, list(zip(places, sizes, strict=True))


def tiff_tag(tag, value):
    """An entry of one whole number, as it stands in the directory of a little classic TIFF."""
    return struct.pack("<HHII", tag, 4, 1, value)


def png(rows, columns, depth, packed, colour=0):
    """A PNG of lines that have been packed already, a filter's byte before each."""

    def chunk(kind, content):
        checksum = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, depth, colour, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


def fits(cards, data):
    """A FITS file of these cards, as key and value or as they stand."""
    lines = [f"{c[0]:<8}= {c[1]!s:>20}" if isinstance(c, tuple) else c for c in cards]
    text = "".join(line.ljust(80) for line in lines)
    head = (text + "END".ljust(80)).encode()
    return head + b" " * (-len(head) % 2880) + data + bytes(-len(data) % 2880)


def envi(path, cube, interleave="bip", **fields):
    """Write (rows, columns, bands) with its header beside it, as DIRSIG does; the data's path."""
    rows, columns, bands = cube.shape
    stored = cube.astype(cube.dtype.newbyteorder("<")).transpose(_INTERLEAVES[interleave])
    path.write_bytes(np.ascontiguousarray(stored).tobytes())
    fields = {
        "samples": columns, "lines": rows, "bands": bands, "byte order": 0,
        "data type": _ENVI_TYPES[cube.dtype.str[1:]], "interleave": interleave,
        **{key.replace("_", " "): value for key, value in fields.items()},
    }  # fmt: skip
    lines = [f"{key} = {value}" for key, value in fields.items()]
    path.with_name(path.name + ".hdr").write_text("\n".join(["ENVI", *lines]) + "\n")
    return path
