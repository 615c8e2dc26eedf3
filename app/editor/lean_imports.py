"""Having Qt's bindings leave the sources of other modules alone."""

from __future__ import annotations

import sys


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
