"""What we use of NodeGraphQt's view layer, with its types."""

from typing import Any

from PySide6.QtCore import QRectF
from PySide6.QtWidgets import (
    QGraphicsItem,
    QGraphicsPathItem,
    QGraphicsView,
    QMenu,
    QMenuBar,
    QRubberBand,
    QWidget,
)

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

class PortItem(QGraphicsItem):
    """A place where wires end."""

    name: str
    port_type: str
    _hovered: bool

    def __init__(self, parent: QGraphicsItem | None = None) -> None: ...
    @property
    def connected_pipes(self) -> list[PipeItem]: ...
    @property
    def node(self) -> Any: ...
    def redraw_connected_pipes(self) -> None: ...

class PipeItem(QGraphicsPathItem):
    """A wire between two ports."""

    color: tuple[int, int, int, int]
    style: int
    _active: bool
    _highlight: bool
    _dir_pointer: QGraphicsItem

    def set_connections(self, port1: PortItem, port2: PortItem) -> None: ...
    @property
    def input_port(self) -> Any: ...
    @property
    def output_port(self) -> Any: ...
    def reset(self) -> None: ...
    def delete(self) -> None: ...
