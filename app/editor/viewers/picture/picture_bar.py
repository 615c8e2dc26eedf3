"""The controls above a picture, and its histogram with the levels."""

import sys
from collections.abc import Collection, Mapping
from functools import partial
from itertools import zip_longest
from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QActionGroup, QPainter
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QMenu, QSlider, QWidget

from app.editor.session import Session
from app.editor.theme import FAINT, Theme
from app.editor.viewers.picture.picture_facts import (
    ALL,
    CHANNELS,
    NAMES,
    BandChoice,
    Range,
    Spread,
    colour_map,
)
from app.editor.viewers.plot.plot_looks import paint_axis, see_through
from app.editor.viewers.viewer import PICTURE_TYPES, PortChoice
from app.editor.widgets import ElidedLabel, Menu, filled, labelled, menu_button, tool_button
from core.chain.band_stack import BandStack
from core.records import replace

MAPPINGS = {"linear": "&Linear", "log": "Lo&garithm", "spectrum": "Centred &Spectrum"}
LEVELS = {
    "extremes": "&Minimum to Maximum",
    "percentiles": "&0.5 % to 99.5 %",
    "manual": "&As Set in the Histogram",
}
MODES = {"alone": "&Alone", "wipe": "&Wipe", "difference": "&Difference"}


class PictureBar(QWidget):
    def __init__(self, session: Session, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.ports = PortChoice(session, PICTURE_TYPES, "no wire", self)
        self.ports.setObjectName(f"{owner}.port")
        self.ports.setAccessibleName("Wire to show")
        shown = menu_button(f"{owner}.display", "Display", "How the picture is drawn", self)
        compared = menu_button(f"{owner}.compare", "Compare", "Compare with another wire", self)
        self.menus = display, compare = shown.menu(), compared.menu()
        display.setTitle("&Display")
        display.addSection("Samples")
        self.mapping = Radio(display, MAPPINGS)
        display.addSection("Black to white")
        self.levels = Radio(display, LEVELS)
        display.addSeparator()
        self.colours = Radio(_inner(display, "", "&Colours"), NAMES)
        self.histogram = _toggle(display, "histogram", "&Histogram", on=True)
        self.profile = _toggle(display, "profile", "Line &Profile")
        self.means = _toggle(display, "means", "M&eans of Rows and Columns")
        self.spectra = _toggle(display, "spectra", "Spectrum over &Wavelength", on=True)
        compare.setTitle("&Compare")
        compare.addSection("Show")
        self.mode = Radio(compare, MODES)
        compare.addSeparator()
        self.others = _inner(compare, "others", "With &Other Wire")
        self.links = _inner(compare, "links", "&Move With")
        self.fit = tool_button(f"{owner}.fit", "Fit", "Show the whole picture (F or 0)", self)
        self.dots = tool_button(
            f"{owner}.dots", "1:1", "Show each sample as one screen pixel (1)", self
        )
        about = "Show the region of the selected module (R); drag the region or a corner"
        self.region = tool_button(f"{owner}.region", "⬚", about, self)
        parts = ((self.ports, 1), shown, compared, self.region, self.fit, self.dots)
        filled(QHBoxLayout(self), *parts, margins=(2, 2, 2, 0), spacing=3)


class Radio(QActionGroup):
    chosen = Signal(str)  # name: the person has chosen another

    def __init__(self, menu: QMenu, texts: Mapping[str, str]) -> None:
        super().__init__(menu)
        for name, text in texts.items():
            QAction(text, self, checkable=True).setObjectName(name)
        menu.addActions(self.actions())
        self.triggered.connect(lambda action: self.chosen.emit(action.objectName()))

    def choose(self, name: str) -> None:
        next(one for one in self.actions() if one.objectName() == name).setChecked(True)


def _inner(menu: QMenu, name: str, title: str) -> QMenu:
    inner = labelled(Menu(title, menu), name)
    menu.addMenu(inner)
    return inner


def _toggle(menu: QMenu, name: str, text: str, *, on: bool = False) -> QAction:
    action = QAction(text, menu, checkable=True, checked=on)
    action.setObjectName(name)
    menu.addAction(action)
    return action


def list_choices(menu: QMenu, entries: Mapping[str, object], ticked: Collection[object]) -> None:
    menu.clear()
    for text, data in entries.items():
        action = menu.addAction(text.replace("&", "&&"))
        action.setData(data)
        action.setCheckable(True)
        action.setChecked(data in ticked)
    menu.setEnabled(bool(entries))


_TEXTS = {"all": "All bands: {whole}", "one": "One band", "colours": "Colours"}


class BandBar(QWidget):
    """All bands, one by a slider or its wavelength, or three as colours; hidden without bands."""

    chosen = Signal(object)  # choice: the person has made another `BandChoice`

    def __init__(self, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.choice = ALL
        self._bands: BandStack | None = None
        about = "Bands to show: all together, one, or three as colours"
        self.shown = _short_list(f"{owner}.bands", about, self)
        for name in _TEXTS:
            self.shown.addItem("", name)
        about = "Band (Page Up and Page Down on the picture)"
        self.slider = labelled(
            QSlider(Qt.Orientation.Horizontal, self), f"{owner}.band", "Band", about
        )
        self.one = _short_list(f"{owner}.wavelength", "Wavelength of the band", self)
        self.colours = tuple(
            _short_list(f"{owner}.{name}", f"Wavelength shown as {name}", self) for name in CHANNELS
        )
        self.even = tool_button(f"{owner}.even", "Even", "Use three evenly spaced bands", self)
        self.about = ElidedLabel(f"{owner}.band.about", "The bands", self)
        self.about.setForegroundRole(FAINT)
        parts: tuple[Any, ...] = (self.shown, (self.slider, 3), self.one, *self.colours)
        layout = QHBoxLayout(self)
        filled(layout, *parts, self.even, (self.about, 1), margins=(2, 0, 2, 0), spacing=4)
        self.shown.activated.connect(lambda _: self._choose(shown=self.shown.currentData()))
        self.slider.valueChanged.connect(self._take_one)
        self.one.activated.connect(self._take_one)
        for number, colour in enumerate(self.colours):
            colour.activated.connect(partial(self._take_colour, number))
        self.even.clicked.connect(lambda: self._choose(colours_um=None))
        self.hide()

    def show_bands(self, bands: BandStack | None, choice: BandChoice) -> None:
        before, self._bands, self.choice = self._bands, bands, choice
        self.setVisible(bands is not None)
        if bands is None:
            return
        lists = (self.one, *self.colours)
        if before is None or before.centres_um != bands.centres_um:
            for each, letter in zip(lists, ("", "R  ", "G  ", "B  "), strict=True):
                each.clear()
                each.addItems([f"{letter}{centre:.5g} µm" for centre in bands.centres_um])
        whole = "sum" if bands.density else "mean"
        for number, text in enumerate(_TEXTS.values()):
            self.shown.setItemText(number, text.format(whole=whole))
        self.shown.setCurrentIndex(self.shown.findData(choice.shown))
        (place,) = replace(choice, shown="one").places(bands)
        with QSignalBlocker(self.slider):
            self.slider.setRange(0, bands.count - 1)
            self.slider.setPageStep(max(1, bands.count // 10))
            self.slider.setValue(place)
        places = (place, *replace(choice, shown="colours").places(bands))
        for each, at in zip(lists, places, strict=True):
            each.setCurrentIndex(at)
        for one in (self.slider, self.one):
            one.setVisible(choice.shown == "one")
        for widget in (*self.colours, self.even):
            widget.setVisible(choice.shown == "colours")
        self.even.setEnabled(choice.colours_um is not None)
        self.about.show_text(_about(bands, choice, place))

    def step(self, by: int) -> None:
        """Show the next band, or the one before; from all of them go to the first, or the last."""
        if self._bands is not None and self.choice.shown == "one":
            self.slider.setValue(self.slider.value() + by)
        elif self._bands is not None and self.choice.shown == "all":
            self._choose(shown="one", one_um=self._bands.centres_um[0 if by > 0 else -1])

    def take_line(self, line: int, wavelength_um: float) -> None:
        """Take the band at a wavelength: the one, or the red, green or blue."""
        if self.choice.shown == "one":
            self._choose(one_um=wavelength_um)
        elif self._bands is not None and self.choice.shown == "colours":
            now = [self._bands.centres_um[each.currentIndex()] for each in self.colours]
            now[line] = wavelength_um
            self._choose(colours_um=tuple(now))

    def _take_one(self, place: int) -> None:
        if self._bands is not None:
            self._choose(one_um=self._bands.centres_um[place])

    def _take_colour(self, number: int, place: int) -> None:
        if self._bands is not None:
            self.take_line(number, self._bands.centres_um[place])

    def _choose(self, **changes: Any) -> None:
        choice = replace(self.choice, **changes)
        if choice != self.choice:
            self.show_bands(self._bands, choice)
            self.chosen.emit(choice)


def _short_list(name: str, about: str, parent: QWidget) -> QComboBox:
    """A list that a narrow viewer may cut."""
    made = labelled(QComboBox(parent), name, about, about)
    made.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    made.setMinimumContentsLength(9)
    return made


def _about(bands: BandStack, choice: BandChoice, place: int) -> str:
    if choice.shown == "one":
        return f"{bands.widths_um[place]:.3g} µm wide, band {place + 1} of {bands.count}"
    low, high = bands.band_um
    return f"{bands.count} bands, {low:.4g} to {high:.4g} µm" if choice.shown == "all" else ""


SPREAD_MS = 100
"""While pictures follow one another, the histogram is drawn at most so often.

It takes more than the picture does: 2.9 ms of 5.2.
"""
_WIDTH = 60
_ROOM = 0.06  # beside the histogram at both ends, of its length
_FILLED = 0.8  # of the axis, by the histogram: else the axis is fitted anew


class LevelsBar(pg.HistogramLUTItem):  # type: ignore[misc]
    """Shows a histogram made elsewhere, as logarithms: so rare samples are seen, too."""

    dragged = Signal(float, float)  # low, high: the person drags the levels
    ended = Signal(bool)  # the drag is over; whether it was given up

    def __init__(self) -> None:
        hidden = "matplotlib" not in sys.modules
        if hidden:  # else it loads, a second, for a menu of colours that is never opened
            sys.modules["matplotlib"] = None  # type: ignore[assignment]
        super().__init__()
        if hidden:
            del sys.modules["matplotlib"]
        self._writing = False
        self._spread: Range | None = None
        self._before: Range = 0.0, 1.0  # the levels before the drag
        self._next: tuple[Spread, Range, tuple[Spread, ...]] | None = None
        self._pause = QTimer(singleShot=True, interval=SPREAD_MS)
        self._pause.timeout.connect(self._show_next)
        self.vb.setMaximumWidth(_WIDTH)
        self.vb.setMenuEnabled(False)
        self.vb.setMouseEnabled(x=False, y=False)
        self.gradient.setEnabled(False)
        self.gradient.showTicks(False)
        self.axis.enableAutoSIPrefix(False)
        self.disableAutoHistogramRange()
        self._channels = self.plots[1:4]
        for plot in self._channels:
            plot.setFillLevel(None)
            plot.setCompositionMode(QPainter.CompositionMode.CompositionMode_SourceOver)
        # The curve is turned: its bars grow to the left of zero, up to 1.
        self.vb.setXRange(-1.02, 0.0, padding=0.0)
        self.sigLevelsChanged.connect(self._levels_changed)
        self.sigLevelChangeFinished.connect(self._level_change_finished)

    def give_up(self) -> bool:
        """Let go of what is dragged; whether anything was."""
        held = [part for part in (*self.region.lines, self.region) if part.moving]
        for part in held:
            part.moving = False
        if held:
            self._write(self._before)
            self.ended.emit(True)
        return bool(held)

    def set_theme(self, theme: Theme) -> None:
        paint_axis(self.axis, theme)
        self.plot.setPen(theme.faint_text)
        self.plot.setBrush(see_through(theme.faint_text, 110))
        for plot, colour in zip(self._channels, theme.channels, strict=True):
            plot.setPen(colour)
        self.region.setBrush(see_through(theme.accent, 50))
        self.region.setHoverBrush(see_through(theme.accent, 90))
        for line in self.region.lines:
            line.setPen(theme.accent)
            line.setHoverPen(theme.text)

    def set_colours(self, name: str) -> None:
        self.gradient.setColorMap(colour_map(name))
        self.gradient.showTicks(False)

    def show_spread(self, spread: Spread, levels: Range, channels: tuple[Spread, ...] = ()) -> None:
        """Show a histogram, of colours three lines, in a while; levels unless they are dragged."""
        self._next = spread, levels, channels
        if not self._pause.isActive():
            self._show_next()

    def _show_next(self) -> None:
        if self._next is None:
            return
        (spread, levels, channels), self._next = self._next, None
        self._pause.start()
        low, high = spread.low, spread.high
        if not high > low:
            reach = abs(low) * 1e-3 or 1.0
            low, high = low - reach, high + reach
        ends = low, high
        if channels:
            self.plot.setData([], [])
        else:
            self.plot.setData(*_bars(spread, ends))
        for plot, channel in zip_longest(self._channels, channels):
            plot.setData(*(_bars(channel, ends) if channel is not None else ([], [])))
        self._see(low, high, levels)
        if not any(line.moving for line in (*self.region.lines, self.region)):
            self._write(levels)
            self._before = levels

    def _see(self, low: float, high: float, levels: Range) -> None:
        """Keep histogram and levels in view, without jumping while levels or sliders are dragged.

        The axis stays as it is where that fits nearly as well: to draw it takes a millisecond.
        """
        if (low, high) == self._spread:
            return
        self._spread = low, high
        bottom, top = min(low, levels[0]), max(high, levels[1])
        first, last = self.vb.viewRange()[1]
        least = _FILLED * (last - first)
        if first <= bottom and top <= last and top - bottom >= least:
            return
        self.setHistogramRange(bottom, top, padding=_ROOM)

    def _write(self, levels: Range) -> None:
        self._writing = True
        self.setLevels(*levels)
        self._writing = False

    def _level_change_finished(self) -> None:
        if not self._writing:
            self._before = self.getLevels()
            self.ended.emit(False)

    def _levels_changed(self) -> None:
        if not self._writing:
            low, high = self.getLevels()
            self.dragged.emit(float(low), float(high))


def _bars(spread: Spread, ends: Range) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bars = np.log1p(spread.counts.astype(np.float64))
    bars /= max(1.0, float(bars.max()))
    centres = spread.centres if spread.high > spread.low else np.linspace(*ends, len(bars))
    return centres, bars
