"""NodeGraphQt's view layer: the only file that imports it.

Of its parts we take the graphics view, which brings the scene, and the items as bases of our own;
none of its graphs, models, menus and undo. Its types are in the `.pyi` beside this file.
"""

import os
import sys
import types
import warnings
from collections.abc import Iterator
from contextlib import contextmanager


class _Version(tuple[int, ...]):
    """A version such as ``6.11.3``, compared number by number."""

    def __new__(cls, text: str) -> "_Version":
        return super().__new__(cls, (int(part) for part in text.split(".")))


@contextmanager
def _plain_versions() -> Iterator[None]:
    """Stand in for ``distutils.version``, of which NodeGraphQt compares versions of Qt with.

    Python has it no more since 3.12; setuptools', brought in its place, took 0.14 s of the 2.1 s to
    the first picture.
    """
    if "distutils" in sys.modules:
        yield
        return
    package, module = types.ModuleType("distutils"), types.ModuleType("distutils.version")
    package.__path__ = []
    module.LooseVersion = _Version  # type: ignore[attr-defined]
    stands = {"distutils": package, "distutils.version": module}
    sys.modules.update(stands)
    try:
        yield
    finally:
        for name in stands:
            del sys.modules[name]


os.environ.setdefault("QT_PREFERRED_BINDING", "PySide6")
with warnings.catch_warnings(), _plain_versions():
    warnings.simplefilter("ignore")  # its texts have escapes that Python warns of
    from NodeGraphQt.qgraphics.node_abstract import AbstractNodeItem
    from NodeGraphQt.qgraphics.pipe import PipeItem
    from NodeGraphQt.qgraphics.port import PortItem
    from NodeGraphQt.widgets.viewer import NodeViewer

__all__ = ["AbstractNodeItem", "NodeViewer", "PipeItem", "PortItem"]
