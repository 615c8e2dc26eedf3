"""What a file held when it was read or written, to notice that another program has changed it.

The content itself is compared, by its hash: two writings within one tick of the file system's clock
give the same time, and a file that was only touched is no other.
"""

from __future__ import annotations

import hashlib
import stat
from pathlib import Path

from core.network.json_reading import LARGEST

GONE = ""


def mark(content: bytes) -> str:
    """A digest that distinguishes this content from any other."""
    return hashlib.sha256(content).hexdigest()


def mark_of(path: Path) -> str:
    """The mark of what a file holds; `GONE` where there is none.

    What cannot be read as a file has one that no content has.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would wait
            return "no regular file"
        with path.open("rb") as file:
            # More than the largest network: the mark then differs from every network's.
            return mark(file.read(LARGEST + 1))
    except FileNotFoundError:
        return GONE
    except (OSError, ValueError) as error:
        return f"unreadable: {type(error).__name__}"
