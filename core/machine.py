"""The threads and the memory of this machine, as the engine uses them."""

import os
import re
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

ForEach = Callable[[Callable[[Any], None], Sequence[Any]], None]
"""Calls a function on every item of a sequence, in whatever order."""


def in_turn(function: Callable[[Any], None], items: Sequence[Any]) -> None:
    """Call `function` on every item, one after the other."""
    for item in items:
        function(item)


class Workers:
    """A pool of threads, begun when first needed."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pool: ThreadPoolExecutor | None = None
        self._size = 0

    def for_each(self, function: Callable[[Any], None], items: Sequence[Any], threads: int) -> None:
        """Call `function` on every item; items must write to different places.

        The calling thread is one of at most so many that work at once. It takes items too and never
        waits for one that has not begun, so that a function may call `for_each` again.
        """
        helpers = min(threads, len(items)) - 1
        if helpers < 1:
            in_turn(function, items)
            return
        left = deque(items)

        def help_out() -> None:
            try:
                for item in _taken(left):
                    function(item)
            except BaseException:
                left.clear()  # an item failed: none is begun any more
                raise

        pool = self._threads(helpers)
        futures = [pool.submit(help_out) for _ in range(helpers)]
        try:
            help_out()
        finally:
            begun = [future for future in futures if not future.cancel()]
            for future in begun:
                future.exception()  # waits
        for future in begun:
            future.result()

    def _threads(self, count: int) -> "ThreadPoolExecutor":
        from concurrent.futures import ThreadPoolExecutor  # takes 3 ms, and many need none

        with self._lock:
            if self._pool is None or self._size < count:
                self._pool = ThreadPoolExecutor(count, thread_name_prefix="imagechain")
                self._size = count
            return self._pool


def _taken(items: deque[Any]) -> Iterator[Any]:
    """Items that no other thread takes, until none is left."""
    while items:
        try:
            item = items.popleft()
        except IndexError:  # another thread took the last one
            return
        yield item


# How much memory the process may use, and how much of it computed values may keep.

LEAST_BYTES = 1 << 27
WITHOUT_KNOWLEDGE = 1 << 29
"""Where the system does not report how much memory there is."""


def amount_text(size: float) -> str:
    """Bytes in words."""
    for unit, bytes_of in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= 0.1 * bytes_of:
            return f"{size / bytes_of:.3g} {unit}"
    return f"{size:.0f} bytes"


def store_bytes() -> int:
    """How much a store may keep: a quarter of the memory, or half of what is free if less."""
    whole = usable_bytes()
    if whole is None:
        return WITHOUT_KNOWLEDGE
    free = [size for size in (_available(), *_left_in_groups()) if size is not None]
    return max(LEAST_BYTES, min(whole // 4, min(free, default=whole) // 2))


def usable_bytes() -> int | None:
    """The memory that the process may use; None where the system does not report it."""
    whole = [size for size in (physical_bytes(), *_limits()) if size is not None]
    return min(whole, default=None)


def physical_bytes() -> int | None:
    """The machine's memory; None where the system does not report it."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on every system
        return None


def _limits() -> list[int]:
    limits = [limit for folder in _groups() if (limit := _group_limit(folder)) is not None]
    try:
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_AS)
        limits += [soft] if soft != resource.RLIM_INFINITY else []
    except (ImportError, AttributeError, OSError, ValueError):  # not on every system
        pass
    return limits


def _available() -> int | None:
    try:
        text = Path("/proc/meminfo").read_text()
    except OSError:
        return None
    match = re.search(r"^MemAvailable:\s+(\d+) kB", text, re.MULTILINE)
    return None if match is None else int(match[1]) << 10


def _left_in_groups() -> list[int]:
    sizes = []
    for folder in _groups():
        limit = _group_limit(folder)
        used = _number(folder / "memory.current", folder / "memory.usage_in_bytes")
        if limit is not None and used is not None:
            sizes.append(max(0, limit - used))
    return sizes


def _group_limit(folder: Path) -> int | None:
    return _number(folder / "memory.max", folder / "memory.limit_in_bytes")


def _number(*files: Path) -> int | None:
    """What the first readable file holds; None for `max`, no limit."""
    for file in files:
        try:
            text = file.read_text().strip()
        except OSError:
            continue
        return int(text) if text.isdigit() else None
    return None


def _groups(root: Path = Path("/sys/fs/cgroup")) -> list[Path]:
    """The control groups of the process that count memory, inwards; none outside Linux."""
    try:
        lines = Path("/proc/self/cgroup").read_text().splitlines()
    except OSError:
        return []
    folders: list[Path] = []
    for line in lines:
        _, kinds, path = line.split(":", 2)
        if kinds and "memory" not in kinds.split(","):
            continue
        base = root / "memory" if kinds else root
        folder = base
        for part in ["", *path.strip("/").split("/")]:
            folder = folder / part
            if folder.is_dir() and folder not in folders:
                folders.append(folder)
    return folders
