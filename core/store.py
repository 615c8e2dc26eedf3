"""The store of computed values: least recently used out first, bounded in bytes."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import numpy as np

DEFAULT_BYTES = 1 << 29


def size_in_bytes(value: object) -> int:
    """Bytes a value keeps alive, nearly: arrays count, and containers of arrays."""
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    if isinstance(value, tuple | list):
        return 64 + sum(size_in_bytes(item) for item in value)
    if isinstance(value, dict):
        return 64 + sum(size_in_bytes(item) for item in value.values())
    if hasattr(value, "__dict__"):
        return 64 + sum(size_in_bytes(item) for item in vars(value).values())
    return 64


def freeze(value: object) -> None:
    """Make the arrays of a value read-only: what is handed out is shared."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, tuple | list):
        for item in value:
            freeze(item)
    elif isinstance(value, dict):
        for item in value.values():
            freeze(item)
    elif hasattr(value, "__dict__"):
        for item in vars(value).values():
            freeze(item)


_ABSENT = object()


class _Running:
    """A key under computation: its lock, and how many are at it or wait for it."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.users = 0


class Store:
    """Values by key. One computation per key at a time; safe to share between threads."""

    def __init__(self, capacity_bytes: int = DEFAULT_BYTES) -> None:
        self.capacity_bytes = capacity_bytes
        self._values: OrderedDict[str, tuple[Any, int]] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()
        self._running: dict[str, _Running] = {}

    def __len__(self) -> int:
        return len(self._values)

    @property
    def used_bytes(self) -> int:
        """Bytes held now."""
        return self._bytes

    def peek(self, key: str, default: Any = None) -> Any:
        """The value of `key` if it is there, else `default`; never computes."""
        with self._lock:
            found = self._values.get(key)
            if found is None:
                return default
            self._values.move_to_end(key)
            return found[0]

    def get(self, key: str, compute: Callable[[], Any]) -> Any:
        """The value of `key`, computed if it is not there.

        A second thread asking for a key under computation waits for it. An error is not kept:
        the next one to ask tries again.
        """
        found = self.peek(key, _ABSENT)
        if found is not _ABSENT:
            return found
        with self._lock:
            running = self._running.setdefault(key, _Running())
            running.users += 1
        try:
            with running.lock:
                found = self.peek(key, _ABSENT)
                if found is not _ABSENT:
                    return found
                value = compute()
                freeze(value)
                if isinstance(value, np.ndarray):
                    value = value.view()  # a view of a read-only array cannot be made writeable
                self._put(key, value)
                return value
        finally:
            with self._lock:
                running.users -= 1
                if running.users == 0:
                    self._running.pop(key, None)

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._values.clear()
            self._bytes = 0

    def _put(self, key: str, value: Any) -> None:
        size = size_in_bytes(value)
        if size > self.capacity_bytes:
            return
        with self._lock:
            _, before = self._values.pop(key, (None, 0))
            self._values[key] = (value, size)
            self._bytes += size - before
            while self._bytes > self.capacity_bytes:
                _, (_, dropped) = self._values.popitem(last=False)
                self._bytes -= dropped
