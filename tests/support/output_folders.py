"""Folders with all that the networks deliver at full size, and the first difference of two."""

import hashlib
import json
import re
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path

import numpy as np

from network_outputs import PRECISIONS, run_network, run_with_reports
from output_statistics import picture_bytes, picture_statistics

PLAIN, REPORTED = "plain", "reported"  # a run without reports lets go of values early
PICTURES = "pictures.json"
# In the report for people, and in that for programs.
_VERSIONS = re.compile(rb'<p class="?run"?>.*?</p>|"versions": \{.*?\}', re.DOTALL)


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
    return (_samples if before.suffix == ".npy" else _bytes)(before, after)


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


def _bytes(before: Path, after: Path) -> str | None:
    a, b = (_VERSIONS.sub(b"", path.read_bytes()) for path in (before, after))
    if a == b:
        return None
    place = next(i for i, (x, y) in enumerate(zip_longest(a, b)) if x != y)
    parts = [text[max(0, place - 30) : place + 60].decode(errors="replace") for text in (a, b)]
    return f"byte {place}: {parts[0]!r} before, {parts[1]!r} now"
