"""The controls above a picture."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.editor.session import Session
from app.editor.viewers.network_ports import PICTURE_TYPES
from app.editor.viewers.picture.picture_menus import CompareMenu, DisplayMenu
from app.editor.viewers.port_choice import PortChoice
from app.editor.widgets import menu_button, toggle_button, tool_button


class PictureBar(QWidget):
    """Wire, menus and zoom of an image viewer.

    Parameters
    ----------
    session : Session
        The open document.
    owner : str
        The viewer's name, which those of the controls begin with.
    parent : QWidget
        The viewer.

    Signals
    -------
    opening
        The menu of other wires and viewers is about to open.
    """

    opening = Signal()

    def __init__(self, session: Session, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.ports = PortChoice(session, PICTURE_TYPES, "no wire", self)
        self.ports.setObjectName(f"{owner}.port")
        self.ports.setAccessibleName("Wire that is shown")
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
        self.fit = tool_button(f"{owner}.fit", "Fit", "Show all of the picture (F or 0)", self)
        self.dots = tool_button(f"{owner}.dots", "1:1", "Show each sample one dot wide (1)", self)
        self.region = toggle_button(
            f"{owner}.region", "⬚", "Draw the region of the selected module (R)", self
        )
        layout = QHBoxLayout(self)
        layout.setContentsMargins(2, 2, 2, 0)
        layout.setSpacing(3)
        for widget in (self.ports, shown, compared, self.region, self.fit, self.dots):
            layout.addWidget(widget, 1 if widget is self.ports else 0)
