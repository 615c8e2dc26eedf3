"""No figure is cut short, in any dock, layout or shipped network, in a window of 1366 × 768."""

from typing import get_args

from PySide6.QtWidgets import QTableView

from app.editor.widgets import ElidedLabel
from app.editor.window.window_layout import LayoutName
from window_hands import show_small

SIZE = 1366, 768


def room_of(label, window):
    """The width a label has; of the strip's, what is seen of it: none below the strip's foot."""
    if not window.figures.isAncestorOf(label):
        return label.contentsRect().width()
    shown = label.visibleRegion().boundingRect()
    return shown.width() if shown.height() >= label.fontMetrics().ascent() else 0


def cut_short(window):
    """Texts with a digit that have less room than they need, with the names of their widgets."""
    found = [
        (label.objectName(), label.text())
        for label in window.findChildren(ElidedLabel)
        if label.isVisible()
        and any(letter.isdigit() for letter in label.text())
        and room_of(label, window) < label.fontMetrics().horizontalAdvance(label.text())
    ]
    for table in window.findChildren(QTableView):
        if not table.isVisible():
            continue
        model = table.model()
        for index in (
            model.index(row, column)
            for row in range(model.rowCount())
            for column in range(model.columnCount())
        ):
            text = str(index.data() or "")
            one_cell = table.columnSpan(index.row(), index.column()) == 1
            number = text[:1].isdigit() and one_cell
            if number and table.fontMetrics().horizontalAdvance(text) > table.columnWidth(
                index.column()
            ):
                found.append((table.objectName(), text))
    return found


def test_figures_are_read_in_full(window, idle):
    window.resize(*SIZE)
    for network in ("kodak_kir310", "mwir_camera"):
        show_small(window, network)
        idle(window)
        assert window.figures.isVisible()
        for layout in get_args(LayoutName):
            window.choose_layout(layout)
            idle(window)
            assert cut_short(window) == [], (network, layout)
        for dock in ("snapshots", "fit", "trade_off", "measure"):
            window.actions_by_name[dock].trigger()
            idle(window)
            assert cut_short(window) == [], (network, dock)
            window.actions_by_name[dock].trigger()
