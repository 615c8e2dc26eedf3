"""Content keys: equal keys mean equal values, whatever process made them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
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
        For an object whose content cannot be told.
    """
    digest = hashlib.blake2b(digest_size=16)
    _feed(digest.update, parts)
    return digest.hexdigest()


def _feed(write: Callable[[bytes], None], part: Any) -> None:
    if part is None or isinstance(part, bool | int | str | Path):
        text = str(part).encode("utf-8", "surrogatepass")
        kind = "str" if isinstance(part, str) else type(part).__name__
        write(f"{kind}{len(text)}:".encode() + text)
    elif isinstance(part, float | np.floating):
        write(b"f" + float(part).hex().encode() + b";")
    elif isinstance(part, np.integer):
        write(f"int:{int(part)};".encode())
    elif isinstance(getattr(part, "key", None), str) and not isinstance(part, type):
        write(b"k" + part.key.encode() + b";")
    elif isinstance(part, tuple | list):
        write(f"({len(part)}".encode())
        for item in part:
            _feed(write, item)
        write(b")")
    elif isinstance(part, Mapping):
        _feed(write, tuple(sorted(part.items())))
    elif isinstance(part, np.ndarray):
        write(f"a{part.dtype.str}{part.shape}".encode() + np.ascontiguousarray(part).tobytes())
    elif isinstance(part, Enum):
        write(f"{type(part).__qualname__}.{part.name};".encode())
    elif isinstance(part, partial):
        _feed(write, (part.func, part.args, part.keywords))
    elif is_dataclass(part) and not isinstance(part, type):
        write(f"{type(part).__module__}.{type(part).__qualname__}(".encode())
        for field in fields(part):
            if field.compare:
                _feed(write, getattr(part, field.name))
        write(b")")
    elif callable(part) and "<" not in getattr(part, "__qualname__", "<"):
        version = getattr(part, "version", 1)
        write(f"{part.__module__}.{part.__qualname__}/{version};".encode())
    else:
        raise TypeError(f"cannot make a content key of {type(part).__name__}")
