"""Writing what a plot shows, as a picture, as drawing, as numbers; the menu that offers it."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from PySide6 import QtCore, QtGui, QtSvg, QtWidgets

from app.editor.messages import SaveDialog, show_beside, told
from app.editor.viewers.plot.plotted_lines import TransferCurves
from app.editor.widgets import Menu, labelled, offer
from core.atomic import write_bytes, write_text
from core.chain.wires import CurveData, TableData
from core.errors import FileError, UsageError
from nodes.files.file_format import CSV, SVG, dialog_filter, suffixes
from nodes.files.formats import PNG
from nodes.files.table_cells import csv_columns, csv_figures

PICTURES = (PNG, SVG)
NUMBERS = (CSV,)
KINDS = ";;".join((dialog_filter("Pictures", *PICTURES), dialog_filter("Numbers", *NUMBERS)))
Numbers = Callable[[], str]  # all numbers of a plot as CSV; empty where there are none
Report = Callable[[str, str], object]  # "note" or "error", and a text for the person
Data = TransferCurves | CurveData | TableData
_SHARPNESS = 2  # dots of a PNG for each of the window


def save_plot(widget: QtWidgets.QWidget, numbers: str, path: Path) -> None:
    if numbers and CSV.matches(path):
        write_text(path, numbers)
    elif PNG.matches(path):
        write_bytes(path, _png(widget))
    elif SVG.matches(path):
        write_bytes(path, _svg(widget))
    else:
        raise UsageError(f"{path}: plots can be saved as {' '.join(suffixes(*PICTURES, *NUMBERS))}")


def csv_text(data: Data) -> str:
    """Every curve or row of the data in full precision, also those that are not shown."""
    if isinstance(data, TableData):
        return csv_figures((row.name, row.value, row.unit, row.meaning) for row in data.rows)
    columns: list[tuple[str, Iterable[Any]]] = []
    if isinstance(data, TransferCurves):
        columns.append(("frequency_cyc_per_mrad", data.frequency.tolist()))
        for _, curve in data.curves:
            columns.append((f"{curve.name}.mtf", curve.x.mtf.tolist()))
            columns.append((f"{curve.name}.ptf_rad", curve.x.ptf_rad.tolist()))
    elif data.bars:
        columns.append((data.x_label or "name", data.bars))
        columns += [(s.label or data.y_label, s.y.tolist()) for s in data.series]
    else:
        for series in data.series:
            columns.append((f"{series.label}: {data.x_label}", series.x.tolist()))
            columns.append((f"{series.label}: {data.y_label}", series.y.tolist()))
    return csv_columns(columns) if columns else ""


def _png(widget: QtWidgets.QWidget) -> bytes:
    shown = QtGui.QPixmap(widget.size() * _SHARPNESS)
    shown.setDevicePixelRatio(_SHARPNESS)
    widget.render(shown)
    return png_bytes(shown.toImage())


def png_bytes(picture: QtGui.QImage) -> bytes:
    buffer = QtCore.QBuffer()
    writer = QtGui.QImageWriter(buffer, QtCore.QByteArray(b"PNG"))
    if not writer.write(picture):
        raise FileError("the picture could not be encoded as PNG")
    return bytes(buffer.data().data())


def _svg(widget: QtWidgets.QWidget) -> bytes:
    buffer = QtCore.QBuffer()
    buffer.open(QtCore.QIODevice.OpenModeFlag.WriteOnly)
    drawing = QtSvg.QSvgGenerator()
    drawing.setOutputDevice(buffer)
    drawing.setSize(widget.size())
    drawing.setViewBox(QtCore.QRect(0, 0, widget.width(), widget.height()))
    painter = QtGui.QPainter(drawing)
    widget.render(painter, QtCore.QPoint())
    painter.end()
    return bytes(buffer.data().data())


def have_plot_menu(
    widget: QtWidgets.QWidget,
    report: Report,
    numbers: Numbers = str,
    table: Callable[[], object] | None = None,
) -> None:
    """Open the menu by the right button and the menu key; `table` asks where to write numbers."""

    def open_at(point: QtCore.QPoint) -> None:
        menu = plot_menu(widget, report, numbers if numbers() else None)
        if table is not None:
            offer(menu, "plot.table", "Save the numbers…", table)
        menu.popup(widget.mapToGlobal(point))

    widget.setContextMenuPolicy(QtCore.Qt.ContextMenuPolicy.CustomContextMenu)
    widget.customContextMenuRequested.connect(open_at)


def plot_menu(widget: QtWidgets.QWidget, report: Report, numbers: Numbers | None) -> Menu:
    menu = labelled(Menu(widget), "plot_menu")
    menu.aboutToHide.connect(menu.deleteLater)
    clipboard = QtGui.QGuiApplication.clipboard()

    def ask() -> None:
        kinds = KINDS if numbers else dialog_filter("Pictures", *PICTURES)
        show_beside(widget, SaveDialog(widget, "plot_dialog", "Save the plot", kinds, save))

    def save(path: Path) -> None:
        with told(report, "not saved: "):
            save_plot(widget, numbers() if numbers else "", path)
            report("note", f"wrote {path}")

    offer(menu, "plot.copy", "Copy picture", lambda: clipboard.setPixmap(widget.grab()))
    if numbers:
        offer(menu, "plot.copy_numbers", "Copy numbers", lambda: clipboard.setText(numbers()))
    offer(menu, "plot.save", f"Save as PNG, SVG{' or CSV' if numbers else ''}…", ask)
    return menu
