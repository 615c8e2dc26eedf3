"""Values of the command line's options, read from text; a wrong one is a `UsageError`."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from core.errors import UsageError, listed
from core.records import dataclass
from nodes.files import file_format as formats

if TYPE_CHECKING:
    from core.evaluation.recipes import Region

REPORTS = (formats.JSON, formats.HTML)
TRANSFERS = (formats.CSV, formats.JSON)
OUTPUTS = (formats.CSV, formats.JSON, formats.PNG, formats.HTML)
STUDIES = (formats.CSV, formats.PARQUET, formats.NETCDF)
SUMMARIES = (formats.PNG, formats.HTML)
_LONGEST_NUMBER = 20
_BOUNDS = re.compile(r"([0-9]{0,18}):([0-9]{0,18}),([0-9]{0,18}):([0-9]{0,18})", re.ASCII)
_SIZE = re.compile(r"([0-9]{1,18}(?:\.[0-9]{1,18})?) ?([kKmMgGtT]?[bB])", re.ASCII)
_UNITS = {"b": 1.0, "kb": 1e3, "mb": 1e6, "gb": 1e9, "tb": 1e12}
_ZERO_K = {"K": 0.0, "C": 273.15}
_HOTTEST_K = 10_000.0
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", re.ASCII)


@dataclass(frozen=True)
class Assignment:
    """``NODE.NAME=TEXT``: a parameter and its value, or a port and its file."""

    node: str
    name: str
    text: str

    @property
    def port(self) -> str:
        return f"{self.node}.{self.name}"


def assignment(option: str, text: str, form: str) -> Assignment:
    left, equals, right = text.partition("=")
    node, dot, name = left.rpartition(".")
    if not (equals and dot and node and name):
        raise UsageError(f"{option} {text!r:.120} is not allowed: must be {form}")
    return Assignment(node, name, right)


@dataclass(frozen=True)
class Save(Assignment):
    """A port and the file it is saved to; `bounds` are ``TOP:BOTTOM,LEFT:RIGHT`` or nothing."""

    bounds: str = ""

    @property
    def shown(self) -> str:
        bounds = f"[{self.bounds}]" if self.bounds else ""
        return f"--save {self.port}{bounds}={self.text}"

    def region(self, rows: int, columns: int) -> Region | None:
        """The samples to save of a picture of that size; None for all of them."""
        ends = _BOUNDS.fullmatch(self.bounds)
        if ends is None:
            return None
        top, left = int(ends[1] or 0), int(ends[3] or 0)
        bottom, right = int(ends[2] or rows), int(ends[4] or columns)
        if bottom > rows or right > columns:
            raise UsageError(
                f"{self.shown}: the region exceeds the picture, which has {rows} rows and "
                f"{columns} columns"
            )
        if bottom <= top or right <= left:
            raise UsageError(
                f"{self.shown}: the region is empty: rows {top}:{bottom}, columns {left}:{right}"
            )
        from core.evaluation.recipes import Region

        return Region(top, left, bottom - top, right - left)


def save_target(text: str) -> Save:
    port, _, file = text.partition("=")
    bounds = ""
    if "[" in port.rpartition(".")[2] or port.endswith("]"):
        port, _, bounds = port.rpartition("[")
        bounds, bracket, rest = bounds.partition("]")
        if not (_BOUNDS.fullmatch(bounds) and bracket and not rest and "." in port):
            form = (
                "NODE.PORT[TOP:BOTTOM,LEFT:RIGHT]=FILE, where each bound is a whole number or "
                "left out"
            )
            raise UsageError(f"--save {text!r:.120} is not allowed: must be {form}")
        text = f"{port}={file}"
    save = assignment("--save", text, "NODE.PORT=FILE")
    from nodes.files.formats import SAVED

    ending_in(*SAVED[:-1], formats.ENVI_FRAMES, formats.ZARR, SAVED[-1])("--save", save.text)
    return Save(save.node, save.name, save.text, bounds)


def file_at_temperature(option: str, text: str) -> tuple[Path, float]:
    """``FILE=293.15K`` or ``FILE=20C``: a file, and a temperature in kelvin."""
    name, equals, words = text.rpartition("=")
    number, unit = words[:-1].removesuffix("°").strip(), words[-1:]
    if not (equals and name and unit in _ZERO_K and _NUMBER.fullmatch(number)):
        raise UsageError(
            f"{option} {text!r:.120} is not allowed: must be a file and the temperature of its "
            "black body, such as FILE=293.15K or FILE=20C"
        )
    path = file_path(option, name)
    kelvin = float(number) + _ZERO_K[unit]
    if not 0.0 < kelvin <= _HOTTEST_K:
        raise UsageError(
            f"{option} {text!r:.120}: {kelvin:.6g} K is not a possible temperature; allowed: above "
            f"0 K and up to {_HOTTEST_K:g} K"
        )
    return path, kelvin


def finite_number(option: str, text: str) -> float:
    number = float(text) if _NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(number):
        raise UsageError(f"{option} {text!r:.80} is not allowed: must be a number")
    return number


def low_high(option: str, text: str) -> tuple[float, float]:
    first, colon, last = text.partition(":")
    try:
        low, high = float(first), float(last)
    except ValueError:
        low = high = math.nan
    if not (colon and math.isfinite(low) and math.isfinite(high) and low < high):
        raise UsageError(
            f"{option}={text:.80} is not allowed: must be NODE.PARAM=LOW:HIGH, with LOW below HIGH"
        )
    return low, high


def file_path(option: str, text: str) -> Path:
    if not text or "\0" in text:
        raise UsageError(f"{option} {text!r:.120} is not allowed: must be a file name")
    return Path(text)


def ending_in(*allowed: formats.Format) -> Callable[[str, str], Path]:
    def read(option: str, text: str) -> Path:
        path = file_path(option, text)
        if not any(file_format.matches(path) for file_format in allowed):
            ends = listed(formats.suffixes(*allowed), "or")
            raise UsageError(f"{option} {text!r:.120}: the file name must end in {ends}")
        return path

    return read


report_path = ending_in(*REPORTS)
study_path = ending_in(*STUDIES)
summary_path = ending_in(*SUMMARIES)


def whole_number(option: str, text: str, largest: int | None = None) -> int:
    """A whole number; `largest` is for the message, its user checks it."""
    if not re.fullmatch(r"[+-]?[0-9]+", text, re.ASCII) or len(text) > _LONGEST_NUMBER:
        allowed = "" if largest is None else f" from 0 to {largest}"
        raise UsageError(f"{option} {text!r:.80} is not allowed: must be a whole number{allowed}")
    return int(text)


def tolerance(option: str, text: str) -> float:
    number = float(text) if _NUMBER.fullmatch(text) else math.nan
    if not 0 <= number < 1:
        raise UsageError(
            f"{option} {text!r:.80} is not allowed: must be a number of at least 0 and below 1"
        )
    return number


def size_in_bytes(option: str, text: str) -> int:
    size = _SIZE.fullmatch(text.strip())
    bytes_of = 0.0 if size is None else float(size[1]) * _UNITS[size[2].lower()]
    if not 1e3 <= bytes_of <= 1e18:
        raise UsageError(
            f"{option} {text!r:.80} is not allowed: must be a size such as 2GB or 500MB, 1kB or "
            "more"
        )
    return int(bytes_of)


def window_size(option: str, text: str) -> tuple[int, int]:
    size = re.fullmatch("([0-9]{1,5})x([0-9]{1,5})", text.lower(), re.ASCII)
    if size is None or not all(320 <= int(side) <= 16384 for side in size.groups()):
        raise UsageError(
            f"{option} {text:.80} is not allowed: must be WIDTHxHEIGHT, whole numbers from 320 to "
            "16384"
        )
    return int(size[1]), int(size[2])
