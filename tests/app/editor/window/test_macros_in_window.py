"""Macros in the window: grouped, opened, shown, left and ungrouped by keys and mouse."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QMenu, QToolButton, QWidgetAction

from core.editing.operations import move_nodes, set_parameter
from core.network.file import format_network
from core.network.linked_values import resolved
from core.network.macro import face_of_macro
from panel_hands import type_in
from window_hands import CTRL, KEY, SHIFT, WindowHands, show_small

SIDES = ("input", "output")
ALT = Qt.KeyboardModifier.AltModifier
MEMBERS = ("init", "blur", "back")


@pytest.fixture
def hands(window, idle):
    """On the first network, whose chain is a scene, a spectrum, a blur and the way back."""
    show_small(window, "first_steps")
    idle(window)
    made = WindowHands(window)
    made.focus()
    assert set(MEMBERS) <= set(window.session.network.nodes)
    return made


@pytest.fixture
def grouped(hands, window, idle):
    """The chain as one node, called lens; it gives the same picture, and is undone."""
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
    assert np.array_equal(before.samples, window.viewers.images[1].picture.samples)
    assert window.canvas.isAncestorOf(QApplication.focusWidget()), "Enter gives the keyboard back"
    for _ in range(2):  # its name, and the group
        hands.key(KEY.Key_Z, CTRL)
    assert text(window) == start
    for _ in range(2):
        hands.key(KEY.Key_Z, CTRL | SHIFT)
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


def inputs_and_outputs_are_drawn(window):
    """With their names, beside the nodes."""
    ends = window.canvas.content.ends
    face = face_of_macro(window.level.network)
    drawn = {side: {end.name for end in ends.ends if end.side == side} for side in SIDES}
    assert drawn == {"input": set(face.inputs), "output": set(face.outputs)}
    assert all(drawn.values())
    nodes = window.canvas.content.nodes
    for end in ends.ends:
        assert not any(node.frame().intersects(end.plate) for node in nodes.values())
        assert window.canvas.view.visible_rect().contains(end.plate)
        of = face.inputs[end.name][0] if end.side == "input" else face.outputs[end.name]
        port = nodes[of[0]].ports[end.side, of[1]].centre()
        wire = end.wires[0]
        assert wire.pointAtPercent(1.0 if end.side == "input" else 0.0) == port
    first = ends.ends[0].plate
    window.level.do(move_nodes({next(iter(nodes)): (-700.0, 0.0)}))
    assert ends.ends[0].plate != first
    window.session.undo()


def test_a_macro_is_entered_worked_in_and_left(grouped, window, idle):
    assert not window.crumbs.isVisible()
    assert window.canvas.content.ends.ends == ()
    grouped.double_click(grouped.head("lens"))
    idle(window)
    assert window.level.path == ("lens",)
    assert set(window.canvas.content.nodes) == set(MEMBERS)
    assert window.crumbs.isVisible()
    assert [button.text() for button in window.crumbs.steps] == ["First steps", "lens"]
    for button in (window.crumbs.up, *window.crumbs.steps):
        assert window.crumbs.rect().contains(button.geometry())
        assert button.visibleRegion().boundingRect().size() == button.size()
        assert button.accessibleName()
        assert button.toolTip()
    inputs_and_outputs_are_drawn(window)
    QTest.mouseClick(window.crumbs.steps[0], Qt.MouseButton.LeftButton)
    assert window.level.path == ()
    assert not window.crumbs.isVisible()
    assert window.canvas.content.ends.ends == ()
    grouped.focus()
    grouped.select("lens")
    grouped.key(KEY.Key_Return)
    assert window.level.path == ("lens",)
    QTest.keyClick(window.canvas.view, KEY.Key_PageUp, ALT)
    assert window.level.path == ()
    assert window.session.selection == ("lens",)
    # Work inside is undone across levels.
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
    # A fault inside stands on the macro.
    link = next(link for link in window.level.network.links if link.target == "back")
    grouped.click(grouped.wire(link))
    grouped.key(KEY.Key_Delete)
    idle(window)
    assert window.canvas.content.nodes["back"].badge.kind == "incomplete"
    grouped.key(KEY.Key_PageUp, ALT)
    badge = window.canvas.content.nodes["lens"].badge
    assert badge.kind == "incomplete"
    assert badge.text.startswith("lens/back: not connected")
    grouped.double_click(grouped.head("lens"))
    for _ in range(3):
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


def test_a_value_inside_follows_its_neighbour_by_the_name_it_has_there(grouped, window, idle):
    session = window.session
    grouped.focus()
    grouped.double_click(grouped.head("lens"))
    session.do(set_parameter("lens/init", "f_number", 2.0))
    grouped.select("blur")
    sigma = field(window, "lens/blur", "sigma_x_mrad")
    type_in(sigma.edit, "= int.f_number * 0.2")
    assert "did you mean" in sigma.message.text()
    type_in(sigma.edit, "= init.f_number * 0.2")
    assert sigma.edit.text() == "= init.f_number * 0.2"
    assert sigma.linked_value.text().startswith("= 0.4 ")
    inside = session.document.network.nodes["lens"].macro.nodes["blur"]
    assert inside.params["sigma_x_mrad"] == {"expression": "init.f_number * 0.2"}
    idle(window)
    planned = resolved(session.document.network, library=session.library)
    assert planned.value("lens/blur", "sigma_x_mrad") == 0.4
    # What the macro shows may be followed, and follow.
    grouped.select("init")
    choose(window, "lens/init", "f_number", "expose")
    QTest.keyClick(window.canvas.view, KEY.Key_PageUp, ALT)
    stop = field(window, "lens", "f_number")
    type_in(stop.edit, "= scene.width / 128")
    width = resolved(session.document.network, library=session.library).value("scene", "width")
    width = session.declared("scene").parameter("width").default if width is None else width
    assert stop.linked_value.text().startswith(f"= {width / 128:g}")
    assert session.valued("lens/blur").params["sigma_x_mrad"] == pytest.approx(width / 128 * 0.2)
    type_in(stop.edit, "= scene.nothing")
    assert "has no parameter" in stop.message.text()
    QTest.keyClick(stop.edit, KEY.Key_Escape)
    grouped.select("lens")
    grouped.focus()
    grouped.key(KEY.Key_G, CTRL | SHIFT)
    nodes = session.document.network.nodes
    assert nodes["blur"].params["sigma_x_mrad"] == {"expression": "init.f_number * 0.2"}
    assert nodes["init"].params["f_number"] == {"expression": "scene.width / 128"}
    idle(window)


def library_item(window, text):
    tree = window.library_view.tree
    return next(item for item in tree.modules.values() if item.text(0) == text)


def click_twice(window, item):
    tree = window.library_view.tree
    tree.scrollToItem(item)
    where = tree.visualItemRect(item).center()
    QTest.mouseClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=where)
    QTest.mouseDClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=where)


def test_presets_and_sets_of_values_are_kept_and_taken_again(grouped, window, settings):
    item = library_item(window, "Kodak KIR-310")
    assert item.parent().text(0) == "Camera presets"
    assert "Tantalo 1996" in item.toolTip(0)
    click_twice(window, item)
    assert window.session.selection == ("camera",)
    panel = window.panels.panels["camera"]
    assert panel.head.name.text() == "camera"
    assert panel.head.bar.title.text() == "Kodak KIR-310"
    assert panel.body.sections.field("focal_length_mm").value == 200.0
    window.library_view.filter.setText("tau germanium 50")
    shown = [i.text(0) for i in window.library_view.tree.modules.values() if not i.isHidden()]
    assert shown == ["FLIR Tau 2 lens, 50 mm F/1.2"]

    window.library_view.filter.clear()
    # An own macro becomes a preset.
    window.session.select(["lens"])
    window.actions_by_name["save_preset"].trigger()
    folder = settings.path.parent / "presets"
    assert [path.name for path in folder.iterdir()] == ["lens.json"]
    assert str(folder) in window.status.said("information")
    item = library_item(window, "lens")
    assert item.parent().text(0) == "Own presets"
    click_twice(window, item)
    assert window.session.selection == ("lens_2",)
    window.session.select(["lens"])
    window.actions_by_name["save_preset"].trigger()
    assert "a preset lens already exists" in window.status.said("error")
    assert [path.name for path in folder.iterdir()] == ["lens.json"]
    # Parameters are saved as a set and taken again.
    window.session.select(["scene"])
    QApplication.processEvents()
    panel = window.panels.panels["scene"]
    params = dict(window.session.network.nodes["scene"].params)
    menu = panel.sets_menu
    menu.popup(panel.head.sets.mapToGlobal(QPoint(0, 0)))
    line = menu.findChild(QLineEdit, "set_name")
    line.setFocus()
    QTest.keyClicks(line, "as shipped")
    QTest.keyClick(line, KEY.Key_Return)
    assert (folder / "parameters" / "test_scene.json").is_file()
    field(window, "scene", "fov_x_deg").offer(3.0)
    assert dict(window.session.network.nodes["scene"].params) != params
    menu.popup(panel.head.sets.mapToGlobal(QPoint(0, 0)))
    entry = next(each for each in menu.actions() if each.text() == "as shipped")
    entry.trigger()
    menu.close()
    assert dict(window.session.network.nodes["scene"].params) == params
    assert window.session.document.undo_text == "Set scene to as shipped"
