"""What a run delivers, in short: hashes for equal bits, and statistics that hold on any machine."""

import csv
import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from network_outputs import MTF, PICTURE, READOUTS

PARTS = ("picture", "mtf", "readouts")
# Of the largest value: rounding in another order moves it by less, a mistake by more.
TOLERANCE = {"single": 1e-5, "double": 1e-10}
DIGIT_LOST = 10.0  # read-outs are ratios and differences of a picture's values
# Read-outs that cancel, each with those of its node whose size their rounding has, or that size.
CANCELLING: dict[str, tuple[str | float, ...]] = {
    "mean": ("minimum", "maximum"),
    "mean_difference": ("max_error",),
    "error_percent": (1.0,),
    "estimated_error": (1.0,),  # of a transfer function
    # Of a spread that is symmetric one way.
    "centre_x_mrad": ("centre_y_mrad",),
    "centre_y_mrad": ("centre_x_mrad",),
}
# A picture with the phases of a star: those of components that the star has not are rounding's.
UNDETERMINED = {"second.minimum", "second.maximum"}
WARNINGS = "imagechain.warnings"  # words, no figures
BLOCKS = 4  # along each side
DIGITS = 12

Statistics = dict[str, Any]


def hashes_of(folder: Path) -> dict[str, str]:
    """SHA-256 of the final picture's samples, of the MTF table and of the read-outs' values."""
    picture = np.load(folder / PICTURE)
    figures = json.dumps(readouts_of(folder), sort_keys=True)
    contents = (picture_bytes(picture), (folder / MTF).read_bytes(), figures.encode())
    return {
        part: hashlib.sha256(content).hexdigest()
        for part, content in zip(PARTS, contents, strict=True)
    }


def statistics_of(folder: Path) -> dict[str, Statistics]:
    """The same three parts in figures that do not depend on the last bits."""
    return {
        "picture": picture_statistics(np.load(folder / PICTURE)),
        "mtf": table_statistics((folder / MTF).read_text(encoding="utf-8")),
        "readouts": {name: _short(value) for name, value in readouts_of(folder).items()},
    }


def picture_bytes(samples: np.ndarray) -> bytes:
    """Type, shape and samples of a picture."""
    return f"{samples.dtype.str} {samples.shape} ".encode() + samples.tobytes()


def readouts_of(folder: Path) -> dict[str, Any]:
    """The read-outs by ``NODE.NAME``, without the warnings."""
    nodes = json.loads((folder / READOUTS).read_text(encoding="utf-8"))
    nodes.pop(WARNINGS, None)
    return {f"{node}.{name}": value for node, values in nodes.items()
            for name, value in values.items()}  # fmt: skip


def picture_statistics(samples: np.ndarray) -> Statistics:
    """Type, shape, moments, extremes, and the means of 4 × 4 blocks, which say what lies where.

    Single samples say less: in a picture of few grey levels, rounding may move one by a level.
    """
    blocks = [
        block.mean(dtype=np.float64)
        for strip in np.array_split(samples, BLOCKS, axis=0)
        for block in np.array_split(strip, BLOCKS, axis=1)
    ]
    return {
        "type": samples.dtype.name,
        "shape": list(samples.shape),
        **_moments(samples),
        "blocks": _short(blocks),
    }


def table_statistics(text: str) -> Statistics:
    """Rows, and of each column the moments and extremes; cells may be empty."""
    names, *rows = csv.reader(text.splitlines())
    columns = zip(*rows, strict=True) if rows else ([] for _ in names)
    numbers = ([float(cell) for cell in column if cell] for column in columns)
    return {
        "rows": len(rows),
        **{name: _moments(column) for name, column in zip(names, numbers, strict=True)},
    }


def _moments(values: Iterable[float] | np.ndarray) -> dict[str, float]:
    array = np.asarray(values, dtype=np.float64)
    if not array.size:
        return {}
    mean, sigma, least, greatest = array.mean(), array.std(), array.min(), array.max()
    return {
        "mean": _short(mean),
        "sigma": _short(sigma),
        "minimum": _short(least),
        "maximum": _short(greatest),
    }


def _short(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_short(each) for each in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def differences(part: str, stored: Statistics, present: Statistics, tolerance: float) -> list[str]:
    """Where two statistics of a part differ by more than rounding can; empty where they agree.

    A number may differ by the tolerance times the largest magnitude of its picture or column, of a
    phase times a radian at least, or times its own if it is a read-out.
    """
    if stored.keys() != present.keys():
        names = sorted(stored.keys() ^ present.keys())
        return [f"{part}: only in one of both: {', '.join(names)}"]
    lines: list[str] = []
    for name, value in stored.items():
        place = f"{part} {name}"
        if part == "mtf" and isinstance(value, dict):
            if value.keys() != present[name].keys():
                lines.append(f"{place}: empty in one of both")
                continue
            # A phase of nothing but rounding is small beside a radian, not beside itself.
            scale = max(_largest(value), 1.0 if ".ptf_" in name else 0.0)
            for moment in value:
                lines += _beyond(
                    f"{place} {moment}", value[moment], present[name][moment], tolerance * scale
                )
        elif part == "readouts":
            if name not in UNDETERMINED:
                scale = DIGIT_LOST * max(_size(value), _cancelled(name, stored))
                lines += _beyond(place, value, present[name], tolerance * scale)
        else:
            lines += _beyond(place, value, present[name], tolerance * _largest(stored))
    return lines


def _beyond(place: str, stored: Any, present: Any, allowed: float) -> list[str]:
    if isinstance(stored, list) and isinstance(present, list) and len(stored) == len(present):
        pairs = enumerate(zip(stored, present, strict=True))
        return [line for at, pair in pairs for line in _beyond(f"{place}[{at}]", *pair, allowed)]
    numbers = isinstance(stored, float) and isinstance(present, float)
    alike = abs(present - stored) <= allowed if numbers else stored == present
    return [] if alike else [f"{place}: {stored!r} before, {present!r} now"]


def _largest(moments: Statistics) -> float:
    return max(_size(moments.get(name)) for name in ("minimum", "maximum"))


def _cancelled(name: str, readouts: Statistics) -> float:
    """The size that the rounding of a read-out goes by, where its own is less."""
    node, _, short = name.rpartition(".")
    sizes = (
        _size(readouts.get(f"{node}.{each}")) if isinstance(each, str) else each
        for each in CANCELLING.get(short, ())
    )
    return max(sizes, default=0.0)


def _size(value: Any) -> float:
    if isinstance(value, list):
        return max(map(_size, value), default=0.0)
    return abs(value) if isinstance(value, float) else 0.0
