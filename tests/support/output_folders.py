"""Folders with all that the networks deliver at full size, and the first difference of two."""

import csv
import hashlib
import json
import re
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from network_outputs import PRECISIONS, run_network, run_with_reports
from output_statistics import picture_bytes, picture_statistics

PLAIN, REPORTED = "plain", "reported"  # a run without reports lets go of values early
PICTURES = "pictures.json"
_RUN_LINE = re.compile(r'<p class="?run"?>.*?</p>', re.DOTALL)  # versions, in the report for people
_SHOWN = 60


def write_outputs(path: Path, folder: Path, *, precisions: Sequence[str] = PRECISIONS) -> None:
    """Run a network in both precisions, without and with reports.

    Of its pictures the final one is there in full, the others by hash and statistics.
    """
    for precision in precisions:
        run_network(path, folder / precision / PLAIN, precision=precision)
        reported = folder / precision / REPORTED
        pictures = run_with_reports(path, reported, precision=precision)
        facts = {
            port: {
                **picture_statistics(samples),
                "sha256": hashlib.sha256(picture_bytes(samples)).hexdigest(),
            }
            for port, samples in pictures.items()
        }
        text = json.dumps(facts, indent=1)
        (reported / PICTURES).write_text(text, encoding="utf-8")


def first_difference(before: Path, after: Path) -> str | None:
    """What differs first between the files of two folders; None where all are equal.

    Not compared are the versions of the program and its libraries, in reports.
    """
    names = [_names(folder) for folder in (before, after)]
    if names[0] != names[1]:
        return f"only in one of both: {', '.join(sorted(names[0] ^ names[1]))}"
    for name in sorted(names[0]):
        difference = _file_difference(before / name, after / name)
        if difference:
            return f"{name}: {difference}"
    return None


def _names(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def _file_difference(before: Path, after: Path) -> str | None:
    if before.read_bytes() == after.read_bytes():
        return None
    kinds = {".npy": _samples, ".csv": _cells, ".json": _values, ".html": _text}
    return kinds.get(before.suffix, _bytes)(before, after)


def _bytes(before: Path, after: Path) -> str:
    return f"{before.stat().st_size} and {after.stat().st_size} other bytes"


def _samples(before: Path, after: Path) -> str:
    a, b = np.load(before), np.load(after)
    if (a.dtype, a.shape) != (b.dtype, b.shape):
        return f"{a.dtype} {a.shape} before, {b.dtype} {b.shape} now"
    unequal = a.view(f"u{a.itemsize}") != b.view(f"u{b.itemsize}")
    if not unequal.any():
        return "other bytes outside the samples"
    place = tuple(map(int, np.argwhere(unequal)[0]))
    largest = np.abs(b.astype(float) - a.astype(float)).max()
    return (
        f"{unequal.sum()} of {a.size} samples, first at {place}: {a[place]!r} before, "
        f"{b[place]!r} now; by {largest:.3g} at most"
    )


def _cells(before: Path, after: Path) -> str:
    tables = (csv.reader(path.read_text(encoding="utf-8").splitlines()) for path in (before, after))
    heads: list[str] = []
    for number, rows in enumerate(zip_longest(*tables, fillvalue=[]), 1):
        heads = heads or rows[0]
        for column, (a, b) in enumerate(zip_longest(*rows, fillvalue="nothing")):
            if a != b:
                name = heads[column] if column < len(heads) else column
                return f"line {number}, {name}: {a} before, {b} now"
    return _bytes(before, after)


def _values(before: Path, after: Path) -> str | None:
    a, b = (_without_versions(json.loads(path.read_text(encoding="utf-8"))) for path in
            (before, after))  # fmt: skip
    if json.dumps(a) == json.dumps(b):  # -0.0 equals 0.0, but is not written so
        return None
    return _value_difference("", a, b) or "the same values, in another order or of another sign"


def _without_versions(facts: dict[str, Any]) -> dict[str, Any]:
    if isinstance(facts.get("run"), dict):
        facts["run"].pop("versions", None)
    return facts


def _value_difference(place: str, a: Any, b: Any) -> str | None:
    if isinstance(a, dict) and isinstance(b, dict):
        pairs = {name: (a.get(name, "nothing"), b.get(name, "nothing")) for name in {**a, **b}}
    elif isinstance(a, list) and isinstance(b, list):
        pairs = dict(enumerate(zip_longest(a, b, fillvalue="nothing")))
    else:
        return None if a == b else f"{place}: {_shown(a)} before, {_shown(b)} now"
    inner = (_value_difference(f"{place}/{name}", *pair) for name, pair in pairs.items())
    return next(filter(None, inner), None)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "…"


def _text(before: Path, after: Path) -> str | None:
    a, b = (_RUN_LINE.sub("", path.read_text(encoding="utf-8")) for path in (before, after))
    if a == b:
        return None
    place = next(i for i, (x, y) in enumerate(zip_longest(a, b)) if x != y)
    parts = [repr(text[max(0, place - _SHOWN // 2) : place + _SHOWN]) for text in (a, b)]
    return f"character {place}: {parts[0]} before, {parts[1]} now"
