"""The viewer of curves shows what the node that is selected has, and says where it has nothing."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest

from core.chain.wires import CurveData, TableData
from window_hands import CTRL, KEY, give_focus

NETWORK = "mwir_camera"

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def select(bench, plot_viewer):
    def by_name(name):
        bench.session.select([name])
        bench.settle()
        return plot_viewer

    return by_name


def strong(viewer):
    return [entry.name for entry in viewer.canvas.drawing.entries if entry.strong]


def test_the_curve_of_the_selected_node_is_shown_unless_another_is_pinned(select):
    viewer = select("merit")
    assert viewer.port == "merit.mrtd"
    assert viewer.canvas.drawing.panels[0].y_label == "MRTD (K)"
    # A node without curves is told, and keeps no others.
    select("back")
    assert viewer.hint.isVisible()
    assert viewer.hint.text().startswith("back has no curves")
    assert viewer.queries() == ()
    assert not viewer.canvas.isVisible()
    assert viewer.bar.ports.currentText() == ""
    select("merit")
    assert viewer.canvas.isVisible()
    assert not viewer.hint.isVisible()
    QTest.mouseClick(viewer.bar.pin, LEFT)
    assert select("optics").port == "merit.mrtd"
    QTest.mouseClick(viewer.bar.pin, LEFT)
    assert select("budget").port == "budget.noise"
    assert viewer.canvas.bars is not None
    # Of a stage the chain is shown, with its curve thick.
    select("optics")
    assert viewer.port is None
    assert strong(viewer) == ["optics"]
    pens = viewer.canvas.pens
    assert pens["optics"].widthF() == 3 * pens["jitter"].widthF()
    assert strong(select("jitter")) == ["jitter"]
    assert viewer.canvas.pens["optics"].widthF() == 1


def test_the_list_shows_another_output_and_a_table_is_copied_with_all_digits(bench, plot_viewer):
    viewer = plot_viewer
    for port, kind in (("budget.blur", CurveData), ("budget.table", TableData)):
        viewer.bar.ports.take_at(viewer.bar.ports.findText(port))
        bench.settle()
        assert viewer.port == viewer.bar.ports.port == port
        assert isinstance(viewer.data, kind)
    truth = bench.value("budget.table").rows
    give_focus(viewer.table)
    QTest.keyClick(viewer.table, KEY.Key_C, CTRL)
    lines = QGuiApplication.clipboard().text().split("\n")
    assert [line.split("\t")[0] for line in lines] == [row.name for row in truth]
    assert [float(line.split("\t")[1]) for line in lines] == [row.value for row in truth]
    at = viewer.table.visualItemRect(viewer.table.item(1, 0)).center()
    QTest.mouseClick(viewer.table.viewport(), LEFT, Qt.KeyboardModifier.NoModifier, at)
    QTest.keyClick(viewer.table, KEY.Key_C, CTRL)
    row = truth[1]
    assert QGuiApplication.clipboard().text() == "\t".join(
        (row.name, repr(row.value), row.unit, row.meaning)
    )
