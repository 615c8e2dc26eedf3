"""Values copied and pasted by keys, menus and fields, in the window."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

from core.editing.operations import add_nodes
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
    placed = tuple((node, (300.0 * n, 0.0)) for n, node in enumerate(made))
    window.session.do(add_nodes(placed))
    window.canvas.frame_all()
    return window.session


def params(window, name):
    return dict(window.session.network.nodes[name].params)


def position(window):
    return window.session.document.position


def test_keys_paste_the_values_of_one_node_on_others_or_say_why_not(window, hand, nodes):
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
    hand.select("init")
    hand.key(KEY.Key_C, BOTH)
    hand.select("shake")
    hand.key(KEY.Key_V, BOTH)
    assert "no values were pasted" in window.status.said("error")
    assert "Gaussian MTF has no" in window.status.said("error")
    assert "\n" not in window.status.said("error")
    assert params(window, "shake") == {"sigma_y_mrad": 0.9}


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


def test_a_field_takes_a_value_with_its_unit_and_the_value_it_gives(window, hand, nodes, idle):
    """Each kind of field: numbers with units that cannot be typed, choices, switches, lists."""
    hand.select("blur")
    idle(window)
    before = position(window)
    choose(field(window, "blur", "sigma_x_mrad"), "copy_value")
    assert QGuiApplication.clipboard().text() == "0.3 mrad"
    choose(field(window, "blur", "sigma_y_mrad"), "paste_value")
    assert params(window, "blur")["sigma_y_mrad"] == 0.3
    assert position(window) == before + 1
    QGuiApplication.clipboard().setText("600 urad")
    choose(field(window, "blur", "sigma_x_mrad"), "paste_value")
    assert params(window, "blur")["sigma_x_mrad"] == pytest.approx(0.6, rel=1e-12)
    kinds = set()
    for key in ("electronics_noise", "read_image", "test_scene"):
        name = f"node {key}"
        window.session.do(add_nodes(((Node(name, key), (0.0, 400.0)),)))
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
