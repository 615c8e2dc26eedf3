"""How much memory computed values may take."""

from __future__ import annotations

import os

from core.store import DEFAULT_BYTES


def store_bytes() -> int:
    """How much the store may hold: a quarter of the machine's memory, 512 MiB at least."""
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on every system
        memory = 0
    return max(DEFAULT_BYTES, memory // 4)
