"""What is known of a picture before its samples are read, and whether it fits the machine."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import FileError
from core.machine import usable_bytes
from core.records import dataclass

MetadataValue = str | int | float
Samples = NDArray[np.floating[Any]]  # float32 or float64, (rows, columns), C order


@dataclass(frozen=True)
class PictureInfo:
    """Size, kind and header of a picture file; what it does not give is None."""

    path: Path  # of the samples: for ENVI of the data file, not the header
    rows: int
    columns: int
    bands: int  # channels of a colour picture, or spectral bands
    dtype: str  # numpy's name of the stored samples
    kind: str  # ``envi``, ``npy``, ``text``, ``zarr`` or the picture format (``tiff``, …)
    unit: str | None = None  # as the file words it
    wavelengths_um: tuple[float, ...] | None = None  # centre of every band
    fwhm_um: tuple[float, ...] | None = None  # full width at half maximum of every band
    focal_length_mm: float | None = None
    fov_x_deg: float | None = None  # of the whole frame
    fov_y_deg: float | None = None
    channels: tuple[str, ...] = ()  # names; empty where there is one, or bands are spectral
    not_applied: tuple[str, ...] = ()  # fields of the header that would change the samples
    # every band's share in the sum of all, where that is not what its width makes it
    shares_um: tuple[float, ...] | None = None
    wavelengths_assumed: bool = False  # to be in µm, as the file names no unit of them
    lossy: bool = False  # the compression leaves out what the eye would not miss
    absent_chunks: int = 0  # files of a Zarr store that are not there
    bad_bands: tuple[int, ...] = ()  # by the header, counted from 0; sums leave them out

    @property
    def rgb(self) -> tuple[int, ...]:
        """Places of the channels red, green and blue; empty without them."""
        names = [name.upper() for name in self.channels]
        return tuple(map(names.index, "RGB")) if {"R", "G", "B"} <= set(names) else ()


def delivered_dtype(stored: np.dtype[Any]) -> np.dtype[Any]:
    """Return the precision samples are delivered in.

    Double for doubles and integers of 32 or more bits, which single precision would round; those of
    64 bits beyond 2⁵³ are rounded all the same.
    """
    if stored.kind == "f":
        return np.dtype(np.float64 if stored.itemsize > 4 else np.float32)
    return np.dtype(np.float64 if stored.itemsize >= 4 else np.float32)


def refuse_unreal(path: Path, dtype: np.dtype[Any]) -> None:
    if dtype.kind not in "buif":
        raise FileError(f"{path}: contains samples of type {dtype}; allowed: real numbers")


def refuse_shape(
    path: Path, shape: tuple[int, ...], allowed: str = "(rows, columns) or (rows, columns, bands)"
) -> None:
    if len(shape) not in (2, 3) or 0 in shape:
        raise FileError(
            f"{path}: contains an array of shape {shape}; allowed: {allowed}, all above 0"
        )


def metadata_text(metadata: Mapping[str, object]) -> str:
    """``key = value``, one on a line, as `nodes.files.picture_info` reads it."""
    return "\n".join(f"{key} = {' '.join(str(value).split())}" for key, value in metadata.items())


# Pictures that do not fit: refused by what their header claims, before memory is allocated.

# A picture and one copy of it, which every step needs, fit the machine.
_SHARE = 0.5
_LONGEST_TEXT = 1 << 29
# The most that a byte can become, by compression: of deflate 258 bytes for 2 bits, of PackBits 128
# for 2 bytes, of LZW 4096 for 12 bits. Others have no such bound.
_DEFLATE = 1032
_MOST_BYTES: Mapping[str, float] = {
    "none": 1.0,
    "zip": _DEFLATE,
    "zips": _DEFLATE,
    "packbits": 64.0,
    "lzw": 4096 / 1.5,
}


def refuse_oversized(info: PictureInfo) -> None:
    """Refuse a picture one band of which takes more than half of the memory the process may use."""
    dtype = delivered_dtype(np.dtype(info.dtype))
    if reason := oversized(info.rows, info.columns, dtype):
        raise FileError(f"{info.path}: {reason}")


def oversized(rows: int, columns: int, dtype: np.dtype[Any]) -> str:
    """Why a picture does not fit, with what it needs and what is allowed; empty where it does."""
    needed = rows * columns * dtype.itemsize
    return _beyond(needed, f"{rows} × {columns} samples need {_gb(needed)}")


def oversized_file(length: int) -> str:
    return _beyond(length, f"a file of {_gb(length)} is too large")


def _beyond(needed: int, what: str) -> str:
    most = _SHARE * (usable_bytes() or 0)
    if not most or needed <= most:
        return ""
    return (
        f"{what}; the limit on this machine is {_gb(most)}, half of the memory this process may use"
    )


def refuse_oversized_text(path: Path) -> None:
    """Refuse a text over 512 MB, or a quarter of the memory: it is held twice, for minutes."""
    length, memory = path.stat().st_size, usable_bytes()
    most = min(_LONGEST_TEXT, _SHARE * memory / 2) if memory else _LONGEST_TEXT
    if length > most:
        raise FileError(
            f"{path}: a text file of {_gb(length)} is too large; the limit is {_gb(most)}: store "
            "the samples as .npy"
        )


def refuse_impossible(info: PictureInfo, *, compression: str, bits: int) -> None:
    """Refuse more samples than the file can unpack to; a compression without a bound passes."""
    most = _DEFLATE if info.kind == "png" else _MOST_BYTES.get(compression)
    if most is None:
        return
    length = info.path.stat().st_size
    claimed = info.rows * info.columns * info.bands * bits / 8
    if claimed > most * length:
        raise FileError(
            f"{info.path}: damaged: {info.rows} × {info.columns} × {info.bands} samples of {bits} "
            f"bits do not fit in a file of {length} bytes"
        )


def _gb(size: float) -> str:
    return f"{size / 1e9:.3g} GB"


# Unit, focal length and field of view as headers of different origin word them, or a description in
# which ``key = value`` stands one on a line or between commas or semicolons. Keys are compared
# without regard to case, underscores as spaces (BUNIT, FOCALLEN: FITS; nominalFocalLength: EXR).
# Lengths are in mm, angles in degrees unless a unit follows; ``fov = {x, y}`` gives both;
# a zero means absent.

_UNIT_KEYS = ("data units", "radiance units", "units", "unit", "bunit")
_LENGTHS_MM = {"": 1.0, "mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 1e-3, "µm": 1e-3, "μm": 1e-3}
_ANGLES_DEG = {
    "": 1.0,
    "deg": 1.0,
    "degree": 1.0,
    "degrees": 1.0,
    "°": 1.0,
    "rad": math.degrees(1.0),
    "mrad": math.degrees(1e-3),
}
_QUANTITY = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s]*)")
# The factors of its units and its keys, then those of which it is the second of two.
_QUANTITIES: Mapping[str, tuple[Mapping[str, float], *tuple[tuple[str, ...], ...]]] = {
    "focal_length_mm": (
        _LENGTHS_MM,
        ("focal length mm", "focal length", "focallen", "exif:focallength", "nominalfocallength"),
    ),
    "fov_x_deg": (
        _ANGLES_DEG,
        ("fov x deg", "fov x", "field of view x", "horizontal fov", "hfov", "fov", "field of view"),
    ),
    "fov_y_deg": (
        _ANGLES_DEG,
        ("fov y deg", "fov y", "field of view y", "vertical fov", "vfov"),
        ("fov", "field of view"),
    ),
}

FieldValue = str | int | float | Sequence[str]


def header_fields(
    fields: Mapping[str, FieldValue], *, description: str = "", where: str
) -> dict[str, Any]:
    """Read what a `PictureInfo` has of all headers, from the keys, then from the description.

    What neither has is None. A key whose value is no length or no angle is refused; in the
    description it is prose. `where` names the file in messages.
    """
    own = {_normal(key): _texts(value) for key, value in fields.items()}
    described = _in_description(description)
    values: dict[str, Any] = {"unit": _unit(own) or _unit(described)}
    for name, kind in _QUANTITIES.items():
        values[name] = _quantity_of(own, where, *kind) or _quantity_of(described, "", *kind)
    return values


_Texts = Mapping[str, Sequence[str]]


def _normal(key: str) -> str:
    return " ".join(key.lower().replace("_", " ").split())


def _texts(value: FieldValue) -> list[str]:
    if isinstance(value, str | int | float):
        return [str(value).strip()]
    return [str(item).strip() for item in value]


def _in_description(description: str) -> dict[str, list[str]]:
    pairs = re.findall(r"([^=:\n;,]+)[=:]([^\n;,]+)", description)
    return {_normal(key): [value.strip()] for key, value in pairs}


def _unit(fields: _Texts) -> str | None:
    for key in _UNIT_KEYS:
        text = ", ".join(fields.get(key, ()))
        if text and text.lower() not in ("unknown", "none"):
            return text
    return None


def _quantity_of(
    fields: _Texts, where: str, factors: Mapping[str, float], *keys: Sequence[str]
) -> float | None:
    """Of prose, without a file in `where`, a pair that is no quantity is no fault."""
    for place, key in ((place, key) for place, names in enumerate(keys) for key in names):
        text = next(iter(fields.get(key, ())[place:]), "")
        try:
            if text and (value := _quantity(text, factors, key, where)):
                return value
        except FileError:
            if where:
                raise
            return None
    return None


def _quantity(text: str, factors: Mapping[str, float], key: str, where: str) -> float:
    match = _QUANTITY.fullmatch(text)
    factor = factors.get(match[2].lower()) if match else None
    value = float(match[1]) * factor if match and factor else math.nan
    if not math.isfinite(value) or value < 0:
        units = ", ".join(unit for unit in factors if unit.isascii() and unit)
        raise FileError(f"{where}: {key} = {text!r:.60} is not a positive number (units: {units})")
    if factors is _ANGLES_DEG and value >= 180:
        raise FileError(f"{where}: field of view {value:g} deg; allowed: above 0 and below 180 deg")
    return value
