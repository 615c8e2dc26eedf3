"""The first directory of a TIFF file, classic or big, of either byte order.

Source: Adobe, TIFF Revision 6.0 (1992), section 2; libtiff, BigTIFF design (2007).
"""

from __future__ import annotations

import contextlib
import mmap
import struct

_INTEGERS = {1: "B", 3: "H", 4: "I", 16: "Q"}

Tags = dict[int, tuple[int, ...]]


def byte_order(content: mmap.mmap) -> str:
    """``<`` or ``>`` of the file; KeyError where it is no TIFF file."""
    return {b"II": "<", b"MM": ">"}[content[:2]]


def read_tags(content: mmap.mmap) -> Tags:
    """Integer tags of the first directory by number; those with unreadable values are left out.

    Raises
    ------
    struct.error, KeyError
        The directory lies beyond the end of the file.
    """
    order = byte_order(content)
    big = struct.unpack_from(order + "H", content, 2)[0] == 43
    word, counter, width, entry_size = ("Q", "Q", 8, 20) if big else ("I", "H", 4, 12)
    (directory,) = struct.unpack_from(order + word, content, 8 if big else 4)
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
