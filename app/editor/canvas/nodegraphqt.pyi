"""What we use of NodeGraphQt's view layer, with its types."""

from PySide6.QtCore import QRectF
from PySide6.QtWidgets import QGraphicsItem, QGraphicsView, QMenu, QMenuBar, QRubberBand, QWidget

class NodeViewer(QGraphicsView):
    """A graphics view of nodes and wires."""

    _cursor_text: QGraphicsItem
    _LIVE_PIPE: QGraphicsItem
    _SLICER_PIPE: QGraphicsItem
    _search_widget: QWidget
    _ctx_menu_bar: QMenuBar
    _ctx_graph_menu: QMenu
    _ctx_node_menu: QMenu
    _rubber_band: QRubberBand
    _scene_range: QRectF

    def __init__(self, parent: QWidget | None = None, undo_stack: object = None) -> None: ...

class AbstractNodeItem(QGraphicsItem):
    """A node: a rectangle with ports."""

    id: str
    _width: float
    _height: float

    def __init__(self, name: str = "node", parent: QGraphicsItem | None = None) -> None: ...
    @property
    def size(self) -> tuple[float, float]: ...
    @property
    def selected(self) -> bool: ...
    @property
    def disabled(self) -> bool: ...
    @disabled.setter
    def disabled(self, state: bool) -> None: ...
