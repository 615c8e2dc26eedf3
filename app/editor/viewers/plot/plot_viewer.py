"""The viewer of curves: MTF and PTF of the chain along a line, curves of nodes, and tables."""

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QPoint, QSignalBlocker, Qt

from app.editor import widgets
from app.editor.declared_text import shown_figure
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.viewers import viewer
from app.editor.viewers.plot.plot_canvas import PlotCanvas
from app.editor.viewers.plot.plot_export import KINDS, Data, csv_text, plot_menu, save_plot
from app.editor.viewers.plot.plot_looks import CurveList
from app.editor.viewers.plot.plotted_lines import (
    CurvesQuery,
    Drawing,
    Parts,
    PortDataQuery,
    TransferCurves,
    curve_drawing,
    transfer_drawing,
    with_kept,
)
from app.run.terminal import number_text
from core.chain.wires import CurveData, TableData, TableRow
from core.errors import UsageError, several
from core.modules.preview import signed
from core.network.network import Network

_LIST_SHARE = 0.36  # of the height, at most, for the legend
_BARE = "{} has no curves. Select a node with curves, or choose curves above."
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_NARROW = 75  # characters; a narrower viewer leaves the meanings of figures out


class PlotViewer(viewer.Viewer):
    """Plots the chain, or curves or the table of a port, of the selected node unless pinned."""

    room = 80, 20
    export_kinds = KINDS

    def __init__(self, session: Session, evaluator: Evaluator) -> None:
        super().__init__(session, evaluator, "plot_viewer")
        self.setAccessibleName("Plot viewer")
        self.port: str | None = None
        self.angle_deg = 0.0
        self.parts: Parts = "mtf"
        self.log: bool | None = None
        self.data: Data | None = None
        self._kept: tuple[Data | None, str] = (None, "")
        self._lost: str | None = None
        self._node, self._bare = "", ""
        self._data_port: str | None = None  # the port that the data are of
        self._switched: dict[str, bool] = {}
        self._build()
        session.selection_changed.connect(self._selected)
        self._follow_choices()

    def look_at(self, port: str | None) -> None:
        self._lost, port = None, port or None
        if port != self.port or self._bare:
            self.port, self._bare = port, ""
            self.log = None
            self._switched.clear()
            self._follow_choices()

    def look_at_node(self, name: str) -> None:
        """Plot what a node has: its first curve, else the chain with it, else its table."""
        declared = self.session.declared(name)
        if declared is None:
            return
        outputs = {f"{name}.{port.name}": port.types[0] for port in declared.outputs}
        own = viewer.ports_by_node(
            self.session.network, self.session.library, viewer.PLOT_TYPES
        ).get(name, ())
        curves = [port for port in own if outputs[port] == "curve"]
        before, self._node = self._node, name
        if curves or "transfer" in outputs.values() or own:
            transfer = not curves and "transfer" in outputs.values()
            self.look_at(None if transfer else (*curves, *own)[0])
            if before != name and isinstance(self.data, TransferCurves):
                self._draw()
        else:
            self._bare, self.port, self._lost = name, None, None
            self._follow_choices()
            self._draw()

    def set_angle(self, angle_deg: float) -> None:
        """Plot along a line in that direction: 0 across, 90 along."""
        if angle_deg != self.angle_deg:
            self.angle_deg = angle_deg
            self._follow_choices()

    def set_parts(self, parts: Any) -> None:
        if parts != self.parts:
            self.parts = parts
            self._follow_choices()
            self._draw()

    def set_log(self, log: bool | None) -> None:
        """Plot with a logarithmic ordinate or not; None: as the data are best seen."""
        self.log = log
        self._draw()

    def compare_kept(self, data: Data | None, name: str = "") -> None:
        """Draw the curves of a kept state, of that name, beside the present ones; None: no more."""
        before, self._kept = self._kept, (data, name)
        if before[0] is not data or before[1] != name:
            self._draw()

    def export(self, path: Path) -> None:
        if self.data is None or self._bare:
            raise UsageError("the viewer shows no curves")
        save_plot(self._pages.currentWidget(), csv_text(self.data), path)

    def queries(self) -> tuple[Query, ...]:
        if self._bare:
            return ()
        return (CurvesQuery(self.angle_deg) if self.port is None else PortDataQuery(self.port),)

    def accepts(self, query: Query) -> bool:
        """Whether it is of what is chosen; while the angle is turned, also of the last one."""
        of_chain = self.port is None and not self._bare
        return query in self.queries() or (of_chain and isinstance(query, CurvesQuery))

    def take(self, answer: Answer) -> None:
        other = getattr(answer.query, "port", None) != self._data_port
        if answer.error is not None:
            self.status.show_text(str(answer.error), failed=True)
            if other:  # what is drawn is not what failed
                self.data, self._data_port = None, self.port
                self._draw()
            return
        self.data, self._data_port = answer.value, self.port
        self._draw()
        if isinstance(answer.value, TransferCurves):
            self._show_transfer_status(answer.value)
        elif isinstance(answer.value, CurveData):
            self.status.show_text(answer.value.title)
        else:
            self.status.show_text(f"{several(len(answer.value.rows), 'figure')}; Ctrl+C copies all")

    def follow(self, before: Network, after: Network) -> None:
        """Follow nodes that are renamed; a node that is restored is shown again."""
        port = self._lost or self.port
        if self._bare and self._bare not in after.nodes:
            self.look_at(None)
        if port is None:
            return
        moved = viewer.followed(port, before, after) or port
        gone = moved.rpartition(".")[0] not in after.nodes
        self._lost = moved if gone else None
        now = None if gone else moved
        if now != self.port:
            self.port = now
            self._follow_choices()

    def follow_opening(self) -> None:
        self.data, self._kept, self._node = None, (None, ""), ""
        self.canvas.framed = True
        self._switched.clear()
        self.look_at(None)
        self._draw()

    def _build(self) -> None:
        self.bar = PlotBar(self.session, self.owner, self)
        self.canvas = widgets.labelled(PlotCanvas(self), f"{self.owner}.canvas")
        self.list = widgets.labelled(CurveList(self, across=True), f"{self.owner}.curves")
        self.table = widgets.labelled(FigureTable(self), f"{self.owner}.table")
        self.status = viewer.StatusLine(self.owner, "What is plotted", "Value at the cursor", self)
        self._curves = QtWidgets.QWidget(self)
        room = QtWidgets.QScrollArea(self._curves, widgetResizable=True)  # for many bars
        room.setFrameShape(QtWidgets.QFrame.Shape.NoFrame)
        room.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        room.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        room.setWidget(self.canvas)
        parts = ((room, 1), self.list)
        widgets.filled(QtWidgets.QVBoxLayout(self._curves), *parts, spacing=2)
        self.hint = widgets.labelled(widgets.centred_hint("", self), f"{self.owner}.hint")
        self._pages = QtWidgets.QStackedWidget(self)
        for page in (self._curves, self.table, self.hint):
            self._pages.addWidget(page)
        widgets.filled(
            QtWidgets.QVBoxLayout(self), self.bar, (self._pages, 1), self.status, spacing=1
        )
        self.bar.ports.chosen.connect(self.look_at)
        self.bar.angle.valueChanged.connect(self.set_angle)
        self.bar.parts.activated.connect(lambda _: self.set_parts(self.bar.parts.currentData()))
        self.bar.log.clicked.connect(lambda: self.set_log(self.bar.log.isChecked()))
        self.bar.fit.clicked.connect(self.canvas.frame)
        self.canvas.read.connect(self.status.show_more)
        self.canvas.recoloured.connect(self._fill_list)
        self.canvas.menu_wanted.connect(self._open_menu)
        self.list.toggled.connect(self._toggle)

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit_list()

    def _fit_list(self) -> None:
        height = self.list.height_for(self.width())
        self.list.setFixedHeight(min(height, int(_LIST_SHARE * self.height())))

    def _open_menu(self, point: QPoint) -> None:
        data = self.data
        numbers = None if data is None else partial(csv_text, data)
        menu = plot_menu(self._curves, self.session.message.emit, numbers)
        menu.addSeparator()
        log = widgets.offer(menu, "plot.log", "Logarithmic ordinate", self.bar.log.click)
        log.setCheckable(True)
        log.setChecked(self.bar.log.isChecked())
        if self.canvas.isVisible() and self.canvas.plots:
            for along, name in enumerate(("Abscissa", "Ordinate")):
                edit, action = widgets.line_in_menu(menu, name, f"plot.limits.{name.lower()}")
                edit.setText(" to ".join(map(shown_figure, self.canvas.limits(bool(along)))))
                edit.setAccessibleName(f"{name}: lower and upper limit")
                edit.returnPressed.connect(partial(self._limit, menu, edit, bool(along)))
                menu.addAction(action)
            widgets.offer(menu, "plot.all", "Show all (F)", self.canvas.frame)
        menu.popup(point)

    def _limit(self, menu: QtWidgets.QMenu, edit: QtWidgets.QLineEdit, along: bool) -> None:
        numbers = _NUMBER.findall(edit.text().replace("\N{MINUS SIGN}", "-"))
        if len(numbers) == 2:
            menu.close()
            self.canvas.set_limits(along, *map(float, numbers))

    def _toggle(self, name: str, on: bool) -> None:
        self._switched[name] = on
        self.canvas.show_entries(self._shown(self.canvas.drawing))

    def _selected(self, names: tuple[str, ...]) -> None:
        if self.bar.pin.isChecked():
            return
        if names:
            self.look_at_node(names[-1])
        elif not self._lost and (self.port or "").rpartition(".")[0] in ("", self._node):
            self._node = ""
            self.look_at(None)
            self._draw()

    def _follow_choices(self) -> None:
        self.bar.show_choices(self.port, self.angle_deg, self.parts, bare=bool(self._bare))
        self.ask()

    def _draw(self) -> None:
        data = self.data
        log = self.log if self.log is not None else getattr(data, "log_y", False)
        self.bar.log.setChecked(log)
        plotted = not self._bare and not isinstance(data, TableData)
        self.bar.log.setVisible(plotted)
        self.bar.fit.setVisible(plotted and not getattr(data, "bars", ()))
        if self._bare:
            self.hint.setText(_BARE.format(self._bare))
            self._pages.setCurrentWidget(self.hint)
            self.status.show_text("")
            return
        if isinstance(data, TableData):
            self.table.show_table(data)
            self._pages.setCurrentWidget(self.table)
            return
        self._pages.setCurrentWidget(self._curves)
        drawing = self._drawing(data, log)
        if (kept := self._kept[0]) is not None and type(kept) is type(data):
            drawing = with_kept(drawing, self._drawing(kept, log), self._kept[1])
        before = self.canvas.drawing
        self.canvas.show_drawing(drawing, self._shown(drawing))
        if (drawing.entries, drawing.note) != (before.entries, before.note):
            self._fill_list()

    def _drawing(self, data: Data | None, log: bool) -> Drawing:
        if isinstance(data, TransferCurves):
            return transfer_drawing(data, self.parts, log=log, strong=self._node)
        return curve_drawing(data, log=log) if isinstance(data, CurveData) else Drawing("")

    def _fill_list(self) -> None:
        drawing = self.canvas.drawing
        self.list.fill(drawing.entries, self._shown(drawing), self.canvas.pens, drawing.note)
        self._fit_list()

    def _shown(self, drawing: Drawing) -> set[str]:
        """What is ticked; a kept curve comes and goes with the present one."""
        switched = self._switched
        return {
            entry.name
            for entry in drawing.entries
            if switched.get(entry.name, switched.get(entry.of or entry.name, entry.shown))
        }

    def _show_transfer_status(self, curves: TransferCurves) -> None:
        if curves.trouble:
            self.status.show_text(curves.trouble, failed=True)
            return
        if not len(curves.frequency):
            self.status.show_text("the network has no transfer function to plot")
            return
        if curves.missing:
            self.status.show_text(f"no Total: {curves.missing}")
            return
        end = curves.frequency[-1]
        beyond = [mark for mark in curves.marks if mark.x > end * (1 + 1e-9)]
        texts = [f"{mark.text} at {mark.x:.4g} cyc/mrad" for mark in beyond]
        self.status.show_text(f"beyond the plot: {', '.join(texts)}" if texts else "")


_HEADS = ("Name", "Value", "Unit", "Meaning")


class FigureTable(widgets.CopiedTable):
    """Name, value, unit and meaning; tooltip and Ctrl+C give a value in all its digits."""

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(_HEADS, parent)
        self.setAccessibleName("Figures; Ctrl+C copies them")
        self.setAlternatingRowColors(True)
        self.verticalHeader().setMinimumSectionSize(self.fontMetrics().height() + 6)
        head = self.horizontalHeader()
        head.setSectionResizeMode(QtWidgets.QHeaderView.ResizeMode.ResizeToContents)
        head.setStretchLastSection(True)
        copy = self.addAction("&Copy")
        copy.setObjectName("figures.copy")
        copy.triggered.connect(self.copy)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        self._figures: tuple[TableRow, ...] = ()

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        """Leave the meaning to the name's tooltip where it would be a column of single words."""
        super().resizeEvent(event)
        narrow = self.width() < _NARROW * self.fontMetrics().averageCharWidth()
        self.setColumnHidden(_HEADS.index("Meaning"), narrow)

    def show_table(self, table: TableData) -> None:
        self._figures = table.rows
        rows = []
        for figure in table.rows:
            name, unit, meaning = figure.name, figure.unit, figure.meaning
            value = (_shown(figure), _exact(figure))
            rows.append(((name, f"{name}: {meaning}"), value, (unit, unit), (meaning, meaning)))
        self.show_rows(rows, right=1)

    def cells(self, row: int) -> Sequence[str]:
        figure = self._figures[row]
        return figure.name, _exact(figure), figure.unit, figure.meaning


def _shown(figure: TableRow) -> str:
    if figure.value is None:
        return "—"
    return figure.value if isinstance(figure.value, str) else signed(number_text(figure.value))


def _exact(figure: TableRow) -> str:
    if figure.value is None:
        return ""
    return figure.value if isinstance(figure.value, str) else repr(figure.value)


_LETTERS = 14  # of what is plotted, at least
PARTS = {"mtf": "MTF", "ptf": "PTF", "both": "MTF, PTF"}


class PlotBar(QtWidgets.QWidget):
    def __init__(self, session: Session, owner: str, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent)
        self.ports = viewer.PortChoice(session, viewer.PLOT_TYPES, "Whole chain", self)
        self.ports.setObjectName(f"{owner}.port")
        self.ports.setAccessibleName("What is plotted")
        self.ports.setPlaceholderText("No curves")
        self._x = widgets.tool_button(f"{owner}.x", "x", "Plot along ξ, horizontally", self)
        self._y = widgets.tool_button(f"{owner}.y", "y", "Plot along η, vertically", self)
        self.angle = widgets.labelled(
            QtWidgets.QDoubleSpinBox(
                self, minimum=-360.0, maximum=360.0, decimals=1, singleStep=5.0, suffix="°",
                keyboardTracking=False,
            ), f"{owner}.angle", "Direction of the line, degrees",
            "Direction of the line: 0 is horizontal, 90 vertical",
        )  # fmt: skip
        self.parts = widgets.labelled(
            QtWidgets.QComboBox(self), f"{owner}.parts", "MTF, PTF or both"
        )
        for name, text in PARTS.items():
            self.parts.addItem(text, name)
        self.log = widgets.toggle_button(f"{owner}.log", "Log", "Logarithmic ordinate", self)
        self.pin = widgets.toggle_button(
            f"{owner}.pin", "Pin", "Keep these curves when another node is selected", self
        )
        self.fit = widgets.tool_button(f"{owner}.fit", "Fit", "Show the whole plot (F or 0)", self)
        self._of_chain = (self._x, self._y, self.angle, self.parts)
        self.ports.setMinimumContentsLength(_LETTERS)
        flow = widgets.FlowLayout(self, across=3, down=2)  # in one row it would hold the dock wide
        parts = (self.ports, self.pin, *self._of_chain, self.log, self.fit)
        widgets.filled(flow, *parts, margins=(2, 2, 2, 0))
        self._x.clicked.connect(lambda: self.angle.setValue(0.0))
        self._y.clicked.connect(lambda: self.angle.setValue(90.0))

    def show_choices(
        self, port: str | None, angle_deg: float, parts: str, *, bare: bool = False
    ) -> None:
        self.ports.choose(port)
        if bare:
            self.ports.setCurrentIndex(-1)
        with QSignalBlocker(self.angle):
            self.angle.setValue(angle_deg)
        self.parts.setCurrentIndex(self.parts.findData(parts))
        for widget in self._of_chain:
            widget.setEnabled(port is None)
            widget.setVisible(port is None and not bare)
