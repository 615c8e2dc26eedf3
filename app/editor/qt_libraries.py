"""Starting Qt: what it needs of the system, and importing it without what only costs time.

Qt's own loader names one library a time, and ends the process with a core dump for some of them.
"""

import contextlib
import ctypes
import gc
import sys
from collections.abc import Iterator
from functools import partial
from importlib import import_module
from types import ModuleType

from core.errors import UsageError

# By the name they are loaded by: the package of Debian and Ubuntu that has it.
DRAWING = {
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libfreetype.so.6": "libfreetype6",
    "libxkbcommon.so.0": "libxkbcommon0",
    "libX11.so.6": "libx11-6",
}
WINDOW = {
    "libX11-xcb.so.1": "libx11-xcb1",
    "libxcb-cursor.so.0": "libxcb-cursor0",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-image.so.0": "libxcb-image0",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-randr.so.0": "libxcb-randr0",
    "libxcb-render-util.so.0": "libxcb-render-util0",
    "libxcb-shape.so.0": "libxcb-shape0",
    "libxcb-sync.so.1": "libxcb-sync1",
    "libxcb-xfixes.so.0": "libxcb-xfixes0",
    "libxcb-xkb.so.1": "libxcb-xkb1",
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
}


def check_libraries(*, window: bool) -> None:
    """Refuse to load Qt where something of the system that it needs cannot be loaded.

    Without a `window` on an X server, what draws to memory is enough. The `UsageError` names all
    that is missing, and the packages that have it.
    """
    if not sys.platform.startswith("linux"):
        return
    wanted = DRAWING | WINDOW if window else DRAWING
    missing = []
    for name in wanted:
        try:
            ctypes.CDLL(name)
        except OSError:
            missing.append(name)
    if missing:
        packages = " ".join(wanted[name] for name in missing)
        raise UsageError(
            f"the editor needs system libraries that are missing: {', '.join(missing)} (on "
            f"Debian or Ubuntu, as root: apt-get install -y {packages})"
        )


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
def names_looked_up() -> Iterator[None]:
    """Have pyqtgraph, where it is imported meanwhile, ask the bindings for each name it uses.

    It copies the 2,000 names of its own three Qt modules, and the bindings make a class for each:
    a tenth of the processor time to the first picture.
    """
    sources = {name: import_module(f"PySide6.{name}") for name in ("QtCore", "QtGui", "QtWidgets")}
    for name, source in sources.items():
        mirror = ModuleType(f"pyqtgraph.Qt.{name}")
        vars(mirror)["__getattr__"] = partial(getattr, source)
        sys.modules.setdefault(mirror.__name__, mirror)
        vars(source)["__dir__"] = list  # nothing to copy
    try:
        yield
    finally:
        for source in sources.values():
            del vars(source)["__dir__"]


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
