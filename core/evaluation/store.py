"""The store of computed values: least recently used out first, bounded in bytes.

A pinned value stays, whatever its size, until the last one lets it go.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

import numpy as np

from core.machine import is_on_disk, store_bytes

if TYPE_CHECKING:
    from core.evaluation.recipes import Recipe, Region


def _parts(value: object) -> Collection[object]:
    if isinstance(value, tuple | list):
        return value
    return (value if isinstance(value, dict) else getattr(value, "__dict__", {})).values()


def size_in_bytes(value: object) -> int:
    """Bytes of memory a value keeps alive, nearly: arrays count, and containers of arrays."""
    if is_on_disk(value):
        return 64
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    return 64 + sum(map(size_in_bytes, _parts(value)))


def freeze(value: object) -> None:
    """Make the arrays of a value read-only: what is handed out is shared."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
        return
    for part in _parts(value):
        freeze(part)


_ABSENT = object()


class Store:
    """Values by key. One computation per key at a time; safe to share between threads.

    `capacity_bytes` may stay beside what is pinned; by default what the machine's memory allows.
    """

    def __init__(self, capacity_bytes: int | None = None) -> None:
        self.capacity_bytes = store_bytes() if capacity_bytes is None else capacity_bytes
        self._values: OrderedDict[str, tuple[Any, int]] = OrderedDict()
        self._pinned: dict[str, tuple[Any, int]] = {}
        self._pins: dict[str, int] = {}
        self._bytes = 0
        self._lock = threading.Lock()
        self._running: WeakValueDictionary[str, Any] = WeakValueDictionary()
        """Locks of the keys that are under computation, as long as a thread holds or awaits one."""

    def __len__(self) -> int:
        return len(self._values) + len(self._pinned)

    @property
    def used_bytes(self) -> int:
        return self._bytes

    @property
    def pinned(self) -> int:
        return len(self._pins)

    def peek(self, key: str, default: Any = None) -> Any:
        """The value of `key` if it is there, else `default`; never computes."""
        with self._lock:
            entry = self._values.get(key)
            if entry is not None:
                self._values.move_to_end(key)
                return entry[0]
            entry = self._pinned.get(key)
            return default if entry is None else entry[0]

    def holds(self, key: str) -> bool:
        return self.peek(key, _ABSENT) is not _ABSENT

    def pin(self, key: str) -> bool:
        """Keep the value of `key`, or what it will be, until unpinned as often; if it is there."""
        with self._lock:
            self._pins[key] = self._pins.get(key, 0) + 1
            entry = self._values.pop(key, None)
            if entry is not None:
                self._pinned[key] = entry
                return True
        return self.holds(key)

    def unpin(self, key: str) -> None:
        """Take back one `pin`; after the last the value stays while there is room."""
        with self._lock:
            left = self._pins[key] - 1
            if left:
                self._pins[key] = left
                return
            del self._pins[key]
            entry = self._pinned.pop(key, None)
            if entry is not None:
                self._bytes -= entry[1]
                self._keep(key, *entry)

    def get(self, key: str, compute: Callable[[], Any]) -> Any:
        """The value of `key`, computed if it is not there.

        A second thread that reads a key under computation waits for it. An error is not kept:
        the next read tries again.
        """
        stored = self.peek(key, _ABSENT)
        if stored is not _ABSENT:
            return stored
        with self._lock:
            running = self._running.setdefault(key, threading.RLock())
        with running:
            stored = self.peek(key, _ABSENT)
            if stored is not _ABSENT:
                return stored
            value = compute()
            freeze(value)
            if isinstance(value, np.ndarray):
                value = value.view()  # a view of a read-only array cannot be made writeable
            self._put(key, value)
            return value

    def drop(self, key: str) -> None:
        with self._lock:
            self._bytes -= self._values.pop(key, (None, 0))[1]

    def clear(self) -> None:
        with self._lock:
            self._values.clear()
            self._pinned.clear()
            self._bytes = 0

    def _put(self, key: str, value: Any) -> None:
        size = size_in_bytes(value)
        with self._lock:
            for entries in (self._values, self._pinned):
                self._bytes -= entries.pop(key, (None, 0))[1]
            if key not in self._pins:
                self._keep(key, value, size)
                return
            self._pinned[key] = (value, size)
            self._bytes += size
            self._make_room()

    def _keep(self, key: str, value: Any, size: int) -> None:
        """Take in a value that is not pinned; one too large leaves the others alone.

        Nor does one on disk stay: there it would never be too much.
        """
        if size <= self.capacity_bytes and not is_on_disk(value):
            self._values[key] = (value, size)
            self._bytes += size
            self._make_room()

    def _make_room(self) -> None:
        while self._bytes > self.capacity_bytes and self._values:
            _, (_, dropped) = self._values.popitem(last=False)
            self._bytes -= dropped


# What one evaluation requested, and what of it had to be computed.


class EvaluationLog:
    """Notes of one evaluation; nothing that is computed depends on them.

    Each note is one operation on a built-in dict or set, which threads may share.
    """

    def __init__(self) -> None:
        self.requested: dict[str, Recipe] = {}
        """Recipes whose value was requested, by key."""
        self.parts: dict[tuple[str, Region], Recipe] = {}
        """Pictures of which a region was requested."""
        self.computed: set[str | tuple[str, Region]] = set()
        """Those of both whose computation was begun."""
        self.looked_at: set[str] = set()
        """Keys of spectra and transfer functions of which an array was made."""

    def add(self, other: EvaluationLog) -> None:
        self.requested.update(other.requested)
        self.parts.update(other.parts)
        self.computed |= other.computed
        self.looked_at |= other.looked_at

    def reused(self) -> list[Recipe]:
        """Recipes whose value, or the requested part of it, was there already."""
        whole = [recipe for key, recipe in list(self.requested.items()) if key not in self.computed]
        return whole + [
            recipe
            for (key, region), recipe in list(self.parts.items())
            if key not in self.requested and (key, region) not in self.computed
        ]
