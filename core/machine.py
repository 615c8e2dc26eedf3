"""The threads, the memory and the scratch disk of this machine, as the engine uses them."""

import errno
import mmap
import os
import re
import tempfile
import threading
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import DTypeLike, NDArray

from core.arrays import Array
from core.errors import FileError

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


# Arrays on disk for a run in blocks: files without a name, mapped, gone with the last view.
#
# All of a file is reserved before it is mapped: a full disk is an error here, and not a signal that
# ends the process while samples are written.

_TRIM_EVERY_S = 0.01
_ZEROS = 1 << 23  # bytes written at a time where a file cannot be reserved
_SHARE_MAPPED = 8  # of the budget, that mapped pages may take before they are let go of
_SHARE_SLAB = 64  # of the budget, for a block of rows: steps hold a dozen of them at once
_SHARE_STRIP = 16  # of the budget, for the columns that one thread transforms at a time
_SHARE_PICTURE = 16  # of the budget, from which on a picture lies on disk


class ScratchDisk:
    """Where the pictures and spectra of a run in blocks lie, which may take so much memory."""

    def __init__(self, folder: Path, memory_bytes: int) -> None:
        self.folder, self.memory_bytes = folder, memory_bytes
        self.most_bytes = 0
        """The most that lay on disk at a time."""
        self.files = 0
        """How many arrays were made."""
        self._bytes = 0
        self._maps: weakref.WeakSet[mmap.mmap] = weakref.WeakSet()
        self._lock = threading.Lock()
        self._end = threading.Event()
        self._trimming: threading.Thread | None = None

    def wants(self, shape: tuple[int, ...], dtype: DTypeLike) -> bool:
        """Whether an array of that shape is to lie here."""
        return is_for_disk(shape, dtype, self.memory_bytes)

    def empty(self, shape: tuple[int, ...], dtype: DTypeLike) -> Array:
        """An array on disk, its samples 0."""
        mapped = self._mapped(_size(shape, dtype))
        return np.frombuffer(mapped, dtype, count=int(np.prod(shape))).reshape(shape)

    def strips(self, shape: tuple[int, int], dtype: DTypeLike) -> "StripArray":
        """An array of which blocks of columns lie together, as few as threads hold at once."""
        column = shape[0] * np.dtype(dtype).itemsize
        width = max(1, min(shape[1], self.memory_bytes // _SHARE_STRIP // max(1, column)))
        flat = self.empty((shape[0] * shape[1],), dtype)
        return StripArray(flat, shape, width)

    def slab_rows(self, columns: int, itemsize: int) -> int:
        """Rows of a picture that are made at a time."""
        return max(1, self.memory_bytes // _SHARE_SLAB // max(1, columns * itemsize))

    def trim(self) -> None:
        """Let go of all mapped pages: they stay on disk, and in the system's cache."""
        if not hasattr(mmap, "MADV_DONTNEED"):
            return
        with self._lock:
            maps = list(self._maps)
        for mapped in maps:
            mapped.madvise(mmap.MADV_DONTNEED)

    def __enter__(self) -> Self:
        if _mapped_bytes() is not None:
            self._trimming = threading.Thread(target=self._keep_trim, daemon=True)
            self._trimming.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._end.set()
        if self._trimming is not None:
            self._trimming.join()

    def _keep_trim(self) -> None:
        # By a thread: numpy reads whole pictures within one call.
        while not self._end.wait(_TRIM_EVERY_S):
            if (_mapped_bytes() or 0) * _SHARE_MAPPED > self.memory_bytes:
                self.trim()

    def _mapped(self, size: int) -> mmap.mmap:
        try:
            with tempfile.TemporaryFile(dir=self.folder, prefix=".imagechain-scratch-") as file:
                _reserve(file.fileno(), size)
                mapped = mmap.mmap(file.fileno(), size)
        except OSError as error:
            raise FileError(self._refusal(size, error)) from error
        with self._lock:
            self._maps.add(mapped)
            self.files += 1
            self._bytes += size
            self.most_bytes = max(self.most_bytes, self._bytes)
        weakref.finalize(mapped, self._given_back, size).atexit = False
        return mapped

    def _given_back(self, size: int) -> None:
        self._bytes -= size  # without the lock: collecting may happen while it is held

    def _refusal(self, size: int, error: OSError) -> str:
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            return (
                f"the scratch folder {self.folder} has no room for another {amount_text(size)} "
                f"in addition to {amount_text(self._bytes)} already written. Choose another "
                "scratch folder"
            )
        return f"cannot write to the scratch folder {self.folder}: {error.strerror or error}"


def is_for_disk(shape: tuple[int, ...], dtype: DTypeLike, memory_bytes: int) -> bool:
    """Whether an array of that shape is too large for memory in a run that may take so much."""
    return _size(shape, dtype) * _SHARE_PICTURE > memory_bytes


def is_on_disk(value: object) -> bool:
    """Whether a value's arrays, or one of them, lie on disk."""
    if isinstance(value, StripArray):
        return True
    base = value
    while isinstance(base, np.ndarray):
        base = base.base
    if isinstance(base, memoryview):
        base = base.obj
    if isinstance(base, mmap.mmap):
        return True
    if isinstance(value, tuple | list):
        return any(is_on_disk(item) for item in value)
    return not isinstance(value, np.ndarray | type) and any(
        isinstance(item, np.ndarray | StripArray) and is_on_disk(item)
        for item in getattr(value, "__dict__", {}).values()
    )


def _size(shape: tuple[int, ...], dtype: DTypeLike) -> int:
    return max(1, int(np.prod(shape, dtype=np.int64))) * np.dtype(dtype).itemsize


def _reserve(descriptor: int, size: int) -> None:
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(descriptor, 0, size)
        return
    zeros = bytes(_ZEROS)
    left = size
    while left:
        left -= os.write(descriptor, zeros[: min(left, _ZEROS)])


def _mapped_bytes() -> int | None:
    """Mapped pages in the process's memory; None where the system does not report them."""
    try:
        shared = Path("/proc/self/statm").read_bytes().split()[2]
    except (OSError, IndexError):
        return None
    return int(shared) * mmap.PAGESIZE


# Who makes an array leaves it to the caller where it lies: in memory, or on disk.

Empty = Callable[[tuple[int, ...], np.dtype[Any]], NDArray[Any]]
"""Makes an array of a shape and type to be filled in: `numpy.empty`, or `Work.empty`."""


class StripArray:
    """A 2-D array on disk that is written by rows and transformed by columns, or the reverse.

    Blocks of columns ("strips") lie together, each by rows: either way disks read and write long
    runs. Rows are read and written by ``array[start:stop]``, strips are views of `width` columns.
    """

    def __init__(self, flat: Array, shape: tuple[int, int], width: int) -> None:
        self.shape, self.dtype = shape, flat.dtype
        rows, columns = shape
        self.places = [slice(left, min(left + width, columns)) for left in range(0, columns, width)]
        self.strips = [
            flat[rows * place.start : rows * place.stop].reshape(rows, place.stop - place.start)
            for place in self.places
        ]

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, rows: slice | Array) -> Array:
        """A copy of some rows."""
        parts = [strip[rows] for strip in self.strips]
        return np.concatenate(parts, axis=1)

    def __setitem__(self, rows: slice, block: Array | float) -> None:
        for place, strip in zip(self.places, self.strips, strict=True):
            strip[rows] = block[:, place] if isinstance(block, np.ndarray) else block
