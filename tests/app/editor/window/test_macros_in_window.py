"""Macros in the window: grouped, opened, shown, left and ungrouped by keys and mouse."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QMenu, QToolButton, QWidgetAction

from core.network.file import format_network
from window_hands import CTRL, KEY, SHIFT, WindowHands

ALT = Qt.KeyboardModifier.AltModifier
MEMBERS = ("init", "blur", "back")


@pytest.fixture
def hands(window, idle):
    """On the first network, whose chain is a scene, a spectrum, a blur and the way back."""
    window.files.open_now("first_steps")
    idle(window)
    made = WindowHands(window)
    made.focus()
    assert set(MEMBERS) <= set(window.session.network.nodes)
    return made


@pytest.fixture
def grouped(hands, window, idle):
    """The chain as one node, called lens."""
    hands.select(*MEMBERS)
    hands.key(KEY.Key_G, CTRL)
    hands.type("lens")
    hands.key(KEY.Key_Return)
    hands.focus()
    idle(window)
    return hands


def field(window, node, name):
    return window.panels.panels[node].body.sections.field(name)


def choose(window, node, name, action):
    """Take an action of a field's menu, as the right button opens it."""
    shown = field(window, node, name)
    shown.open_menu(shown.mapToGlobal(QPoint(4, 4)))
    menu = shown.findChild(QMenu, "field.menu")
    entry = next(each for each in menu.actions() if each.objectName() == action)
    entry.trigger()
    menu.close()


def text(window):
    return format_network(window.session.document.network, library=window.session.library)


def test_ctrl_g_makes_one_node_and_its_name_is_typed_in_place(hands, window, idle):
    before, start = window.viewers.images[1].picture, text(window)
    hands.select(*MEMBERS)
    hands.key(KEY.Key_G, CTRL)
    assert QApplication.focusWidget() is window.panels.panels["macro"].head.name
    hands.type("lens")
    hands.key(KEY.Key_Return)
    idle(window)
    assert set(window.level.network.nodes) == {"scene", "lens", "picture"}
    assert set(window.canvas.content.nodes) == {"scene", "lens", "picture"}
    assert window.canvas.content.nodes["lens"].face.macro
    after = window.viewers.images[1].picture
    assert np.array_equal(before.samples, after.samples)
    hands.focus()
    for _ in range(2):  # its name, and the group
        hands.key(KEY.Key_Z, CTRL)
    assert text(window) == start


def test_ctrl_shift_g_puts_the_nodes_back(hands, window):
    start = window.session.document.network
    hands.select(*MEMBERS)
    hands.key(KEY.Key_G, CTRL)
    hands.focus()
    hands.key(KEY.Key_G, CTRL | SHIFT)
    assert window.session.document.network == start
    assert set(window.session.selection) == set(MEMBERS)


def test_a_double_click_shows_the_inside_and_the_bar_leads_back(grouped, window):
    assert not window.crumbs.isVisible()
    grouped.double_click(grouped.head("lens"))
    assert window.level.path == ("lens",)
    assert set(window.canvas.content.nodes) == set(MEMBERS)
    assert window.crumbs.isVisible()
    assert [button.text() for button in window.crumbs.steps] == ["First steps", "lens"]
    for button in (window.crumbs.up, *window.crumbs.steps):
        assert window.crumbs.rect().contains(button.geometry())
        assert button.visibleRegion().boundingRect().size() == button.size()
        assert button.accessibleName()
        assert button.toolTip()
    QTest.mouseClick(window.crumbs.steps[0], Qt.MouseButton.LeftButton)
    assert window.level.path == ()
    assert not window.crumbs.isVisible()
    grouped.focus()
    grouped.select("lens")
    grouped.key(KEY.Key_Return)
    assert window.level.path == ("lens",)
    QTest.keyClick(window.canvas.view, KEY.Key_PageUp, ALT)
    assert window.level.path == ()
    assert window.session.selection == ("lens",)


def test_work_inside_is_undone_across_levels(grouped, window):
    grouped.double_click(grouped.head("lens"))
    start = text(window)
    grouped.select("blur")
    grouped.key(KEY.Key_Delete)
    assert set(window.level.network.nodes) == {"init", "back"}
    QTest.mouseClick(window.findChild(QToolButton, "crumbs.up"), Qt.MouseButton.LeftButton)
    grouped.focus()
    grouped.key(KEY.Key_Z, CTRL)
    assert text(window) == start
    grouped.double_click(grouped.head("lens"))
    for _ in range(2):
        grouped.key(KEY.Key_Z, CTRL)
    assert window.level.path == ()  # the macro is gone, so what lay around it is shown
    assert set(window.canvas.content.nodes) == {"scene", "picture", *MEMBERS}


def test_a_parameter_is_exposed_set_renamed_and_hidden_by_menus(grouped, window, idle):
    grouped.double_click(grouped.head("lens"))
    grouped.select("blur")
    panel = window.panels.panels["lens/blur"]
    assert panel.head.name.text() == "blur"
    name = "sigma_x_mrad"
    choose(window, "lens/blur", name, "expose")
    QTest.keyClick(window.canvas.view, KEY.Key_PageUp, ALT)
    shown = field(window, "lens", name)
    inner = panel.declared.parameter(name)
    assert shown.unit.text() == inner.param.unit
    assert shown.parameter.param == inner.param
    before = window.viewers.images[1].picture
    shown.offer(3.0 * shown.value)
    idle(window)
    assert not np.array_equal(before.samples, window.viewers.images[1].picture.samples)
    shown.open_menu(shown.mapToGlobal(QPoint(4, 4)))
    line = shown.findChild(QLineEdit, "exposed_name")
    assert any(isinstance(each, QWidgetAction) for each in line.window().actions())
    line.setFocus()
    line.selectAll()
    QTest.keyClicks(line, "softness")
    QTest.keyClick(line, KEY.Key_Return)
    assert list(window.session.document.network.nodes["lens"].params) == ["softness"]
    value = field(window, "lens", "softness").value
    choose(window, "lens", "softness", "hide")
    assert window.session.network.nodes["lens/blur"].params[name] == value


def test_a_viewer_shows_a_node_inside(grouped, window, idle):
    grouped.double_click(grouped.head("lens"))
    grouped.select("back")
    grouped.key(KEY.Key_2)
    idle(window)
    assert window.viewers.images[2].choices.port == "lens/back.image"
    assert window.viewers.images[2].picture is not None
    grouped.key(KEY.Key_PageUp, ALT)
    grouped.select("lens")
    grouped.key(KEY.Key_1)
    idle(window)
    assert window.viewers.images[1].choices.port == "lens.image"
    assert np.array_equal(
        window.viewers.images[1].picture.samples, window.viewers.images[2].picture.samples
    )


def test_a_fault_inside_stands_on_the_macro(grouped, window, idle):
    grouped.double_click(grouped.head("lens"))
    link = next(link for link in window.level.network.links if link.target == "back")
    grouped.click(grouped.wire(link))
    grouped.key(KEY.Key_Delete)
    idle(window)
    assert window.canvas.content.nodes["back"].badge.kind == "incomplete"
    grouped.key(KEY.Key_PageUp, ALT)
    badge = window.canvas.content.nodes["lens"].badge
    assert badge.kind == "incomplete"
    assert badge.text.startswith("lens/back: not connected")


def test_a_copy_of_a_macro_has_its_own_inside(grouped, window, idle):
    grouped.select("lens")
    grouped.key(KEY.Key_C, CTRL)
    grouped.key(KEY.Key_V, CTRL)
    idle(window)
    assert set(window.level.network.nodes) == {"scene", "picture", "lens", "lens_2"}
    grouped.double_click(grouped.head("lens_2"))
    assert window.level.path == ("lens_2",)
    grouped.select("blur")
    grouped.key(KEY.Key_D)
    network = window.session.document.network
    assert network.nodes["lens_2"].macro.nodes["blur"].disabled
    assert not network.nodes["lens"].macro.nodes["blur"].disabled
