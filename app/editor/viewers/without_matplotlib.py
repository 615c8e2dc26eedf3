"""Keeping pyqtgraph from loading all of matplotlib for a menu that is never opened."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator

_NAME = "matplotlib"


@contextlib.contextmanager
def without_matplotlib() -> Iterator[None]:
    """Make matplotlib seem not to be installed, unless it has been loaded already.

    A histogram of pyqtgraph lists matplotlib's colour maps in the menu of its gradient, which takes
    a third of a second of the time until the first picture.
    """
    if _NAME in sys.modules:
        yield
        return
    sys.modules[_NAME] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[_NAME]
