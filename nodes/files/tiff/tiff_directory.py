"""The directories of a TIFF file, classic or big, of either byte order: one for each picture.

Source: Adobe, TIFF Revision 6.0 (1992), section 2; libtiff, BigTIFF design (2007).
"""

from __future__ import annotations

import contextlib
import mmap
import struct
from collections.abc import Iterator

_INTEGERS = {1: "B", 3: "H", 4: "I", 16: "Q"}

Tags = dict[int, tuple[int, ...]]


def byte_order(content: mmap.mmap) -> str:
    """``<`` or ``>`` of the file; KeyError where it is no TIFF file."""
    return {b"II": "<", b"MM": ">"}[content[:2]]


def _widths(content: mmap.mmap, order: str) -> tuple[str, str, int, int]:
    """Formats of places and counts, bytes of a value in an entry, and of an entry."""
    big = struct.unpack_from(order + "H", content, 2)[0] == 43
    return ("Q", "Q", 8, 20) if big else ("I", "H", 4, 12)


def directories(content: mmap.mmap) -> Iterator[int]:
    """Where the directories lie, in the order of the pictures.

    Raises
    ------
    struct.error, KeyError
        One lies beyond the end of the file.
    ValueError
        They go round in a circle.
    """
    order = byte_order(content)
    word, counter, width, entry_size = _widths(content, order)
    (place,) = struct.unpack_from(order + word, content, width)
    seen = set()
    while place:
        if place in seen:
            raise ValueError("the directories go round in a circle")
        seen.add(place)
        yield place
        (count,) = struct.unpack_from(order + counter, content, place)
        after = place + struct.calcsize(order + counter) + count * entry_size
        (place,) = struct.unpack_from(order + word, content, after)


def read_tags(content: mmap.mmap, directory: int | None = None) -> Tags:
    """Integer tags of a directory by number; those with unreadable values are left out.

    Parameters
    ----------
    content
        The file.
    directory
        Where the directory lies; the first one, if not given.

    Raises
    ------
    struct.error, KeyError
        The directory lies beyond the end of the file.
    """
    order = byte_order(content)
    word, counter, width, entry_size = _widths(content, order)
    if directory is None:
        (directory,) = struct.unpack_from(order + word, content, width)
    (count,) = struct.unpack_from(order + counter, content, directory)
    tags: Tags = {}
    for index in range(count):
        entry = directory + struct.calcsize(order + counter) + index * entry_size
        tag, kind, length = struct.unpack_from(f"{order}HH{word}", content, entry)
        if kind not in _INTEGERS or length > len(content):
            continue
        place = entry + 4 + width
        if length * struct.calcsize(order + _INTEGERS[kind]) > width:
            (place,) = struct.unpack_from(order + word, content, place)
        with contextlib.suppress(struct.error):  # beyond the end of the file
            # As libtiff does where a tag stands twice: the first one counts.
            tags.setdefault(
                tag, struct.unpack_from(f"{order}{length}{_INTEGERS[kind]}", content, place)
            )
    return tags
