"""What a menu's or a button's signal calls."""

from __future__ import annotations

from collections.abc import Callable


def without_argument(target: Callable[..., object], *_: object) -> None:
    """Call it without the signal's argument, whether the action is checked."""
    target()
