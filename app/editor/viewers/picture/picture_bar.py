"""The controls above a picture, and its histogram with the levels."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import zip_longest

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QActionGroup, QPainter, QValidator
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QMenu, QSlider, QSpinBox, QWidget

from app.editor.session import Session
from app.editor.theme import FAINT, Theme, set_ink, theme_of
from app.editor.viewers.pixels.grey_levels import NAMES, Range, Spread, colour_map
from app.editor.viewers.pixels.picture_facts import ALL, CHANNELS, BandChoice
from app.editor.viewers.plot.plot_looks import paint_axis, see_through
from app.editor.viewers.viewer import PICTURE_TYPES, NodePorts, PortChoice
from app.editor.widgets import (
    ElidedLabel,
    Menu,
    filled,
    labelled,
    menu_button,
    tool_button,
)
from core.chain.band_stack import BandStack


class PictureBar(QWidget):
    opening = Signal()  # the menu of other wires and viewers is about to open

    def __init__(self, session: Session, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.ports = PortChoice(session, PICTURE_TYPES, "no wire", self)
        self.ports.setObjectName(f"{owner}.port")
        self.ports.setAccessibleName("Wire to show")
        shown = menu_button(f"{owner}.display", "Display", "How the picture is drawn", self)
        compared = menu_button(f"{owner}.compare", "Compare", "Compare with another wire", self)
        self.display = DisplayMenu(shown.menu())
        self.compare = CompareMenu(compared.menu())
        self.display.histogram.setChecked(True)
        self.display.shape.setChecked(True)
        self.display.spectra.setChecked(True)
        compared.menu().aboutToShow.connect(self.opening)
        self.menus = (shown.menu(), compared.menu())
        for menu, title in zip(self.menus, ("&Display", "&Compare"), strict=True):
            menu.setTitle(title)
        self.fit = tool_button(f"{owner}.fit", "Fit", "Show the whole picture (F or 0)", self)
        self.dots = tool_button(f"{owner}.dots", "1:1", "Show each sample as one dot (1)", self)
        about = "Show the region of the selected module (R); drag it or its corners"
        self.region = tool_button(f"{owner}.region", "⬚", about, self)
        parts = ((self.ports, 1), shown, compared, self.region, self.fit, self.dots)
        filled(QHBoxLayout(self), *parts, margins=(2, 2, 2, 0), spacing=3)


# The menus of an image viewer: how the picture is drawn, and what it is compared with.

MAPPINGS = {"linear": "&Linear", "log": "Lo&garithm", "spectrum": "Centred &Spectrum"}
LEVELS = {
    "extremes": "&Least to Greatest",
    "percentiles": "&0.5 % to 99.5 %",
    "manual": "&As Set in the Histogram",
}
MODES = {"alone": "&Alone", "wipe": "&Wipe", "difference": "&Difference"}


class Radio(QObject):
    chosen = Signal(str)  # name: the person has chosen another

    def __init__(self, menu: QMenu, texts: Mapping[str, str]) -> None:
        super().__init__(menu)
        self._group = QActionGroup(self)
        self._actions: dict[str, QAction] = {}
        for name, text in texts.items():
            action = QAction(text, self._group, checkable=True)
            action.setObjectName(name)
            action.setData(name)
            menu.addAction(action)
            self._actions[name] = action
        self._group.triggered.connect(lambda action: self.chosen.emit(str(action.data())))

    def choose(self, name: str) -> None:
        self._actions[name].setChecked(True)


class DisplayMenu(QObject):
    def __init__(self, menu: QMenu) -> None:
        super().__init__(menu)
        menu.addSection("Samples")
        self.mapping = Radio(menu, MAPPINGS)
        menu.addSection("Black to white")
        self.levels = Radio(menu, LEVELS)
        menu.addSeparator()
        colours = Menu("&Colours", menu)
        menu.addMenu(colours)
        self.colours = Radio(colours, NAMES)
        self.shape = self._toggle(menu, "shape", "&True Shape of Pixels")
        self.histogram = self._toggle(menu, "histogram", "&Histogram")
        self.profile = self._toggle(menu, "profile", "Line &Profile")
        self.means = self._toggle(menu, "means", "&Means of Rows and Columns")
        self.spectra = self._toggle(menu, "spectra", "Spectrum over &Wavelength")

    def _toggle(self, menu: QMenu, name: str, text: str) -> QAction:
        action = QAction(text, menu, checkable=True)
        action.setObjectName(name)
        menu.addAction(action)
        return action


class CompareMenu(QObject):
    other_chosen = Signal(str)  # port: the other wire
    linked = Signal(int, bool)  # number, on: whether to move with the viewer of that number

    def __init__(self, menu: QMenu) -> None:
        super().__init__(menu)
        self.menu = menu
        menu.addSection("Show")
        self.mode = Radio(menu, MODES)
        menu.addSeparator()
        self.others = Menu("With &Other Wire", menu)
        menu.addMenu(self.others)
        self.others.setObjectName("others")
        self.others.triggered.connect(self._choose_other)
        self.links = Menu("&Move With", menu)
        menu.addMenu(self.links)
        self.links.setObjectName("links")
        self.links.triggered.connect(self._choose_link)

    def fill_others(self, groups: Iterable[NodePorts], chosen: str | None) -> None:
        self._empty(self.others)
        for group in groups:
            menu = Menu(group.node.replace("&", "&&"), self.others)
            self.others.addMenu(menu)
            for port in group.ports:
                action = menu.addAction(port.rpartition(".")[2].replace("&", "&&"))
                action.setData(port)
                action.setCheckable(True)
                action.setChecked(port == chosen)
        self.others.setEnabled(not self.others.isEmpty())

    def fill_links(self, viewers: Mapping[int, bool]) -> None:
        self._empty(self.links)
        for number, linked in viewers.items():
            action = self.links.addAction(f"Viewer &{number}")
            action.setData(number)
            action.setCheckable(True)
            action.setChecked(linked)
        self.links.setEnabled(not self.links.isEmpty())

    @staticmethod
    def _empty(menu: QMenu) -> None:
        for action in menu.actions():
            inner = action.menu()
            menu.removeAction(action)
            (inner if isinstance(inner, QMenu) else action).deleteLater()

    def _choose_other(self, action: QAction) -> None:
        self.other_chosen.emit(str(action.data()))

    def _choose_link(self, action: QAction) -> None:
        self.linked.emit(int(action.data()), action.isChecked())


_TEXTS = {"all": "All bands: {whole}", "one": "One band", "colours": "Colours"}

_NARROWEST = 9  # letters that a list or a wavelength has room for


class BandBar(QWidget):
    """All bands, one by a slider or its wavelength, or three as colours; hidden without bands."""

    chosen = Signal(object)  # choice: the person has made another `BandChoice`
    noted = Signal(str)  # text: a line for the person: a typed wavelength is none of the picture's
    _letters: tuple[QLabel, ...] = ()

    def __init__(self, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.choice = ALL
        self._bands: BandStack | None = None
        self._writing = False
        self.shown = QComboBox(self)
        self.shown.setObjectName(f"{owner}.bands")
        self.shown.setAccessibleName("Bands to show")
        self.shown.setToolTip("Bands to show: all together, one, or three as colours")
        for name, text in _TEXTS.items():
            self.shown.addItem(text.format(whole="mean"), name)
        self.slider = QSlider(Qt.Orientation.Horizontal, self)
        self.slider.setObjectName(f"{owner}.band")
        self.slider.setAccessibleName("Band")
        self.slider.setToolTip("Band (Page Up and Page Down on the picture)")
        self.one = WavelengthSpin(f"{owner}.wavelength", "Wavelength of the band (µm or nm)", self)
        self.colours = tuple(
            WavelengthSpin(f"{owner}.{name}", f"Wavelength shown as {name}", self)
            for name in CHANNELS
        )
        self._letters = tuple(QLabel(name[0].upper(), self) for name in CHANNELS)
        self.even = tool_button(f"{owner}.even", "Even", "Use three evenly spaced bands", self)
        self.about = ElidedLabel(f"{owner}.band.about", "The bands", self)
        self.about.setForegroundRole(FAINT)
        letter = self.fontMetrics().averageCharWidth()
        for widget in (self.shown, self.one, *self.colours):  # a narrow viewer cuts their texts
            widget.setMinimumWidth(_NARROWEST * letter)
        self._lay()
        self.shown.activated.connect(
            lambda _: self._choose(replace(self.choice, shown=self.shown.currentData()))
        )
        self.slider.valueChanged.connect(self._one_chosen)
        self.one.valueChanged.connect(self._one_chosen)
        self.even.clicked.connect(lambda: self._choose(replace(self.choice, colours_um=None)))
        for spin in self.colours:
            spin.valueChanged.connect(self._colours_chosen)
        for spin in (self.one, *self.colours):
            spin.noted.connect(self.noted)
        self._colour()
        self.hide()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._colour()

    def _colour(self) -> None:
        for letter, colour in zip(self._letters, theme_of(self).channels, strict=False):
            set_ink(letter, colour)

    def show_bands(self, bands: BandStack | None, choice: BandChoice) -> None:
        self._bands, self.choice = bands, choice
        self.setVisible(bands is not None)
        if bands is None:
            return
        self._writing = True
        whole = "sum" if bands.density else "mean"
        self.shown.setItemText(0, _TEXTS["all"].format(whole=whole))
        self.shown.setCurrentIndex(self.shown.findData(choice.shown))
        self.slider.setRange(0, bands.count - 1)
        self.slider.setPageStep(max(1, bands.count // 10))
        (place,) = replace(choice, shown="one").places(bands)
        self.slider.setValue(place)
        places = (place, *replace(choice, shown="colours").places(bands))
        for spin, at in zip((self.one, *self.colours), places, strict=True):
            spin.set_bands(bands)
            spin.setValue(at)
        self._writing = False
        of_one: tuple[QWidget, ...] = (self.slider, self.one)
        of_colours: tuple[QWidget, ...] = (*self.colours, *self._letters, self.even)
        for widget in (*of_one, *of_colours):
            widget.setVisible(choice.shown == ("one" if widget in of_one else "colours"))
        self.even.setEnabled(choice.colours_um is not None)
        self.about.show_text(_about(bands, choice, place))

    def step(self, by: int) -> None:
        """Show the next band, or the one before; from all of them go to the first, or the last."""
        if self._bands is None:
            return
        if self.choice.shown == "one":
            self.slider.setValue(self.slider.value() + by)
        elif self.choice.shown == "all":
            centres = self._bands.centres_um
            self._choose(replace(self.choice, shown="one", one_um=centres[0 if by > 0 else -1]))

    def take_line(self, line: int, wavelength_um: float) -> None:
        """Take the band at a wavelength: the one, or the red, green or blue."""
        if self.choice.shown == "one":
            self._choose(replace(self.choice, one_um=wavelength_um))
        elif self.choice.shown == "colours":
            now = [spin.value() for spin in self.colours]
            self._choose_colours(now, {line: wavelength_um})

    def _lay(self) -> None:
        layout = QHBoxLayout(self)
        layout.setContentsMargins(2, 0, 2, 0)
        layout.setSpacing(3)
        layout.addWidget(self.shown)
        layout.addWidget(self.slider, 3)
        layout.addWidget(self.one)
        for letter, spin in zip(self._letters, self.colours, strict=True):
            letter.setBuddy(spin)
            layout.addSpacing(3)
            layout.addWidget(letter)
            layout.addWidget(spin)
        layout.addWidget(self.even)
        layout.addSpacing(3)
        layout.addWidget(self.about, 1)

    def _one_chosen(self, place: int) -> None:
        if self._bands is not None and not self._writing:
            self._choose(replace(self.choice, one_um=self._bands.centres_um[place]))

    def _colours_chosen(self, _place: int) -> None:
        if not self._writing:
            self._choose_colours([spin.value() for spin in self.colours], {})

    def _choose_colours(self, places: list[int], changed: dict[int, float]) -> None:
        if self._bands is None:
            return
        red, green, blue = (
            changed.get(line, self._bands.centres_um[place]) for line, place in enumerate(places)
        )
        self._choose(replace(self.choice, colours_um=(red, green, blue)))

    def _choose(self, choice: BandChoice) -> None:
        if choice != self.choice:
            self.show_bands(self._bands, choice)
            self.chosen.emit(choice)


def _about(bands: BandStack, choice: BandChoice, place: int) -> str:
    if choice.shown == "one":
        return f"{bands.widths_um[place]:.3g} µm wide, {place + 1} of {bands.count}"
    low, high = bands.band_um
    return f"{bands.count} bands, {low:.4g} to {high:.4g} µm" if choice.shown == "all" else ""


# A spin box that steps through the bands of a picture, and shows their wavelengths.

_FEWEST, _MOST = 2, 5  # decimals
UNIT = "µm"
_UNITS = {UNIT: 1.0, "μm": 1.0, "um": 1.0, "nm": 1e-3}  # micro sign, Greek mu


class WavelengthSpin(QSpinBox):
    """Its value is the place of a band; a wavelength typed in µm or nm gives the nearest."""

    noted = Signal(str)  # text: a line for the person: a typed wavelength is none of the picture's

    _centres: tuple[float, ...] = (0.0,)  # Qt measures texts while it makes the widget
    _decimals = _FEWEST
    _ends = (-math.inf, math.inf)

    def __init__(self, name: str, description: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setRange(0, 0)
        labelled(self, name, description, description)
        self.setKeyboardTracking(False)
        self._text = ""
        self.lineEdit().textEdited.connect(self._note)
        self.editingFinished.connect(self._finish)

    def set_bands(self, bands: BandStack) -> None:
        self._ends, centres_um = bands.band_um, bands.centres_um
        if centres_um == self._centres:
            return
        self._centres = centres_um
        self._decimals = decimals_of(centres_um)
        self.setRange(0, len(centres_um) - 1)
        self.updateGeometry()

    def textFromValue(self, place: int) -> str:
        place = min(place, len(self._centres) - 1)
        return f"{self._centres[place]:.{self._decimals}f} {UNIT}"

    def valueFromText(self, text: str) -> int:
        wavelength = _number(text)
        if wavelength is None:
            return self.value()
        return int(np.argmin(np.abs(np.array(self._centres) - wavelength)))

    def validate(self, text: str, position: int) -> object:
        state = QValidator.State
        return (state.Intermediate if _number(text) is None else state.Acceptable, text, position)

    def _note(self, text: str) -> None:
        self._text = text

    def _finish(self) -> None:
        text, self._text = self._text, ""
        wavelength = _number(text)
        low, high = self._ends
        if wavelength is not None and not low <= wavelength <= high:
            self.noted.emit(
                f"{wavelength:.4g} µm is outside the bands, {low:.4g} to {high:.4g} µm: the "
                "nearest band is shown"
            )


def decimals_of(centres_um: tuple[float, ...]) -> int:
    """As many as tell neighbouring bands apart, and one more."""
    apart = np.abs(np.diff(centres_um))
    least = float(apart[apart > 0].min()) if np.any(apart > 0) else 1.0
    return min(max(math.ceil(-math.log10(least)) + 1, _FEWEST), _MOST)


def _number(text: str) -> float | None:
    """A wavelength in µm, typed in it or in a unit that stands behind it."""
    bare = text.replace(",", ".").strip()
    factor = 1.0
    for unit, in_um in _UNITS.items():
        if bare.endswith(unit):
            bare, factor = bare.removesuffix(unit), in_um
            break
    try:
        value = float(bare) * factor
    except ValueError:
        return None
    return value if math.isfinite(value) else None


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
    released = Signal()  # the person has let them go

    def __init__(self) -> None:
        with without_matplotlib():
            super().__init__()
        self._writing = False
        self._spread: Range | None = None
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

    @property
    def is_behind(self) -> bool:
        return self._next is not None

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
            self._writing = True
            self.setLevels(*levels)
            self._writing = False

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

    def _levels_changed(self) -> None:
        if not self._writing:
            low, high = self.getLevels()
            self.dragged.emit(float(low), float(high))

    def _level_change_finished(self) -> None:
        if not self._writing:
            self.released.emit()


def _bars(spread: Spread, ends: Range) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bars = np.log1p(spread.counts.astype(np.float64))
    bars /= max(1.0, float(bars.max()))
    centres = spread.centres if spread.high > spread.low else np.linspace(*ends, len(bars))
    return centres, bars


# Keeping pyqtgraph from loading all of matplotlib for a menu that is never opened.

_NAME = "matplotlib"


@contextlib.contextmanager
def without_matplotlib() -> Iterator[None]:
    """Make matplotlib seem not to be installed, unless it has been loaded already.

    A histogram of pyqtgraph lists matplotlib's colour maps in the menu of its gradient, which takes
    a third of a second of the time until the first picture.
    """
    if _NAME in sys.modules:
        yield
        return
    sys.modules[_NAME] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[_NAME]
