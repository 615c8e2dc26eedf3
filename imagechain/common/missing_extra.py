"""Libraries that are used where they are installed, and not needed otherwise."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from core.errors import UsageError


def needed(name: str, purpose: str) -> ModuleType:
    """The library of that name.

    Raises
    ------
    UsageError
        Saying how it is installed.
    """
    try:
        return import_module(name)
    except ImportError:
        raise UsageError(
            f"{name} is not installed, which {purpose} take: pip install {name}"
        ) from None
