"""ENVI headers: found beside their data, checked field by field, compared with the file's size."""

import math
import os
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError, several
from core.records import dataclass, replace
from nodes.files.picture_info import delivered_dtype
from nodes.files.stored_bytes import first_bytes, is_file, readable_file
from nodes.files.table_cells import number_of

REAL_TYPES: Mapping[str, str] = {
    "1": "u1",
    "2": "i2",
    "3": "i4",
    "4": "f4",
    "5": "f8",
    "12": "u2",
    "13": "u4",
    "14": "i8",
    "15": "u8",
}
COMPLEX_TYPES = ("6", "9")
HEADER_SUFFIX = ".hdr"  # after the data file's whole name, as DIRSIG names it
INTERLEAVES = ("bsq", "bil", "bip")
DATA_SUFFIXES = (".img", "", ".dat", ".raw", ".bin", ".bsq", ".bil", ".bip")
# What ENVI calls files of samples without a format of their own around them.
_PLAIN_TYPES = ("", "envi", "standard", "envi standard", "envi classification")
_LONGEST_HEADER = 64 << 20

Fields = Mapping[str, str | list[str]]


@dataclass(frozen=True)
class EnviLayout:
    """Where an ENVI file's samples lie: everything needed to map it, checked.

    `missing` is the sample that stands for none, of the type of `dtype`, which has the file's byte
    order; `scaling` has a gain and an offset for each band, (2, bands), or is None. Of a cube that
    is `in_memory`, there is no file.
    """

    data: Path
    header: Path
    rows: int
    columns: int
    bands: int
    dtype: np.dtype[np.generic]
    interleave: str
    offset_bytes: int
    missing: np.generic | None
    scaling: NDArray[np.float64] | None
    fields: Fields
    in_memory: NDArray[np.generic] | None = None

    @property
    def value_dtype(self) -> np.dtype[np.generic]:
        """Type of the samples as they are delivered: gains make fractions of integers."""
        dtype = self.dtype.newbyteorder("=")
        return dtype if self.scaling is None else delivered_dtype(dtype)


def is_envi_header(path: Path) -> bool:
    return first_bytes(path, 16).removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"ENVI")


def header_beside(data: Path) -> Path | None:
    """Return the ENVI header of a data file: ``x.img.hdr`` before ``x.hdr``, or None."""
    for suffix in (".hdr", ".HDR"):
        for candidate in (data.with_name(data.name + suffix), data.with_suffix(suffix)):
            if candidate != data and is_file(candidate) and is_envi_header(candidate):
                return candidate
    return None


def is_envi(path: Path) -> bool:
    if path.suffix.lower() == ".hdr":
        return is_envi_header(path)  # radiance pictures have the same suffix
    return header_beside(path) is not None


def read_layout(path: str | os.PathLike[str]) -> EnviLayout:
    """Read and check the header of an ENVI picture, by its own path or that of its data file."""
    data, header = _pair(readable_file(path))
    fields = _fields(header)
    _refuse_unsupported(fields, header)
    dtype = _dtype(fields, header)
    bands = _count(fields, "bands", header)
    layout = EnviLayout(
        data=data,
        header=header,
        rows=_count(fields, "lines", header),
        columns=_count(fields, "samples", header),
        bands=bands,
        dtype=dtype,
        interleave=_interleave(fields, header),
        offset_bytes=_count(fields, "header offset", header, low=0, default="0"),
        missing=_missing(fields, header, dtype),
        scaling=None,
        fields=fields,
    )
    _check_size(layout)  # before anything is made for each of the bands
    return replace(layout, scaling=_scaling(fields, header, bands))


def _pair(path: Path) -> tuple[Path, Path]:
    if path.suffix.lower() == ".hdr":
        return _data_of(path), path
    header = header_beside(path)
    if header is None:
        both = f"{path.name}.hdr or {path.with_suffix('.hdr').name}"
        raise FileError(f"{path}: its ENVI header is missing; expected {both} beside it")
    return path, header


def _data_of(header: Path) -> Path:
    stem = header.with_suffix("")
    names = [stem.name + suffix for suffix in DATA_SUFFIXES]
    names += [stem.name + suffix.upper() for suffix in DATA_SUFFIXES]
    if stem.suffix:  # x.img.hdr names its data in full
        names.insert(0, stem.name)
    for name in names:
        candidate = header.with_name(name)
        if is_file(candidate):
            return readable_file(candidate)
    raise FileError(f"{header}: the data file of this header is missing; expected {names[0]}")


def _fields(header: Path) -> Fields:
    """Fields by key in lower case: a text, or a list of texts where braces stand around it."""
    fields: dict[str, str] = {}
    key, value, opened = "", "", False
    for line in _text_of(header).lstrip().splitlines():
        if line.startswith(";"):
            continue
        if opened:
            value += "\n" + line.strip()
        else:
            name, equals, value = line.partition("=")
            if not equals:
                continue
            key, value = " ".join(name.lower().split()), value.strip()
        opened = value.startswith("{") and not value.endswith("}")
        if not opened and fields.setdefault(key, value) != value:
            raise FileError(
                f"{header}: {key:.60} is given twice, as {fields[key]:.60} and as {value:.60}; "
                "allowed: once"
            )
    if opened:
        raise FileError(f"{header}: the brace opened after {key!r:.60} is never closed")
    return {key: _parsed(key, value) for key, value in fields.items()}


def _text_of(header: Path) -> str:
    size = header.stat().st_size
    if size > _LONGEST_HEADER:
        raise FileError(
            f"{header}: {size} bytes; an ENVI header may have at most {_LONGEST_HEADER} bytes"
        )
    raw = first_bytes(header, size)
    if not raw.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"ENVI") or b"\0" in raw:
        raise FileError(f"{header}: not an ENVI header; its first line must be ENVI")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _parsed(key: str, value: str) -> str | list[str]:
    if not value.startswith("{"):
        return value
    if key == "description":
        return value.strip("{}").strip()
    return [item.strip() for item in value[1:-1].split(",")]


def _refuse_unsupported(fields: Fields, header: Path) -> None:
    compression = fields.get("file compression", "0")
    if compression != "0":
        raise FileError(f"{header}: file compression = {compression!s:.60}; allowed: 0 (none)")
    kind = fields.get("file type", "")
    if " ".join(str(kind).lower().split()) not in _PLAIN_TYPES:
        raise FileError(
            f"{header}: file type = {kind!s:.60}; allowed: ENVI Standard or ENVI "
            "Classification, with plain samples; for a picture in another format, give the "
            "picture's name instead of its header"
        )
    for key in ("major frame offsets", "minor frame offsets"):
        offsets = fields.get(key, "0")
        if any(
            item.strip() != "0" for item in ([offsets] if isinstance(offsets, str) else offsets)
        ):
            raise FileError(f"{header}: {key} = {offsets!s:.60}; allowed: 0")


def _text(fields: Fields, key: str, header: Path, allowed: str, default: str | None = None) -> str:
    value = fields.get(key, default)
    if value is None or value == "":
        raise FileError(f"{header}: the field {key!r} is missing; allowed: {allowed}")
    if isinstance(value, list):
        raise FileError(f"{header}: {key} = {value!s:.60} is a list; allowed: {allowed}")
    return value


def _count(fields: Fields, key: str, header: Path, low: int = 1, default: str | None = None) -> int:
    allowed = f"a whole number of {low} or more"
    text = _text(fields, key, header, allowed, default)
    # isdecimal accepts other scripts' digits and int underscores: neither is in the format.
    value = int(text) if text.isascii() and text.isdecimal() and len(text) < 19 else -1
    if value < low:
        raise FileError(f"{header}: {key} = {text:.60}; allowed: {allowed}")
    return value


def _dtype(fields: Fields, header: Path) -> np.dtype[np.generic]:
    allowed = ", ".join(REAL_TYPES)
    code = _text(fields, "data type", header, allowed)
    if code in COMPLEX_TYPES:
        raise FileError(f"{header}: data type = {code:.60} is complex; allowed (real): {allowed}")
    if code not in REAL_TYPES:
        raise FileError(f"{header}: data type = {code:.60}; allowed: {allowed}")
    dtype: np.dtype[np.generic] = np.dtype(REAL_TYPES[code])
    # One byte has no order; for more a guess could turn a picture into noise.
    default = "0" if dtype.itemsize == 1 else None
    order = _text(fields, "byte order", header, "0 (little endian) or 1 (big endian)", default)
    if order not in ("0", "1"):
        raise FileError(
            f"{header}: byte order = {order:.60}; allowed: 0 (little endian) or 1 (big endian)"
        )
    return dtype.newbyteorder("<" if order == "0" else ">")


def _missing(fields: Fields, header: Path, dtype: np.dtype[np.generic]) -> np.generic | None:
    """What ``data ignore value`` is as a sample; None without one, or where no sample can be it."""
    if not fields.get("data ignore value"):
        return None
    text = _text(fields, "data ignore value", header, "a number")
    try:
        value: int | float = float(text)
    except ValueError as error:
        raise FileError(f"{header}: data ignore value = {text:.60}; allowed: a number") from error
    if dtype.kind == "f":
        with np.errstate(over="ignore"):
            return dtype.type(value)
    # Exactly: a double has not every integer of 64 bits.
    value = int(text) if re.fullmatch(r"[-+]?[0-9]{1,20}", text) else value
    limits = np.iinfo(dtype.name)
    held = math.isfinite(value) and value == int(value) and limits.min <= value <= limits.max
    return dtype.type(int(value)) if held else None


def _scaling(fields: Fields, header: Path, bands: int) -> NDArray[np.float64] | None:
    rows = []
    for key, neutral in (("data gain values", 1.0), ("data offset values", 0.0)):
        row = number_list(fields, key, header, bands)
        row = (neutral,) if row is None else row
        rows.append(np.broadcast_to(np.array(row), bands))
    scaling = np.stack(rows)
    return None if np.all(scaling == [[1.0], [0.0]]) else scaling


def number_list(fields: Fields, key: str, header: Path, bands: int) -> tuple[float, ...] | None:
    """The finite numbers of a field, one for each band or one for all; None without the field."""
    texts = fields.get(key, ())
    texts = [text for text in ([texts] if isinstance(texts, str) else texts) if text]
    if not texts:
        return None
    if len(texts) not in (1, bands):
        raise FileError(
            f"{header}: {key} has {several(len(texts), 'value')} for {several(bands, 'band')}; "
            "allowed: one value per band"
        )
    try:
        values = tuple(number_of(text) for text in texts)
    except ValueError as error:
        raise FileError(f"{header}: {key} contains a value that is not a number") from error
    if not all(map(math.isfinite, values)):
        raise FileError(f"{header}: {key} contains a number that is not finite")
    return values


def _interleave(fields: Fields, header: Path) -> str:
    allowed = ", ".join(INTERLEAVES)
    text = _text(fields, "interleave", header, allowed)
    if text.lower() not in INTERLEAVES:
        raise FileError(f"{header}: interleave = {text:.60}; allowed: {allowed}")
    return text.lower()


def _check_size(layout: EnviLayout) -> None:
    size_bytes = layout.data.stat().st_size
    size = layout.dtype.itemsize
    terms = (layout.rows, layout.columns, layout.bands, size)
    expected = layout.offset_bytes + math.prod(terms)
    if size_bytes == expected:
        return
    difference = size_bytes - expected
    verdict = f"{-difference} missing" if difference < 0 else f"{difference} too many"
    fits = _what_would_fit(layout, size_bytes)
    hint = f"; the size would fit with {' or '.join(fits)}" if fits else ""
    cause = "; the file is truncated or one of these values is wrong" if difference < 0 else ""
    raise FileError(
        f"{layout.data}: contains {size_bytes} bytes, but {layout.header.name} gives header offset "
        f"{layout.offset_bytes} + lines {layout.rows} × samples {layout.columns} × bands "
        f"{layout.bands} × {several(size, 'byte')} = {expected} ({verdict}){cause}{hint}"
    )


def _what_would_fit(layout: EnviLayout, size_bytes: int) -> list[str]:
    """Each single term of the header that, changed, makes the size right."""
    samples = size_bytes - layout.offset_bytes
    size = layout.dtype.itemsize
    per_item = layout.rows * layout.columns * layout.bands
    fits = []
    for key, term in (("bands", layout.bands), ("lines", layout.rows), ("samples", layout.columns)):
        others = per_item // term * size
        if samples > 0 and samples % others == 0:
            fits.append(f"{key} = {samples // others}")
    if samples > 0 and samples % per_item == 0 and samples // per_item in (1, 2, 4, 8):
        fits.append(f"a data type of {several(samples // per_item, 'byte')}")
    if size_bytes >= per_item * size:
        fits.append(f"header offset = {size_bytes - per_item * size}")
    return fits
