"""Values copied and pasted by keys, menus and fields, in the window."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent, QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

from core.editing.operations import Add, Placed, set_parameter
from core.network.linked_values import expression
from core.network.network import Node
from window_hands import CTRL, KEY, SHIFT

LEFT = Qt.MouseButton.LeftButton
BOTH = CTRL | SHIFT


@pytest.fixture
def nodes(window, hand):
    """A lens and two blurs, side by side."""
    made = (
        Node("init", "init_trans", {"f_number": 2.0}),
        Node("blur", "gaussian_mtf", {"sigma_x_mrad": 0.3, "sigma_y_mrad": 0.5}),
        Node("shake", "gaussian_mtf", {"sigma_y_mrad": 0.9}),
    )
    placed = tuple(Placed(node, (300.0 * n, 0.0)) for n, node in enumerate(made))
    window.session.do(Add(placed))
    window.canvas.frame_all()
    return window.session


def params(window, name):
    return dict(window.session.network.nodes[name].params)


def position(window):
    return window.session.document.history.position


def test_keys_copy_one_node_and_paste_on_others_as_one_step(window, hand, nodes):
    hand.select("blur")
    hand.key(KEY.Key_C, BOTH)
    assert json.loads(QGuiApplication.clipboard().text())["values"]["sigma_x_mrad"] == 0.3
    before = position(window)
    hand.select("shake")
    hand.key(KEY.Key_V, BOTH)
    assert params(window, "shake") == params(window, "blur")
    assert position(window) == before + 1
    hand.key(KEY.Key_Z, CTRL)
    assert params(window, "shake") == {"sigma_y_mrad": 0.9}


def test_what_does_not_fit_is_said_in_one_line(window, hand, nodes):
    hand.select("init")
    hand.key(KEY.Key_C, BOTH)
    hand.select("shake")
    hand.key(KEY.Key_V, BOTH)
    assert "no values were pasted" in window.status.error
    assert "Gaussian MTF has no" in window.status.error
    assert "\n" not in window.status.error
    assert params(window, "shake") == {"sigma_y_mrad": 0.9}


def test_what_is_being_typed_is_copied_too(window, hand, nodes, idle):
    hand.select("blur")
    idle(window)
    edit = field(window, "blur", "sigma_x_mrad").edit
    edit.setFocus()
    edit.selectAll()
    QTest.keyClicks(edit, "0.75")
    QTest.keyClick(edit, KEY.Key_C, BOTH)
    assert json.loads(QGuiApplication.clipboard().text())["values"]["sigma_x_mrad"] == 0.75


def test_the_menu_of_a_panels_head_has_both(window, hand, nodes, idle):
    hand.select("blur")
    idle(window)
    press_in_head_menu(window, "blur", "copy_values")
    hand.focus()
    hand.select("shake")
    idle(window)
    press_in_head_menu(window, "shake", "paste_values")
    assert params(window, "shake") == params(window, "blur")


def press_in_head_menu(window, node, name):
    bar = window.panels.panels[node].head.bar
    action = next(action for action in bar.actions() if action.objectName() == name)
    spot = bar.rect().center()
    reason = QContextMenuEvent.Reason.Mouse
    QApplication.sendEvent(bar, QContextMenuEvent(reason, spot, bar.mapToGlobal(spot)))
    menu = bar.findChildren(QMenu, "head.menu")[-1]
    QTest.mouseClick(menu, LEFT, pos=menu.actionGeometry(action).center())


def field(window, node, name):
    return window.panels.panels[node].body.sections.field(name)


def choose(made_field, name):
    """Open the field's menu and press an entry of it."""
    made_field.open_menu(made_field.mapToGlobal(QPoint(5, 5)))
    QApplication.processEvents()
    menu = made_field.findChildren(QMenu, "field.menu")[-1]
    action = next(action for action in menu.actions() if action.objectName() == name)
    assert action.isEnabled()
    QTest.mouseClick(menu, LEFT, pos=menu.actionGeometry(action).center())
    QApplication.processEvents()


@pytest.fixture
def blur(window, hand, nodes, idle):
    hand.select("blur")
    idle(window)
    return lambda name: field(window, "blur", name)


def test_one_value_goes_to_another_field_with_its_unit(window, blur):
    before = position(window)
    choose(blur("sigma_x_mrad"), "copy_value")
    assert QGuiApplication.clipboard().text() == "0.3 mrad"
    choose(blur("sigma_y_mrad"), "paste_value")
    assert params(window, "blur")["sigma_y_mrad"] == 0.3
    assert position(window) == before + 1


def test_a_value_of_another_unit_is_converted(window, blur):
    QGuiApplication.clipboard().setText("600 urad")
    choose(blur("sigma_x_mrad"), "paste_value")
    assert params(window, "blur")["sigma_x_mrad"] == pytest.approx(0.6, rel=1e-12)


def test_a_text_that_is_no_value_is_refused_below_the_field(window, blur):
    QGuiApplication.clipboard().setText("a shopping list")
    choose(blur("sigma_x_mrad"), "paste_value")
    assert params(window, "blur")["sigma_x_mrad"] == 0.3
    assert "a shopping list" in blur("sigma_x_mrad").message.text()


def test_a_field_takes_its_own_value_of_a_copied_node(window, hand, nodes, blur, idle):
    window.actions_by_name["copy_values"].trigger()
    hand.focus()
    hand.select("shake")
    idle(window)
    choose(field(window, "shake", "sigma_y_mrad"), "paste_value")
    assert params(window, "shake") == {"sigma_y_mrad": 0.5}


def test_every_field_takes_the_value_it_gives(window, hand, nodes):
    """Each kind of field: numbers with units that cannot be typed, choices, switches, lists."""
    kinds = set()
    for key in ("electronics_noise", "exit_pupil", "read_image", "atmosphere_mtf", "test_scene"):
        name = f"node {key}"
        window.session.do(Add((Placed(Node(name, key), (0.0, 400.0)),)))
        window.session.select([name])
        QApplication.processEvents()
        for one in window.panels.panels[name].body.sections.fields:
            if one.value in (None, "", ()):
                continue
            kinds.add(one.parameter.kind)
            had = one.value
            choose(one, "copy_value")
            choose(one, "paste_value")
            assert one.value == had, one.parameter
            assert one.message.text() == "", one.parameter
    assert {"number", "integer", "choice", "switch"} <= kinds


def test_values_go_into_a_node_inside_of_a_macro(window, hand, nodes):
    """Expressions among them are checked where they would stand."""
    window.session.do(set_parameter("blur", "sigma_x_mrad", expression("init.f_number * 0.1")))
    window.session.select(["shake"])
    window.actions_by_name["group"].trigger()
    (macro,) = (n for n, node in window.session.network.nodes.items() if node.macro is not None)
    (inside,) = (n for n in window.session.network.nodes if n.startswith(f"{macro}/"))
    window.session.select(["blur"])
    window.actions_by_name["copy_values"].trigger()
    window.session.select([inside])
    window.actions_by_name["paste_values"].trigger()
    assert params(window, inside)["sigma_y_mrad"] == 0.5
    assert not window.session.resolved.faults, "no value is pasted that has none there"
