"""The files of ``--save NODE.PORT=PATTERN``: a name for each point of a study."""

from __future__ import annotations

import os
import re
import string
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.options.option_values import Save
from app.study.study_axes import Axis
from app.study.study_points import Point
from core.errors import UsageError
from core.names import close, shown

POINT, SCENE = "point", "scene"


@dataclass(frozen=True)
class SavePattern:
    """A port, and the names of the files that it is saved to.

    Parameters
    ----------
    save : Save
        As it was given; its text is the pattern.
    parts : tuple of (text, field, form)
        What stands before each field, the field, and how its value is written.
    """

    save: Save
    parts: tuple[tuple[str, str, str], ...]

    def name(self, values: dict[str, Any]) -> str:
        """The file of a point."""
        words = []
        for text, name, form in self.parts:
            words.append(text)
            if name:
                words.append(self._word(name, form, values[name]))
        return "".join(words)

    def _word(self, name: str, form: str, value: Any) -> str:
        try:
            word = format(value, form) if form else _plain_word(value)
        except (ValueError, TypeError) as error:
            raise UsageError(f"{self.save.shown}: {{{name}:{form}}}: {error}") from error
        if not word or word in (".", "..") or any(c in word for c in ("/", "\\", "\0")):
            raise UsageError(f"{self.save.shown}: {name} = {shown(word)} is no part of a file name")
        return word


def save_pattern(save: Save, axes: Sequence[Axis]) -> SavePattern:
    """Read the fields of a pattern.

    Raises
    ------
    UsageError
        If it has other fields than the study, or cannot be read.
    """
    known = field_names(axes)
    parts = []
    try:
        for text, name, form, conversion in string.Formatter().parse(save.text):
            if name is not None and (conversion or "{" in (form or "")):
                raise ValueError("only a format of numbers may follow a field's name")
            if name is not None and re.search("[0-9]{4}", form or ""):
                raise ValueError(f"{{{name}:{form:.20}}}: at most 999 characters or digits")
            if name is not None and name not in known:
                hint = close(name, known) or f"; there are {', '.join(known)}"
                raise UsageError(f"{save.shown}: the study has no field {shown(name)}{hint}")
            parts.append((text, name or "", form or ""))
    except ValueError as error:
        raise UsageError(f"{save.shown}: {error}") from error
    return SavePattern(save, tuple(parts))


def field_names(axes: Sequence[Axis]) -> list[str]:
    """What a pattern may name: the point's number, what is varied, and the picture."""
    files = [axis for axis in axes if axis.is_files]
    names = [
        POINT,
        *(axis.label for axis in axes),
        *(axis.label.rpartition(".")[0] for axis in files),
    ]
    return list(dict.fromkeys([*names, *([SCENE] if len(files) == 1 else [])]))


def file_names(
    patterns: Sequence[SavePattern], axes: Sequence[Axis], points: Sequence[Point]
) -> list[tuple[str, ...]]:
    """The files of each point, one for each pattern, from the current folder on.

    Raises
    ------
    UsageError
        If two would be one file.
    """
    digits = len(str(len(points)))
    taken: dict[str, int] = {}
    names = []
    for number, point in enumerate(points, 1):
        values = _fields(axes, point, f"{number:0{digits}d}", number)
        row = tuple(os.path.abspath(pattern.name(values)) for pattern in patterns)  # noqa: PTH100
        for pattern, name in zip(patterns, row, strict=True):
            if name in taken:
                other = taken[name]
                whose = f"points {other} and {number}" if other != number else f"point {number}"
                raise UsageError(
                    f"{pattern.save.shown}: two files of {whose} would be {shown(name)}; "
                    f"name more of {', '.join('{' + name + '}' for name in field_names(axes))}"
                )
            taken[name] = number
        names.append(row)
    return names


def folders(names: Iterable[tuple[str, ...]]) -> list[Path]:
    """The folders that the files are in, each once."""
    return list(dict.fromkeys(Path(name).parent for row in names for name in row))


class _Number(int):
    """A point's number: with leading zeros where the pattern does not say how."""

    padded: str

    def __str__(self) -> str:
        return self.padded


def _fields(axes: Sequence[Axis], point: Point, padded: str, number: int) -> dict[str, Any]:
    index = _Number(number)
    index.padded = padded
    fields: dict[str, Any] = {}
    for axis, value in zip(axes, point, strict=True):
        if axis.is_files:
            stem = Path(value).stem
            fields |= {SCENE: stem, axis.label.rpartition(".")[0]: stem, axis.label: stem}
    for axis, value in zip(axes, point, strict=True):
        if not axis.is_files:
            fields[axis.label] = value
    return {**fields, POINT: index}


def _plain_word(value: Any) -> str:
    if value is None:
        return "empty"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    return str(value)
