"""The directories of a TIFF file, classic or big, of either byte order: one for each picture.

Source: Adobe, TIFF Revision 6.0 (1992), section 2; libtiff, BigTIFF design (2007).
"""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Iterator

from nodes.files.common.stored_bytes import StoredBytes

_INTEGERS = {1: "B", 3: "H", 4: "I", 16: "Q"}

Tags = dict[int, tuple[int, ...]]


def byte_order(content: StoredBytes) -> str:
    """``<`` or ``>`` of the file; KeyError where it is no TIFF file."""
    return {b"II": "<", b"MM": ">"}[content[:2]]


def _widths(content: StoredBytes, order: str) -> tuple[str, str, int, int]:
    """Formats of places and counts, bytes of a value in an entry, and of an entry."""
    big = content.unpack(order + "H", 2)[0] == 43
    return ("Q", "Q", 8, 20) if big else ("I", "H", 4, 12)


def directories(content: StoredBytes) -> Iterator[int]:
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
    (place,) = content.unpack(order + word, width)
    seen = set()
    while place:
        if place in seen:
            raise ValueError("the directories go round in a circle")
        seen.add(place)
        yield place
        (count,) = content.unpack(order + counter, place)
        after = place + struct.calcsize(order + counter) + count * entry_size
        (place,) = content.unpack(order + word, after)


def read_tags(content: StoredBytes, directory: int | None = None) -> Tags:
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
        (directory,) = content.unpack(order + word, width)
    (count,) = content.unpack(order + counter, directory)
    tags: Tags = {}
    for index in range(count):
        entry = directory + struct.calcsize(order + counter) + index * entry_size
        tag, kind, length = content.unpack(f"{order}HH{word}", entry)
        if kind not in _INTEGERS or length > len(content):
            continue
        place = entry + 4 + width
        if length * struct.calcsize(order + _INTEGERS[kind]) > width:
            (place,) = content.unpack(order + word, place)
        with contextlib.suppress(struct.error):  # beyond the end of the file
            # As libtiff does where a tag stands twice: the first one counts.
            tags.setdefault(tag, content.unpack(f"{order}{length}{_INTEGERS[kind]}", place))
    return tags
