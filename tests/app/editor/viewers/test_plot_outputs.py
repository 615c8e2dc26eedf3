"""Choosing among all that one node has to plot: its curves and its table."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QStyleOptionToolButton

from app.editor.theme import DARK, LIGHT
from core.chain.results import CurveData, TableData, TableRow
from core.editing.operations import Rename
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


def test_a_click_shows_another_output(bench, viewer):
    assert list(buttons(viewer)) == ["Noise", "Blur", "Table"]
    for text, port, kind in (
        ("Blur", "budget.blur", CurveData),
        ("Table", "budget.table", TableData),
        ("Noise", "budget.noise", CurveData),
    ):
        QTest.mouseClick(buttons(viewer)[text], LEFT)
        bench.settle()
        assert viewer.port == viewer.bar.ports.port == port
        assert isinstance(viewer.data, kind)
        assert [name for name, each in buttons(viewer).items() if each.isChecked()] == [text]


def test_the_keyboard_does_the_same(bench, viewer):
    give_focus(buttons(viewer)["Noise"])
    QTest.keyClick(buttons(viewer)["Noise"], KEY.Key_Right)
    QTest.keyClick(viewer.focusWidget(), KEY.Key_Space)
    bench.settle()
    assert viewer.port == "budget.blur"


def test_the_buttons_stand_where_the_line_of_the_chain_is_chosen(bench, viewer):
    assert not viewer.bar.angle.isVisible()
    viewer.look_at(None)
    bench.settle()
    assert viewer.bar.angle.isVisible()
    assert not buttons(viewer)
    viewer.look_at("picture.curve")  # of a node with a table as well
    assert list(buttons(viewer)) == ["Table", "Curve"]
    bench.do(Rename("picture", "look"))
    assert list(viewer.bar.outputs.buttons) == ["look.table", "look.curve"]


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_what_is_chosen_wears_the_accent(viewer, theme):
    viewer.setPalette(theme.palette())
    colours = []
    for name in ("Noise", "Blur"):
        option = QStyleOptionToolButton()
        buttons(viewer)[name].initStyleOption(option)
        colours.append(option.palette.button().color().name())
    assert colours == [theme.accent, theme.button]


def test_a_table_is_copied_with_all_digits(bench, viewer):
    viewer.look_at("budget.table")
    bench.settle()
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


def test_a_table_says_how_to_copy_it_and_lets_the_focus_go_on(bench, viewer):
    viewer.look_at("budget.table")
    bench.settle()
    assert "Ctrl+C" in viewer.status.title.text()
    assert not viewer.bar.log.isVisible()
    give_focus(viewer.table)
    QTest.keyClick(viewer.table, KEY.Key_Tab)
    assert not viewer.table.hasFocus()


def test_a_table_of_short_words_fills_the_width(bench, viewer):
    viewer.look_at("budget.table")
    bench.settle()
    viewer.table.show_table(TableData((TableRow("a", 1.0, "K", "brief"),)))
    assert viewer.table.horizontalHeader().length() == viewer.table.viewport().width() > 300


def test_long_meanings_are_broken_and_not_cut(bench, viewer):
    viewer.look_at("budget.table")
    bench.settle()
    text = "a meaning of many words that no column of this width can hold in a single line " * 8
    viewer.table.show_table(TableData((TableRow("a", 1.0, "K", text), TableRow("b", None))))
    assert viewer.table.rowHeight(0) >= 6 * viewer.table.fontMetrics().height()
    assert viewer.table.rowHeight(1) < 2 * viewer.table.fontMetrics().height()
    viewer.table.copy()
    assert QGuiApplication.clipboard().text().split("\n")[1] == "b\t\t\t"
