"""Importing and building the window without what only costs time while nothing can be gained."""

from __future__ import annotations

import contextlib
import gc
import sys
from collections.abc import Iterator

NEVER = 2**30


def leave_sources_unread() -> None:
    """Have the bindings read no module's source; to be called once PySide6 is imported.

    They look in the text of every module imported after them for their own name, to know whether
    it may take part in ``from __feature__ import snake_case``; nothing here does. The window
    imports 1,200 modules: 0.17 s of the 2.1 s to the first picture, and all of their text stays in
    memory. Where the bindings are made otherwise, nothing is changed.
    """
    feature = sys.modules.get("shibokensupport.feature")
    if feature is not None and "_mod_uses_pyside" in vars(feature):
        vars(feature)["_mod_uses_pyside"] = lambda _module: False


@contextlib.contextmanager
def nothing_collected() -> Iterator[None]:
    """Look for no garbage meanwhile, nor ever again among what was made meanwhile.

    What imports and the building of a window make stays: to go through it 300 times, as Python
    does, took 0.2 s of the 2.0 s to the first picture, and each later collection of everything goes
    through 120,000 objects of it.
    """
    usual = gc.get_threshold()
    gc.set_threshold(NEVER, NEVER, NEVER)
    try:
        yield
    finally:
        gc.freeze()
        gc.set_threshold(*usual)
