"""Dots on wires, put in, dragged and deleted with real events in the window."""

from PySide6.QtCore import QPoint, QPointF
from PySide6.QtWidgets import QMenu

from canvas_networks import chain_and_free_blur
from core.editing.backdrops import add_dot, dots_of
from core.network.network import Link
from window_hands import CTRL, KEY

WIRE = Link.between("init.magnitude", "back.magnitude")
OTHER = Link.between("scene.image", "init.image")


def dots(session, link=WIRE):
    return dots_of(session.network).get(link, ())


def steps(session):
    return session.document.position


def drawn(window, link=WIRE):
    return window.canvas.content.wires[link]


def nearest(wire, x, y):
    """How near to a point the ends of the curve's pieces lie."""
    path = wire.path()
    ends = (path.elementAt(n) for n in range(path.elementCount()))
    return min((QPointF(end.x, end.y) - QPointF(x, y)).manhattanLength() for end in ends)


def test_dots_are_put_in_dragged_and_deleted_by_the_mouse(window, hand, chain):
    spot = hand.wire(WIRE)
    hand.double_click(spot)
    ((x, y),) = dots(chain)
    at = window.canvas.view.scene_point(spot)
    assert max(abs(x - at.x()), abs(y - at.y())) <= 1
    assert window.canvas.marks.dot == 0
    assert steps(chain) == 1
    assert not window.canvas.popup.is_open
    hand.key(KEY.Key_Z, CTRL)
    assert not dots(chain)
    # One below the wire is dragged, and the wire goes through it.
    chain.do(add_dot(chain.network, WIRE, 0, (500.0, 120.0)))
    window.canvas.frame_all()
    hand.drag(hand.at(500, 120), hand.at(480, 190))
    ((x, y),) = dots(chain)
    assert abs(x - 480) <= 3
    assert abs(y - 190) <= 3
    assert nearest(drawn(window), x, y) < 1
    assert steps(chain) == 2
    hand.key(KEY.Key_Z, CTRL)
    assert dots(chain) == ((500.0, 120.0),)
    assert nearest(drawn(window), 500, 120) < 1
    # The menu of the wire adds one, where there is none.
    assert not entry_of(window, hand, hand.at(500, 120), "Add Dot").isEnabled()
    entry_of(window, hand, hand.wire(WIRE), "Add Dot").trigger()
    assert len(dots(chain)) == 2
    hand.key(KEY.Key_Z, CTRL)
    # Dots go along with both nodes and stay with one.
    hand.drag(hand.head("back"), hand.head("back") + QPoint(30, 0))
    assert dots(chain) == ((500.0, 120.0),)
    hand.select("init", "back")
    before, position = chain.network.layout, steps(chain)
    hand.press(hand.head("back"))
    hand.move(hand.head("back"), hand.head("back") + QPoint(0, 60))
    assert drawn(window).dots[0].y() > 130
    hand.release(hand.head("back"))
    by = chain.network.layout["back"][1] - before["back"][1]
    assert by > 10
    assert dots(chain)[0] == (500.0, 120.0 + by)
    assert steps(chain) == position + 1
    hand.key(KEY.Key_Z, CTRL)
    hand.key(KEY.Key_Z, CTRL)
    assert dots(chain) == ((500.0, 120.0),)
    # Del deletes the selected dot, then the wire.
    hand.click(hand.at(500, 120))
    assert window.canvas.marks.dot == 0
    hand.key(KEY.Key_Delete)
    assert chain.network == chain_and_free_blur()
    assert window.canvas.marks.link == WIRE
    hand.key(KEY.Key_Delete)
    assert WIRE not in chain.network.links
    hand.key(KEY.Key_Z, CTRL)
    hand.key(KEY.Key_Z, CTRL)
    assert dots(chain) == ((500.0, 120.0),)


def entry_of(window, hand, pos, text):
    """An entry of the menu of a wire."""
    hand.ask_for_menu(pos)
    menu = window.findChild(QMenu, "canvas.menu.wire")
    assert menu.isVisible()
    action = next(a for a in menu.actions() if a.text().replace("&", "") == text)
    menu.hide()
    hand.focus()
    return action


def test_keys_alone_bend_move_and_straighten_a_wire(window, hand, chain):
    """From a selected node: R puts a dot on its wire, arrows move it, Del deletes it."""
    window.canvas.mouse.leave()
    chain.select(["scene"])
    hand.key(KEY.Key_R)
    ((x, y),) = dots(chain, OTHER)
    assert not chain.selection
    hand.key(KEY.Key_Down)
    hand.key(KEY.Key_Down)
    ((moved_x, moved_y),) = dots(chain, OTHER)
    assert (moved_x - x, moved_y - y) == (0, 24)
    hand.key(KEY.Key_Delete)
    assert not dots(chain, OTHER)
