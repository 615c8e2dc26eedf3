"""Content keys: equal keys mean equal values, whatever process made them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np


def content_key(*parts: object) -> str:
    """Hash `parts` to 32 hexadecimal digits.

    Understands what recipes are made of: plain values, tuples, mappings, enumerations, module-level
    functions, small arrays, frozen dataclasses (fields with ``compare=False`` do not count) and
    anything that has a `key` of its own.

    Raises
    ------
    TypeError
        For an object whose content has no defined form.
    """
    # The text of plain values is made in one go: half the time of feeding the hash bit by bit.
    text = repr(_plain(parts)).encode("utf-8", "surrogatepass")
    return hashlib.blake2b(text, digest_size=16).hexdigest()


def _plain(part: Any) -> Any:
    """Nested tuples of plain values, of which no two with different content look the same."""
    kind = type(part)
    if kind in _PLAIN:
        return part
    if kind is tuple or kind is list:
        return tuple([_plain(item) for item in part])
    key = getattr(part, "key", None)
    if isinstance(key, str) and not isinstance(part, type):
        return ("key", key)
    if isinstance(part, np.generic):
        return part.item()
    if isinstance(part, np.ndarray):
        return ("array", part.dtype.str, part.shape, np.ascontiguousarray(part).tobytes())
    return _plain_object(part)


def _plain_object(part: Any) -> tuple[Any, ...]:
    if isinstance(part, Path):
        return ("path", str(part))
    if isinstance(part, tuple | list):
        return tuple([_plain(item) for item in part])
    if isinstance(part, Mapping):
        return ("mapping", _plain(tuple(sorted(part.items()))))
    if isinstance(part, Enum):
        return ("member", type(part).__qualname__, part.name)
    if isinstance(part, partial):
        return ("partial", _plain((part.func, part.args, part.keywords)))
    if is_dataclass(part) and not isinstance(part, type):
        name = f"{type(part).__module__}.{type(part).__qualname__}"
        return (name, *[_plain(getattr(part, f.name)) for f in fields(part) if f.compare])
    if callable(part) and "<" not in getattr(part, "__qualname__", "<"):
        name = f"{part.__module__}.{part.__qualname__}"
        return ("function", name, getattr(part, "version", 1))
    raise TypeError(f"cannot make a content key of {type(part).__name__}")


_PLAIN = frozenset({str, int, float, bool, type(None)})
