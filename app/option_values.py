"""Values of the command line's options, read from text; a wrong one is a `UsageError`."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

from core.errors import UsageError

REPORT_SUFFIXES = (".json", ".html")
SAVE_SUFFIXES = (".npy", ".exr", ".tif", ".tiff", ".png", ".csv")
_LONGEST_NUMBER = 20
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", re.ASCII)


@dataclass(frozen=True)
class Assignment:
    """``NODE.NAME=TEXT``: a parameter and its value, or a port and its file."""

    node: str
    name: str
    text: str

    @property
    def port(self) -> str:
        """``NODE.NAME``."""
        return f"{self.node}.{self.name}"


def assignment(option: str, text: str, form: str) -> Assignment:
    """The parts of ``NODE.NAME=TEXT``."""
    left, equals, right = text.partition("=")
    node, dot, name = left.rpartition(".")
    if not (equals and dot and node and name):
        raise UsageError(f"{option} {text!r:.120}: write {form}")
    return Assignment(node, name, right)


def save_target(text: str) -> Assignment:
    """A port and the file it is saved to."""
    save = assignment("--save", text, "NODE.PORT=FILE")
    _with_suffix("--save", save.text, SAVE_SUFFIXES)
    return save


def report_path(text: str) -> Path:
    """The file of a report."""
    return _with_suffix("--report", text, REPORT_SUFFIXES)


def _with_suffix(option: str, text: str, allowed: tuple[str, ...]) -> Path:
    path = file_path(option, text)
    assert path is not None
    if path.suffix.lower() not in allowed:
        raise UsageError(f"{option} {text!r:.120}: the file's name must end in {_or(allowed)}")
    return path


def file_path(option: str, text: str | None) -> Path | None:
    """A file or folder, None if not given."""
    if text is None:
        return None
    if not text or "\0" in text:
        raise UsageError(f"{option} {text!r:.120}: give a file name")
    return Path(text)


def whole_number(option: str, text: str | None, largest: int | None = None) -> int | None:
    """A whole number, None if not given; `largest` is for the message, its user checks it."""
    if text is None:
        return None
    if not re.fullmatch(r"[+-]?[0-9]+", text, re.ASCII) or len(text) > _LONGEST_NUMBER:
        allowed = "" if largest is None else f" from 0 to {largest}"
        raise UsageError(f"{option} {text!r:.80}: give a whole number{allowed}")
    return int(text)


def tolerance(text: str | None) -> float | None:
    """The error budget, None if not given."""
    if text is None:
        return None
    number = float(text) if _NUMBER.fullmatch(text) else math.nan
    if not 0 <= number < 1:
        raise UsageError(f"--tolerance {text!r:.80}: give a number from 0 to below 1")
    return number


def _or(words: tuple[str, ...]) -> str:
    return ", ".join(words[:-1]) + " or " + words[-1]
