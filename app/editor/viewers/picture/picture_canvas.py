"""Where a picture is drawn: axes, zoom, wipe, the cursor, and the histogram beside it."""

import math
from typing import Any, Literal

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QImage, QKeyEvent, QPainter, QTransform
from PySide6.QtWidgets import QWidget

from app.editor.theme import Theme, theme_of
from app.editor.viewers.picture.picture_bar import LevelsBar
from app.editor.viewers.picture.picture_facts import Table, colour_table
from app.editor.viewers.picture.picture_query import Picture
from app.editor.viewers.picture.plots_below import PlotBelow
from app.editor.viewers.plot.plot_looks import PlotAxis, bare, paint_axes
from app.editor.widgets import is_escape
from core.modules.preview import signed

Zoom = tuple[float, ...]
Sides = Literal["first left", "second left", "second alone"]
"""Which of two pictures lies on which side of the wipe, or covers all."""
ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
_FAINT = 0.35
_WIPE_STEP = 0.01  # of the width, for a key


class PictureCanvas(pg.GraphicsLayoutWidget):  # type: ignore[misc]
    # place: the cursor is at a place of the axes, a tuple; None where it is on no picture
    pointed = Signal(object)
    stepped = Signal(int, int)  # columns, rows: an arrow key moves the probe
    band_stepped = Signal(int)  # by: a key shows the next band, or the one before
    # line, wavelength: the person drags a line among spectra: 0, or 0 to 2 for red, green and blue
    band_dragged = Signal(int, float)
    zoomed = Signal()  # the person sees another part of the picture
    # point: a right click, or the key for menus, at a point of the screen
    menu_wanted = Signal(QPoint)
    region_wanted = Signal()  # a key shows the region of a module
    recoloured = Signal()
    theme: Theme | None = None

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAccessibleName("Picture")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        above = self.fontMetrics().height() // 2  # half of the number at the picture's top
        self.ci.layout.setContentsMargins(2, above, 4, 2)
        self.ci.layout.setSpacing(4)
        self.axes = {side: PlotAxis(side) for side in ("left", "bottom")}
        self.plot = self.addPlot(row=0, col=0, enableMenu=False, axisItems=self.axes)
        bare(self.plot)
        self.view: pg.ViewBox = self.plot.getViewBox()
        self.view.invertY(True)
        self.view.setAspectLocked(True)
        self.view.disableAutoRange()
        self.first, self.second = PictureItem(), PictureItem()
        self.wipe = pg.InfiniteLine(angle=90, movable=True)
        self.cross = pg.ScatterPlotItem(symbol="crosshair", size=17)
        for item in (self.first, self.second, self.wipe, self.cross):
            self.plot.addItem(item)
        self.names = tuple(pg.TextItem(anchor=(share, 0)) for share in (0, 1))
        """The names of two pictures, in the upper corners of what is seen of them."""
        for name in self.names:
            name.setZValue(20)
            self.view.addItem(name, ignoreBounds=True)
        self.levels = LevelsBar()
        self.addItem(self.levels, row=0, col=1)
        self.below: dict[type[PlotBelow], PlotBelow] = {}
        """Plots below the picture, made once they are shown: that takes 10 ms each."""
        self.fitted = True
        self._picture: Picture | None = None
        self._place = QRectF()
        self.split = 0.5
        """Where the wipe lies, as a share of the width."""
        self._sides: Sides = "first left"
        self._colours = "grey"
        self.wipe.sigPositionChanged.connect(self._wiped)
        self.view.sigRangeChangedManually.connect(self._seen_otherwise)
        self.view.sigRangeChanged.connect(self._put_names)
        self.scene().sigMouseMoved.connect(self._mouse_moved)
        self.scene().sigMouseClicked.connect(self._clicked)
        self._take_colours()
        self.clear_picture()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if self.theme not in (None, theme_of(self)):
            self._take_colours()

    def _take_colours(self) -> None:
        self.theme = theme = theme_of(self)
        self.setBackground(theme.surround)
        paint_axes(self.plot, theme)
        self.levels.set_theme(theme)
        for plot in self.below.values():
            plot.set_theme(theme)
        for name in self.names:
            name.setColor(theme.text)
            name.fill = pg.mkBrush(theme.raised)
        self.wipe.setPen(theme.accent, width=2)
        self.wipe.setHoverPen(theme.changed, width=3)
        self.cross.setPen(theme.accent, width=2)
        self.cross.setBrush(None)
        self.recoloured.emit()

    def show_picture(self, picture: Picture) -> None:
        """Show a picture; the part that is seen stays, unless its axes are others."""
        place = picture.facts.extent
        shape = self._picture.facts.pixel_shape if self._picture is not None else None
        moved = place != self._place or picture.facts.pixel_shape != shape
        zoom = self._zoom_for(picture)
        self._picture, self._place = picture, place
        table = colour_table(self._colours)
        self.first.show_picture(picture, table, place)
        if picture.other is not None:
            self.second.show_picture(picture.other, table, place)
        self._divide()
        for item in (self.first, self.second):
            item.setOpacity(1.0)
        channels = tuple(channel.spread for channel in picture.channels)
        self.levels.show_spread(picture.spread, picture.levels, channels)
        for plot in self.below.values():
            plot.show_picture(picture)
        self.axes["bottom"].end_at(place.left(), place.right())
        self.axes["left"].end_at(place.top(), place.bottom())
        if moved:
            self.mark(None)
            self._place_elsewhere(picture, zoom)

    def clear_picture(self) -> None:
        self._picture = None
        self._place = QRectF()
        self.fitted = True
        for item in (self.first, self.second):
            item.clear()
        self._divide()
        self.mark(None)
        for plot in self.below.values():
            plot.show_picture(None)

    def shows(self, kind: type[PlotBelow]) -> bool:
        return kind in self.below and self.below[kind].shown

    def show_below(self, kind: type[PlotBelow], on: bool) -> None:
        if on == self.shows(kind):
            return
        if kind not in self.below:
            made: PlotBelow = kind(self)
            made.set_theme(theme_of(self))
            self.below[kind] = made
        plot = self.below[kind]
        plot.shown = on
        if on:
            self.addItem(plot, row=plot.row, col=0, colspan=2)
        else:
            self.ci.removeItem(plot)  # a hidden item would keep its room in the layout
        plot.show_picture(self._picture)

    def show_sides(self, sides: Sides, left: str = "", right: str = "") -> None:
        """Show two pictures so, and their names; what covers all has it on the left."""
        self._sides = sides
        for name, text in zip(self.names, (left, right), strict=True):
            name.setPlainText(text)
        self._divide()

    def make_faint(self) -> None:
        for item in (self.first, self.second):
            item.setOpacity(_FAINT)

    def set_colours(self, name: str) -> None:
        self._colours = name
        self.levels.set_colours(name)
        for item in (self.first, self.second):
            item.set_table(colour_table(name))

    def mark(self, place: tuple[float, float] | None) -> None:
        self.cross.setVisible(place is not None)  # an empty one takes time to paint, too
        self.cross.setData(*([], []) if place is None else ([place[0]], [place[1]]))

    def fit(self) -> None:
        self.fitted = True
        if not self._place.isEmpty():
            self.view.setRange(self._place, padding=0.0)

    def one_to_one(self) -> None:
        """Show each sample one dot of the screen wide, around the middle of what is seen."""
        if self._picture is None:
            return
        dots = self.view.width() * self.devicePixelRatioF()
        step = self._place.width() / self._picture.facts.columns
        self._see(self.view.viewRect().center(), dots * step)

    def zoom_by(self, factor: float) -> None:
        if self._picture is not None:
            seen = self.view.viewRect()
            self._see(seen.center(), seen.width() / factor)

    @property
    def zoom(self) -> Zoom | None:
        """Middle and width of what is seen, as shares of the picture; None where all is."""
        if self.fitted or self._place.isEmpty():
            return None
        seen, place = self.view.viewRect(), self._place
        middle = seen.center()
        return (
            (middle.x() - place.left()) / place.width(),
            (middle.y() - place.top()) / place.height(),
            seen.width() / place.width(),
        )

    def set_zoom(self, zoom: Zoom | None) -> None:
        if zoom is None or not zoom[2] > 0:
            self.fit()
        elif not self._place.isEmpty():
            (x, y, width), place = zoom, self._place
            middle = QPointF(place.left() + x * place.width(), place.top() + y * place.height())
            self._see(middle, width * place.width())

    def event(self, event: QEvent) -> bool:
        if is_escape(event) and self.levels.give_up():
            event.accept()
        return bool(super().event(event))

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.pointed.emit(None)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Open the menu for the key; a right click may also be the beginning of a drag."""
        if event.reason() is QContextMenuEvent.Reason.Keyboard:
            self.menu_wanted.emit(self.mapToGlobal(self.rect().center()))
            event.accept()
        else:
            super().contextMenuEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows: probe, with Ctrl the wipe; +, -, 0, F, Home, 1: zoom; Page: bands; R: region."""
        key = Qt.Key(event.key())
        step = ARROWS.get(key)
        far = 10 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        if step is not None and event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            if self.wipe.isVisible():
                self.set_split(self.split + step[0] * far * _WIPE_STEP)
        elif step is not None:
            self.stepped.emit(step[0] * far, step[1] * far)
        elif key == Qt.Key.Key_R:
            self.region_wanted.emit()
        elif key in (Qt.Key.Key_PageUp, Qt.Key.Key_PageDown):
            self.band_stepped.emit(far if key == Qt.Key.Key_PageUp else -far)
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal):
            self.zoom_by(1.25)
            self.zoomed.emit()
        elif key == Qt.Key.Key_Minus:
            self.zoom_by(0.8)
            self.zoomed.emit()
        elif key in (Qt.Key.Key_0, Qt.Key.Key_F, Qt.Key.Key_Home, Qt.Key.Key_1):
            (self.one_to_one if key == Qt.Key.Key_1 else self.fit)()
            self.zoomed.emit()
        else:
            super().keyPressEvent(event)
            return
        event.accept()

    def _place_elsewhere(self, picture: Picture, zoom: Zoom | None) -> None:
        facts = picture.facts
        self.plot.setLabel("bottom", facts.across.title)
        self.plot.setLabel("left", facts.along.title)
        self.view.setAspectLocked(True, facts.pixel_shape * facts.along.step / facts.across.step)
        self._put_wipe()
        self.set_zoom(zoom)

    def _zoom_for(self, picture: Picture) -> Zoom | None:
        """The same part as is seen now, where the picture has the same kind of axes."""
        before = self._picture
        if before is not None and before.facts.across.label != picture.facts.across.label:
            return None
        return self.zoom

    def _put_wipe(self) -> None:
        left, right = self._place.left(), self._place.right()
        with QSignalBlocker(self.wipe):
            self.wipe.setBounds((left, right))
            self.wipe.setValue(left + self.split * (right - left))
        self._divide()

    def _wiped(self) -> None:
        if self._place.width() > 0:
            self.split = (self.wipe.value() - self._place.left()) / self._place.width()
            self._divide()

    def _divide(self) -> None:
        picture, split = self._picture, self.split
        both = picture is not None and picture.other is not None
        parts: dict[Sides, tuple[float, float]] = {
            "first left": (split, 1.0),
            "second left": (0.0, split),
            "second alone": (0.0, 1.0),
        }
        start, end = parts[self._sides]
        divided = both and self._sides in ("first left", "second left")
        self.second.show_part(start, end)
        self.second.setVisible(both and end > start)
        self.wipe.setVisible(divided)
        for name in self.names:
            name.setVisible(both and bool(name.toPlainText()))
        self._put_names()

    def _put_names(self, *_: object) -> None:
        seen = self._place & self.view.viewRect()
        for name, corner in zip(self.names, (seen.topLeft(), seen.topRight()), strict=True):
            name.setPos(corner)

    def image(self) -> QImage:
        """The picture as it is drawn, a dot for each sample; of two, both sides and a divider."""
        shown = self.first.drawn()
        if self.second.isVisible():
            shown = shown.convertToFormat(QImage.Format.Format_RGB32)
            start, end = (round(share * shown.width()) for share in self.second.part)
            painter = QPainter(shown)
            painter.setClipRect(start, 0, end - start, shown.height())
            painter.drawImage(shown.rect(), self.second.drawn())
            if (start, end) != (0, shown.width()):  # or the file looks like one picture
                painter.fillRect(start or end - 1, 0, 1, shown.height(), theme_of(self).accent)
            painter.end()
        return shown

    def set_split(self, share: float) -> None:
        self.split = min(1.0, max(0.0, share))
        self._put_wipe()

    def _see(self, middle: QPointF, width: float) -> None:
        self.fitted = False
        # Of little height, so that it is the width that the view keeps when its shape changes.
        height = 1e-3 * width
        rect = QRectF(middle.x() - width / 2, middle.y() - height / 2, width, height)
        self.view.setRange(rect, padding=0.0)

    def _seen_otherwise(self) -> None:
        self.fitted = False
        self._keep_in_sight()
        self.zoomed.emit()

    def _keep_in_sight(self) -> None:
        """Let the middle of what is seen lie on the picture, wherever it is dragged to."""
        place, middle = self._place, self.view.viewRect().center()
        if place.isEmpty():
            return
        x = min(max(middle.x(), place.left()), place.right())
        y = min(max(middle.y(), place.top()), place.bottom())
        if (x, y) != (middle.x(), middle.y()):
            self.view.translateBy(x=x - middle.x(), y=y - middle.y())

    def _clicked(self, event: Any) -> None:
        if event.button() is Qt.MouseButton.RightButton and not event.isAccepted():
            self.menu_wanted.emit(event.screenPos().toPoint())

    def _mouse_moved(self, point: QPointF) -> None:
        if self._picture is None or not self.view.sceneBoundingRect().contains(point):
            self.pointed.emit(None)
            return
        place = self.view.mapSceneToView(point)
        inside = self._place.contains(place)
        self.pointed.emit((place.x(), place.y()) if inside else None)


# A picture as an item of a plot: 8-bit levels with a table of colours, or colours of its own.

WITH_NUMBERS_PX = 40.0  # wide on the screen, from which a pixel has its value written on it
_LETTERS_A_PIXEL, _LARGEST_NUMBER_PX = 5.0, 15.0


class PictureItem(pg.ImageItem):  # type: ignore[misc]
    def __init__(self) -> None:
        super().__init__(axisOrder="row-major")
        self.part = (0.0, 1.0)
        self._samples: NDArray[Any] | None = None  # None of a composite: it has three at a place

    def show_picture(self, picture: Picture, table: Table, place: QRectF) -> None:
        self._samples = None if picture.channels else picture.samples
        self.setImage(picture.grey, autoLevels=False, levels=None, lut=_lookup(table, picture.grey))
        self.setRect(place)

    def drawn(self) -> QImage:
        self.render()
        drawn: QImage = self.qimage
        return drawn

    def set_table(self, table: Table) -> None:
        self.setLookupTable(_lookup(table, self.image))

    def show_part(self, start: float, end: float) -> None:
        if (start, end) != self.part:
            self.part = start, end
            self.update()

    def paint(self, painter: QPainter, *args: Any) -> None:
        if self.part == (0.0, 1.0):
            self._paint_all(painter, *args)
            return
        bounds, (start, end) = self.boundingRect(), self.part
        left, width = bounds.left(), bounds.width()
        bounds.setLeft(left + start * width)
        bounds.setRight(left + end * width)
        painter.save()
        painter.setClipRect(bounds)
        self._paint_all(painter, *args)
        painter.restore()

    def _paint_all(self, painter: QPainter, *args: Any) -> None:
        super().paint(painter, *args)
        to_screen = painter.worldTransform()
        wide = min(abs(to_screen.m11()), abs(to_screen.m22()))
        if self._samples is None or wide < WITH_NUMBERS_PX:
            return
        seen = self.mapFromScene(self.getViewBox().sceneBoundingRect()).boundingRect()
        painter.save()
        painter.setWorldTransform(QTransform())
        font = painter.font()
        font.setPixelSize(round(min(wide / _LETTERS_A_PIXEL, _LARGEST_NUMBER_PX)))
        painter.setFont(font)
        rows, columns = self._samples.shape
        for row in range(max(0, int(seen.top())), min(rows, math.ceil(seen.bottom()))):
            for column in range(max(0, int(seen.left())), min(columns, math.ceil(seen.right()))):
                dark = self._is_dark(row, column)
                painter.setPen(Qt.GlobalColor.white if dark else Qt.GlobalColor.black)
                box = to_screen.mapRect(QRectF(column, row, 1, 1))
                painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self.number_at(row, column))
        painter.restore()

    def number_at(self, row: int, column: int) -> str:
        """A sample in the few digits that fit on its pixel."""
        assert self._samples is not None
        return signed(f"{self._samples[row, column]:.3g}")

    def _is_dark(self, row: int, column: int) -> bool:
        level = self.image[row, column]
        colour = level if self.lut is None else self.lut[level][:3]
        return float(np.mean(colour)) < 128


def _lookup(table: Table, levels: Any) -> Table | None:
    """Levels that are greys already, or colours, need no table, and are shown faster without."""
    is_colour = levels is not None and levels.ndim == 3
    return None if is_colour or table is colour_table("grey") else table
