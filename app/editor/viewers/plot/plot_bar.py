"""The controls above a plot."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QAbstractButton,
    QButtonGroup,
    QComboBox,
    QDoubleSpinBox,
    QHBoxLayout,
    QWidget,
)

from app.editor.declared_text import label_of
from app.editor.session import Session
from app.editor.viewers.network_ports import PLOT_TYPES, PortChoice, ports_by_node
from app.editor.widgets import Toggle, toggle_button, tool_button

PARTS = {"mtf": "MTF", "ptf": "PTF", "both": "MTF, PTF"}


class PlotBar(QWidget):
    """What is plotted; of the chain along which line and which part, of a node which output."""

    angle_chosen = Signal(float)  # degrees: another direction of the line
    parts_chosen = Signal(str)  # name: "mtf", "ptf" or "both"
    log_chosen = Signal(bool)  # on: whether the ordinate is logarithmic

    def __init__(self, session: Session, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.ports = PortChoice(session, PLOT_TYPES, "Chain's transfer functions", self)
        self.ports.setObjectName(f"{owner}.port")
        self.ports.setAccessibleName("What is plotted")
        self.outputs = OutputButtons(session, owner, self)
        self._x = tool_button(f"{owner}.x", "x", "Along ξ, across the picture", self)
        self._y = tool_button(f"{owner}.y", "y", "Along η, down the picture", self)
        self.angle = QDoubleSpinBox(self)
        self.angle.setObjectName(f"{owner}.angle")
        self.angle.setAccessibleName("Direction of the line, degrees")
        self.angle.setToolTip("Direction of the line: 0 across, 90 down the picture")
        self.angle.setRange(-360.0, 360.0)
        self.angle.setDecimals(1)
        self.angle.setSingleStep(5.0)
        self.angle.setSuffix("°")
        self.angle.setKeyboardTracking(False)
        self.parts = QComboBox(self)
        self.parts.setObjectName(f"{owner}.parts")
        self.parts.setAccessibleName("MTF, PTF or both")
        for name, text in PARTS.items():
            self.parts.addItem(text, name)
        self.log = toggle_button(f"{owner}.log", "Log", "Logarithmic ordinate", self)
        self.fit = tool_button(f"{owner}.fit", "Fit", "Show all of the curves (F or 0)", self)
        self._of_chain = (self._x, self._y, self.angle, self.parts)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(2, 2, 2, 0)
        layout.setSpacing(3)
        layout.addWidget(self.ports, 1)
        layout.addWidget(self.outputs, 0)
        for widget in (*self._of_chain, self.log, self.fit):
            layout.addWidget(widget, 0)
        self._x.clicked.connect(self._choose_x)
        self._y.clicked.connect(self._choose_y)
        self.angle.valueChanged.connect(self.angle_chosen)
        self.parts.activated.connect(self._choose_parts)
        self.log.clicked.connect(self._choose_log)

    def show_choices(self, port: str | None, angle_deg: float, parts: str) -> None:
        """Show what is chosen, without a signal."""
        self.ports.choose(port)
        self.angle.blockSignals(True)
        self.angle.setValue(angle_deg)
        self.angle.blockSignals(False)
        self.parts.setCurrentIndex(self.parts.findData(parts))
        for widget in self._of_chain:
            widget.setEnabled(port is None)
            widget.setVisible(port is None)
        self.outputs.show_port(port)

    def _choose_x(self) -> None:
        self.angle.setValue(0.0)

    def _choose_y(self) -> None:
        self.angle.setValue(90.0)

    def _choose_log(self) -> None:
        self.log_chosen.emit(self.log.isChecked())

    def _choose_parts(self, index: int) -> None:
        self.parts_chosen.emit(str(self.parts.itemData(index)))


# Buttons of all that one node has to plot, beside the list of all nodes.


class OutputButtons(QWidget):
    """One button for each output of the node that is shown; none where it has but one."""

    chosen = Signal(str)  # port: the person has chosen one, ``NODE.PORT``

    def __init__(self, session: Session, owner: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAccessibleName("Outputs of the node that is plotted")
        self._session = session
        self._owner = owner
        self.buttons: dict[str, Toggle] = {}
        self._group = QButtonGroup(self)
        self._group.buttonClicked.connect(self._clicked)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(0, 0, 0, 0)
        self._row.setSpacing(1)

    def show_port(self, port: str | None) -> None:
        """Show a port as chosen beside the others of its node, without a signal."""
        ports = self._beside(port)
        if ports != tuple(self.buttons):
            self._make(ports)
        if port in self.buttons:
            self.buttons[port].setChecked(True)
        self.setVisible(bool(ports))

    def _beside(self, port: str | None) -> tuple[str, ...]:
        if port is None:
            return ()
        for group in ports_by_node(self._session.network, self._session.library, PLOT_TYPES):
            if port in group.ports:
                return group.ports if len(group.ports) > 1 else ()
        return ()

    def _make(self, ports: tuple[str, ...]) -> None:
        for button in self.buttons.values():
            self._group.removeButton(button)
            self._row.removeWidget(button)
            button.hide()
            button.deleteLater()
        self.buttons = {port: self._button(port) for port in ports}

    def _button(self, port: str) -> Toggle:
        name = port.rpartition(".")[2]
        button = toggle_button(f"{self._owner}.output.{name}", label_of(name), f"Show {port}", self)
        self._group.addButton(button)
        self._row.addWidget(button)
        return button

    def _clicked(self, clicked: QAbstractButton) -> None:
        for port, button in self.buttons.items():
            if button is clicked:
                self.chosen.emit(port)
                return
