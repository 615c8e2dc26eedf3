"""The controls above a picture."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QHBoxLayout, QMenu, QWidget

from app.editor.session import Session
from app.editor.viewers.network_ports import PICTURE_TYPES, NodePorts, PortChoice
from app.editor.viewers.pixels.grey_levels import NAMES
from app.editor.widgets import Menu, filled, menu_button, toggle_button, tool_button


class PictureBar(QWidget):
    """Wire, menus and zoom of an image viewer."""

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
        self.region = toggle_button(
            f"{owner}.region", "⬚", "Draw the region of the selected module (R)", self
        )
        layout = filled(QHBoxLayout(self), margins=(2, 2, 2, 0), spacing=3)
        for widget in (self.ports, shown, compared, self.region, self.fit, self.dots):
            layout.addWidget(widget, 1 if widget is self.ports else 0)


# The menus of an image viewer: how the picture is drawn, and what it is compared with.

MAPPINGS = {"linear": "&Linear", "log": "Lo&garithm", "spectrum": "Centred &Spectrum"}
LEVELS = {
    "extremes": "&Least to Greatest",
    "percentiles": "&0.5 % to 99.5 %",
    "manual": "&As Set in the Histogram",
}
MODES = {"alone": "&Alone", "wipe": "&Wipe", "difference": "&Difference"}


class Radio(QObject):
    """Actions of a menu of which one is chosen."""

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
        self._group.triggered.connect(self._triggered)

    def choose(self, name: str) -> None:
        """Mark one as chosen, without a signal."""
        self._actions[name].setChecked(True)

    def _triggered(self, action: QAction) -> None:
        self.chosen.emit(str(action.data()))


class DisplayMenu(QObject):
    """How the picture is drawn: mapping, levels, colours, histogram, line, spectra of its bands."""

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
        self.spectra = self._toggle(menu, "spectra", "Spectrum over &Wavelength")

    def _toggle(self, menu: QMenu, name: str, text: str) -> QAction:
        action = QAction(text, menu, checkable=True)
        action.setObjectName(name)
        menu.addAction(action)
        return action


class CompareMenu(QObject):
    """What the picture is compared with, and how; which viewers it moves with."""

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
        """Offer these ports, each node's in a menu of its own."""
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
        """Offer these viewers, and whether they are moved with."""
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
