"""Choosing among all that one node has to plot: its curves and its table."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest

from core.chain.wires import CurveData, TableData
from window_hands import CTRL, KEY, give_focus

NETWORK = "noise_budget"

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def viewer(bench, plot_viewer):
    plot_viewer.look_at("budget.noise")
    bench.settle()
    return plot_viewer


def buttons(viewer):
    shown = viewer.bar.outputs.buttons
    return {button.text(): button for button in shown.values() if button.isVisible()}


def test_a_click_shows_another_output_and_a_table_is_copied_with_all_digits(bench, viewer):
    assert list(buttons(viewer)) == ["Noise", "Blur", "Table"]
    for text, port, kind in (
        ("Blur", "budget.blur", CurveData),
        ("Noise", "budget.noise", CurveData),
        ("Table", "budget.table", TableData),
    ):
        QTest.mouseClick(buttons(viewer)[text], LEFT)
        bench.settle()
        assert viewer.port == viewer.bar.ports.port == port
        assert isinstance(viewer.data, kind)
        assert [name for name, each in buttons(viewer).items() if each.isChecked()] == [text]
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
