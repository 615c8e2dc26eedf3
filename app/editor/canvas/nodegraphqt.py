"""NodeGraphQt's view layer: the only file that imports it.

Of its parts we take the graphics view, which brings the scene, and the node as base of our own;
none of its graphs, models, menus and undo. Wires and ports are Qt's own items: thousands of its
take seconds, most of them for what is not shown. Its types are in the `.pyi` beside this file.

It is imported without the rest of its package, and without two that it takes a few names of:
``distutils``, which Python has no more since 3.12 and setuptools brings, and ``Qt``, which copies
every name of every part of Qt. That takes 0.05 s in place of 0.35, of 2.1 s to the first picture.
"""

import importlib.util
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from PySide6 import QtCore, QtGui, QtWidgets


def _module(name: str, **members: Any) -> ModuleType:
    module = ModuleType(name)
    vars(module).update(members)
    return module


def _stand_ins() -> dict[str, ModuleType]:
    """What the view layer imports, by name: Qt 6 where Qt 5 is meant."""

    def widget(name: str) -> Any:  # Qt 6 has moved some, as QAction
        return getattr(QtWidgets if hasattr(QtWidgets, name) else QtGui, name)

    core = _module("Qt.QtCore", __getattr__=lambda name: getattr(QtCore, name))
    core.QRegExp = QtCore.QRegularExpression  # type: ignore[attr-defined]
    version = _module(
        "distutils.version", LooseVersion=lambda text: tuple(map(int, text.split(".")))
    )
    return {
        "Qt": _module(
            "Qt", QtCore=core, QtGui=QtGui, QtWidgets=_module("Qt.QtWidgets", __getattr__=widget)
        ),
        "distutils": _module("distutils", __path__=[], version=version),
        "distutils.version": version,
    }


@contextmanager
def _view_layer_alone() -> Iterator[None]:
    """Import parts of NodeGraphQt, and of what it needs no more than that."""
    spec = importlib.util.find_spec("NodeGraphQt")
    if spec is None or "NodeGraphQt" in sys.modules:
        yield
        return
    package = importlib.util.module_from_spec(spec)  # its own lines import all there is
    stand_ins = _stand_ins()
    before = {name: sys.modules[name] for name in stand_ins if name in sys.modules}
    sys.modules.update(stand_ins, NodeGraphQt=package)
    try:
        yield
    finally:
        for name in stand_ins:
            del sys.modules[name]
        sys.modules.update(before)


with warnings.catch_warnings(), _view_layer_alone():
    warnings.simplefilter("ignore")  # its texts have escapes that Python warns of
    from NodeGraphQt.qgraphics.node_abstract import AbstractNodeItem
    from NodeGraphQt.widgets.viewer import NodeViewer

__all__ = ["AbstractNodeItem", "NodeViewer"]
