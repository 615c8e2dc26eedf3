"""Nodes and wires added by the lists that float on the canvas, and by what is dropped on it."""

from functools import partial

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDragMoveEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editor.canvas.adding import possible_links
from app.editor.library_view import module_data
from core.editing.operations import remove_nodes
from core.network.network import Link
from window_hands import drag_event

COPY = Qt.DropAction.CopyAction
NONE = Qt.KeyboardModifier.NoModifier
LEFT = Qt.MouseButton.LeftButton


def titles(canvas):
    rows = range(canvas.popup.list.count())
    return [canvas.popup.list.item(row).text() for row in rows]


def position(session):
    return session.document.position


def test_modules_are_searched_by_tab_and_added_by_keys_and_mouse(session, canvas, hand, library):
    hand.click(hand.at(120, 60))
    hand.key(Qt.Key.Key_Tab)
    assert canvas.popup.is_open
    assert len(titles(canvas)) == len(library)
    assert QApplication.activeModalWidget() is None
    hand.type("gauss")
    assert titles(canvas) == ["Gaussian MTF"]
    hand.key(Qt.Key.Key_Return)
    assert not canvas.popup.is_open
    assert session.network.nodes["gaussian_mtf"].module == "gaussian_mtf"
    assert session.network.layout["gaussian_mtf"] == (120.0, 60.0)
    assert session.selection == ("gaussian_mtf",)
    assert position(session) == 1
    assert canvas.view.hasFocus()
    canvas.open_search()
    for typed, title in (
        ("zyx", None),
        ("turbul", "Atmosphere MTF"),  # of its summary
        ("roi", "Measured MTF"),
        ("netd", "Figures of Merit"),
        ("charge_eff_p", "Charge Transfer Phase"),
        ("motion", "Jitter MTF"),
        ("Electronics &", "Electronics & Noise"),
    ):
        canvas.popup.field.setText(typed)
        assert (title in titles(canvas)) if title else not titles(canvas)
    canvas.popup.field.clear()
    hand.type("scene")
    hand.key(Qt.Key.Key_Down)
    hand.key(Qt.Key.Key_Up)
    hand.key(Qt.Key.Key_Return)
    assert "test_scene" in session.network.nodes
    canvas.open_search()
    listed, before = canvas.popup.list, set(session.network.nodes)
    row = listed.visualItemRect(listed.item(2)).center()
    title = listed.item(2).text()
    QTest.mouseClick(listed.viewport(), LEFT, NONE, row)
    (added,) = set(session.network.nodes) - before
    assert session.declared(added).title == title


# --- wiring by the keyboard -----------------------------------------------------------------------


def test_possible_wires_fit(opened, library):
    network = opened("first_steps").network
    found = possible_links(network, library, ["back"])
    links = [str(link) for link in found]
    assert "scene.image → back.magnitude" not in links
    assert "back.image → init.image" not in links  # a cycle
    assert "init.magnitude → back.magnitude" in links
    remark = found[Link.between("init.magnitude", "back.magnitude")]
    assert remark == "instead of blur.magnitude"
    assert "blur.magnitude → back.magnitude" not in links  # is there already


# --- drops ----------------------------------------------------------------------------------------


def drag_and_drop(canvas, data, pos, *, leave=False, over=lambda: None):
    """What Qt sends while something is dragged over the canvas; whether it was taken."""
    viewport = canvas.view.viewport()
    QApplication.sendEvent(viewport, drag_event(QDragEnterEvent, pos, COPY, data, LEFT, NONE))
    moving = drag_event(QDragMoveEvent, pos, COPY, data, LEFT, NONE)
    QApplication.sendEvent(viewport, moving)
    over()
    if leave:
        QApplication.sendEvent(viewport, QDragLeaveEvent())
        return False
    event = QDropEvent(QPointF(pos), COPY, data, LEFT, NONE)
    QApplication.sendEvent(viewport, event)
    return moving.isAccepted() and event.isAccepted()


def test_a_module_dropped_on_a_wire_is_put_into_it(opened, canvas, hand):
    session = opened("first_steps")
    canvas.frame_all()
    link = Link.between("blur.magnitude", "back.magnitude")
    drag_and_drop(canvas, module_data("jitter_mtf"), hand.wire(link), leave=True)
    assert not canvas.content.wires[link].target
    assert drag_and_drop(canvas, module_data("jitter_mtf"), hand.wire(link))
    assert link not in session.network.links
    assert Link.between("blur.magnitude", "jitter_mtf.magnitude") in session.network.links
    assert Link.between("init.context", "jitter_mtf.context") in session.network.links
    assert position(session) == 1


def test_a_wire_may_go_while_a_module_is_over_it(opened, canvas, hand):
    session, data = opened("first_steps"), module_data("jitter_mtf")
    canvas.frame_all()
    place = hand.wire(Link.between("blur.magnitude", "back.magnitude"))
    go = partial(session.do, remove_nodes(["blur"]))
    drag_and_drop(canvas, data, place, leave=True, over=go)
    assert not any(wire.target for wire in canvas.content.wires.values())
