"""NodeGraphQt's view layer: the only file that imports it.

Of its parts we take the graphics view, which brings the scene, and the items as bases of our own;
none of its graphs, models, menus and undo. Its types are in the `.pyi` beside this file.
"""

import os
import warnings

os.environ.setdefault("QT_PREFERRED_BINDING", "PySide6")
with warnings.catch_warnings():  # it imports distutils, and that warns
    warnings.simplefilter("ignore")
    from NodeGraphQt.qgraphics.node_abstract import AbstractNodeItem
    from NodeGraphQt.qgraphics.pipe import PipeItem
    from NodeGraphQt.qgraphics.port import PortItem
    from NodeGraphQt.widgets.viewer import NodeViewer

__all__ = ["AbstractNodeItem", "NodeViewer", "PipeItem", "PortItem"]
