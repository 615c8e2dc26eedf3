"""Networks opened one after another in one window: what memory is left in use.

It goes up and down with what the store has to drop, so rounds through the same networks are
compared by the most they leave in use.
"""

import ctypes
import gc
import json
import sys
from itertools import cycle, islice
from pathlib import Path

from app.run.shipped import shipped_networks
from trial_window import live, settle, trial_window

PAGE = 4096


def resident_mib() -> float:
    """Memory this process has in use, MiB."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * PAGE / 2**20


def give_back() -> None:
    """Have the C library return what is free: it may keep hundreds of MiB for a while."""
    libc = ctypes.CDLL(None)
    if hasattr(libc, "malloc_trim"):
        libc.malloc_trim(0)


def main(number: int, warm: int) -> None:
    """Open them, each until its pictures stand, with the empty document between.

    The first `warm` do not count: by then libraries, fonts and caches have been filled.
    """
    names = shipped_networks()
    with trial_window() as (_, window):
        resident = []
        for name in islice(cycle(names), number):
            window.files.open_now(name)
            settle(window)
            window.files.new()
            settle(window)
            gc.collect()
            live(0.05)
            give_back()
            resident.append(resident_mib())
        first, last = max(resident[warm : warm + len(names)]), max(resident[warm:][-len(names) :])
        print(json.dumps({"warm_mib": first, "end_mib": last, "growth": last / first - 1}))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
