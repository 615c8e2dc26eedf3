"""The region that a module measures, framed on its picture and dragged there."""

from collections.abc import Iterator
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QTransform
from PySide6.QtWidgets import QGraphicsRectItem, QToolButton

from app.editor.theme import Theme, theme_of
from app.editor.viewers.picture.picture_canvas import PictureCanvas
from app.editor.viewers.picture.picture_query import Picture
from app.editor.viewers.plot.plot_looks import see_through, thick
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import is_escape
from core.chain.wires import Image
from core.editing.operations import set_parameter, together
from core.errors import ImagechainError, ParameterError, thaw
from core.modules.declaration import Declaration

PARAMETERS = ("region_x", "region_y", "region_width", "region_height")
Region = tuple[int, int, int, int]  # first column and row, width, height
Size = tuple[int, int]  # columns and rows of a picture


class RegionFrame(pg.ROI):  # type: ignore[misc]
    """A frame on whole samples, which are counted from the picture's own first corner."""

    def __init__(self, view: pg.ViewBox) -> None:
        self._picture = pg.ItemGroup()
        view.addItem(self._picture, ignoreBounds=True)
        super().__init__(
            (0, 0), rotatable=False, resizable=False, translateSnap=True, parent=self._picture
        )
        shares = (0.0, 0.5, 1.0)
        for x, y in ((x, y) for x in shares for y in shares if (x, y) != (0.5, 0.5)):
            self.addScaleHandle((x, y), (1 - x, 1 - y))
        self._shade = QGraphicsRectItem(self)
        self._shade.setFlag(QGraphicsRectItem.GraphicsItemFlag.ItemStacksBehindParent)
        self._shade.setPen(thick(see_through("black", 200), 4))
        self.title = pg.TextItem(anchor=(0, -0.3))
        self.title.setParentItem(self)
        self.hide()

    def set_theme(self, theme: Theme) -> None:
        self.setPen(thick(theme.accent, 2))
        self.hoverPen = thick(theme.changed, 2)
        for handle in self.getHandles():
            handle.pen = handle.currentPen = self.pen
            handle.hoverPen = self.hoverPen
        self.title.setColor(theme.text)
        self.title.fill = pg.mkBrush(see_through(theme.base, 215))

    def show_region(self, region: Region, size: Size, place: QRectF, title: str) -> None:
        """Frame a region of a picture of that size, which is drawn at that place."""
        scale = QTransform.fromScale(place.width() / size[0], place.height() / size[1])
        self._picture.setTransform(scale * QTransform.fromTranslate(place.left(), place.top()))
        self.maxBounds = QRectF(0, 0, *size)
        self.translatable = region[2:] != size  # else the picture is dragged
        self.blockSignals(True)
        self.setState({"pos": region[:2], "size": region[2:], "angle": 0})
        self.blockSignals(False)
        self._shade.setRect(QRectF(0, 0, *region[2:]))
        self.title.setText(title)
        self.show()

    @property
    def region(self) -> Region:
        x, y, width, height = (round(one) for one in (*self.pos(), *self.size()))
        return x, y, width, height

    def movePoint(
        self,
        handle: Any,
        pos: Any,
        modifiers: Any = None,
        finish: bool = True,
        coords: str = "parent",
    ) -> None:
        """Move a handle to the nearest corner of samples in the picture."""
        at = self._picture.mapFromScene(pos) if coords == "scene" else QPointF(pos)
        ends = self.maxBounds
        x = round(min(max(at.x(), 0.0), ends.width()))
        y = round(min(max(at.y(), 0.0), ends.height()))
        modifiers = Qt.KeyboardModifier.NoModifier
        super().movePoint(handle, QPointF(x, y), modifiers, finish, "parent")


class RegionTool(QObject):
    """Shows the region of the node selected last, or of a pinned one, on a picture of it."""

    picture_wanted = Signal(str)  # port: the viewer is to show that picture

    def __init__(self, viewer: Viewer, canvas: PictureCanvas, button: QToolButton) -> None:
        super().__init__(canvas)
        self._session = session = viewer.session
        self._evaluator = viewer.evaluator
        self._canvas = canvas
        self._button = button
        self._picture: Picture | None = None
        self._port: str | None = None
        self._node = ""
        self._gesture: object | None = None
        self.frame = RegionFrame(canvas.view)
        self.frame.sigRegionChangeStarted.connect(self._begin)
        self.frame.sigRegionChanged.connect(self._change)
        self.frame.sigRegionChangeFinished.connect(self._end)
        canvas.installEventFilter(self)
        canvas.recoloured.connect(self._recolour)
        canvas.region_wanted.connect(self.look_for)
        button.clicked.connect(self.look_for)
        for signal in (session.changed, session.selection_changed, session.opened):
            signal.connect(self.follow)
        viewer.evaluator.pass_done.connect(self.follow)
        self._having: dict[str, bool] = {}  # by module
        self._recolour()
        self.follow()

    def _recolour(self) -> None:
        self.frame.set_theme(theme_of(self._canvas))

    def show_picture(self, picture: Picture | None, port: str | None) -> None:
        self._picture, self._port = picture, port
        self.follow()

    def follow(self, *_: object) -> None:
        self._button.setEnabled(any(self._nodes()))
        self._node = next((name for name in self._chosen() if self._lies_on(name)), "")
        size = self._size(self._source(self._node)) if self._node else None
        declared = self._session.declared(self._node)
        region = None
        if size is not None and declared is not None:
            values = self._session.valued(self._node).params
            region = _region_in(size, declared, values)
        if region is None or size is None or self._picture is None:
            self.frame.hide()
            self._describe("")
            return
        (x, y, width, height), fits = region
        title = self._node if fits else f"{self._node}  outside the picture"
        self.frame.show_region(region[0], size, self._picture.facts.extent, title)
        self._describe(f"region of {self._node}: {width} × {height} at column {x}, row {y}")

    def look_for(self) -> None:
        """Show a region: of the selected node, or of the first that has one on this picture."""
        names = [*self._chosen(), *self._nodes()]
        on_this = [name for name in names if self._lies_on(name)]
        name = next(iter((*self._chosen(), *on_this, *names)), None)
        if name is None:
            return
        self._session.select([name])
        source = self._source(name)
        if name not in on_this and source is not None:
            self.picture_wanted.emit(source)

    def _nodes(self) -> Iterator[str]:
        """Nodes that have a region: of which modules is found out once, as each edit asks."""
        for name, node in self._session.network.nodes.items():
            known = self._having.get(node.module)
            if known is None or node.macro is not None:
                declared = self._session.declared(name)
                known = declared is not None and all(map(declared.parameter, PARAMETERS))
                self._having[node.module] = known
            if known:
                yield name

    def _chosen(self) -> list[str]:
        nodes, having = self._session.network.nodes, set(self._nodes())
        pinned = (name for name in nodes if nodes[name].extra.get("pinned") is True)
        names = dict.fromkeys((*self._session.selection[-1:], *pinned))
        return [name for name in names if name in having]

    def _lies_on(self, name: str) -> bool:
        """Whether this is a picture of the node's input, or another one of its size."""
        picture, source = self._picture, self._source(name)
        if picture is None or picture.facts.kind != "picture" or source is None:
            return False
        return self._port == source or self._size(self._port) == self._size(source) is not None

    def _source(self, name: str) -> str | None:
        declared = self._session.declared(name)
        for link in self._session.network.links_into(name):
            port = declared.input(link.input) if declared is not None else None
            if port is not None and "image" in port.types:
                return f"{link.source}.{link.output}"
        return None

    def _size(self, port: str | None) -> Size | None:
        plan = self._evaluator.plan
        if plan is None or port is None:
            return None
        try:
            value: Any = plan.output(port)
        except ImagechainError:
            return None
        return (value.columns, value.rows) if isinstance(value, Image) else None

    def _describe(self, text: str) -> None:
        if text != self._canvas.accessibleDescription():
            self._canvas.setAccessibleDescription(text)

    def _begin(self) -> None:
        why = self._session.follows(self._node, PARAMETERS)
        if why:
            self._session.message.emit("error", why)
        self._gesture = None if why else object()

    def _change(self) -> None:
        if self._gesture is not None:
            values = zip(PARAMETERS, self.frame.region, strict=True)
            operations = [set_parameter(self._node, name, value) for name, value in values]
            operation = together(operations, f"Set {self._node}'s region")
            self._session.do(operation, gesture=self._gesture)
        self.follow()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Esc gives up a drag: the region is as before, and the mouse moves it no more."""
        if self._gesture is None or not is_escape(event):
            return False
        for part in (self.frame, *self.frame.getHandles()):
            part.isMoving = False
        self._session.give_up(self._gesture)
        self._end()
        self.follow()
        event.accept()
        return True

    def _end(self) -> None:
        if self._gesture is not None:
            self._gesture = None
            self._session.end_gesture()


def _region_in(size: Size, declared: Declaration, values: Any) -> tuple[Region, bool] | None:
    """The region as it lies in a picture, and whether all of it does; None for bad values."""
    try:
        given = [_value(declared, values, name) for name in PARAMETERS]
    except ParameterError:
        return None
    (left, across, fits_x), (top, along, fits_y) = (
        _within(first, length, whole)
        for first, length, whole in zip(given[:2], given[2:], size, strict=True)
    )
    return (left, top, across, along), fits_x and fits_y


def _value(declared: Declaration, values: Any, name: str) -> int:
    parameter = declared.parameter(name)
    assert parameter is not None
    return (parameter.coerce(thaw(values[name])) if name in values else parameter.default) or 0


def _within(first: int, length: int, whole: int) -> tuple[int, int, bool]:
    start = min(first, whole - 1)
    end = min(first + length, whole) if length else whole
    return start, max(end - start, 1), first < whole and first + length <= whole
