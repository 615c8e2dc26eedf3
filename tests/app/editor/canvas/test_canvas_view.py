"""Panning, zooming, framing, the menus of the right button, and where things are on the screen."""

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QAction

from core.network.network import Link

MIDDLE = Qt.MouseButton.MiddleButton


def scene_at(canvas, pos):
    return canvas.view.mapToScene(pos)


def near(one, other, within):
    return (QPointF(one) - QPointF(other)).manhattanLength() <= within


def test_the_wheel_zooms_at_the_pointer_and_the_middle_button_pans(opened, canvas, hand):
    session = opened("first_steps")
    network, pos = session.network, QPoint(700, 150)
    before, zoom = scene_at(canvas, pos), canvas.view.zoom
    hand.wheel(pos, -240)
    assert canvas.view.zoom < zoom
    assert near(scene_at(canvas, pos), before, 2 / canvas.view.zoom)
    hand.wheel(pos, 480)
    assert canvas.view.zoom > zoom
    assert near(scene_at(canvas, pos), before, 2 / canvas.view.zoom)
    pos = hand.at(100, 300)
    point = scene_at(canvas, pos)
    hand.drag(pos, pos + QPoint(-130, 70), button=MIDDLE)
    assert near(scene_at(canvas, pos + QPoint(-130, 70)), point, 1.5)
    assert session.network is network
    # Framing shows every node no larger than natural.
    canvas.resize(900, 420)
    for name in ("first_steps", "kodak_kir310"):
        opened(name)
        canvas.frame_all()
        seen = canvas.view.mapToScene(canvas.view.viewport().rect()).boundingRect()
        assert seen.contains(canvas.content.bounds())
        assert (canvas.view.zoom / canvas.view.style_of_canvas.natural_zoom) <= 1.0


def test_the_zoom_ends_at_a_fiftieth_and_at_four_times_the_natural_one(opened, canvas):
    opened("first_steps")
    view = canvas.view
    natural = view.style_of_canvas.natural_zoom
    for factor, ends in ((1e9, 4.0), (0.5, 2.0), (1e-9, 0.02), (0.5, 0.02), (3.0, 0.06)):
        view.zoom_at(factor)
        assert view.zoom == pytest.approx(ends * natural)
    view.zoom = 0.006 * natural  # as where a large network is framed: no smaller, but larger
    view.zoom_at(0.5)
    assert view.zoom == pytest.approx(0.006 * natural)
    view.zoom_at(1.5)
    assert view.zoom == pytest.approx(0.009 * natural)


def test_menus_pop_up_for_what_is_under_the_pointer(opened, canvas, hand):
    session = opened("first_steps")
    rename, paste = QAction("Rename", canvas), QAction("Paste", canvas)
    canvas.menus.fill([rename], [paste])
    hand.ask_for_menu(hand.head("blur"))
    assert canvas.menus.node_menu.isVisible()
    assert canvas.menus.node_menu.actions()[:-1] == [rename]
    assert canvas.menus.node_menu.actions()[-1].text() == "Co&lour"
    assert session.selection == ("blur",)
    canvas.menus.node_menu.close()
    session.select(["scene", "blur"])  # which the menu of one of them keeps
    hand.ask_for_menu(hand.head("blur"))
    assert session.selection == ("scene", "blur")
    canvas.menus.node_menu.close()
    hand.ask_for_menu(hand.at(100, 250))
    assert canvas.menus.canvas_menu.isVisible()
    assert canvas.menus.canvas_menu.actions() == [paste]
    canvas.menus.canvas_menu.close()
    # A wire is disconnected from its menu.
    link = Link.between("scene.image", "init.image")
    hand.ask_for_menu(hand.wire(link))
    assert canvas.menus.wire_menu.isVisible()
    assert canvas.marks.link == link
    action = canvas.menus.wire_menu.actions()[0]
    action.trigger()
    canvas.menus.wire_menu.close()
    assert link not in session.network.links
