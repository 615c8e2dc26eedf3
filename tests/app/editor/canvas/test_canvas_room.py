"""Room on the canvas: neighbours make way, new nodes stand free and go on from the selected one."""

import itertools

import pytest
from PySide6.QtCore import Qt

from core.network.network import Link


def overlapping(canvas):
    """Pairs of nodes whose frames meet."""
    frames = {name: item.frame() for name, item in canvas.content.nodes.items()}
    return [
        pair
        for pair in itertools.combinations(frames, 2)
        if frames[pair[0]].intersects(frames[pair[1]])
    ]


def links_of(session):
    return {str(link) for link in session.network.links}


@pytest.fixture
def kodak(opened):
    return opened("kodak_kir310")


def add_by_tab(canvas, hand, typed):
    hand.key(Qt.Key.Key_Tab)
    hand.type(typed)
    hand.key(Qt.Key.Key_Return)


def test_a_node_dragged_onto_a_wire_pushes_its_neighbours_aside(kodak, canvas, hand):
    session = kodak
    hand.click(hand.at(-300, 900))
    canvas.add_module("jitter_mtf")
    before = dict(session.network.layout)
    steps = session.document.position
    wire = Link.between("detector.magnitude", "charge.magnitude")
    canvas.frame_all()
    hand.drag(hand.head("jitter_mtf"), hand.wire(wire))
    assert "jitter_mtf.magnitude → charge.magnitude" in links_of(session)
    assert overlapping(canvas) == []
    moved = [name for name, at in session.network.layout.items() if before.get(name) != at]
    assert "charge" in moved
    assert session.document.position == steps + 1
    session.undo()
    assert session.network.layout == before


def test_nodes_added_at_one_point_stand_beside_each_other(session, canvas, hand):
    for _ in range(5):
        session.select(())
        hand.click(hand.at(100, 100))
        add_by_tab(canvas, hand, "test scene")
    assert len(session.network.nodes) == 5
    assert overlapping(canvas) == []


def test_with_a_node_selected_tab_wires_the_new_one_on(kodak, canvas, hand):
    session = kodak
    hand.click(hand.head("detector"))
    add_by_tab(canvas, hand, "jitter")
    assert session.selection == ("jitter_mtf",)
    assert {
        "detector.magnitude → jitter_mtf.magnitude",
        "jitter_mtf.magnitude → charge.magnitude",
        "init.context → jitter_mtf.context",
    } <= links_of(session)
    assert overlapping(canvas) == []
    frames = {name: item.frame() for name, item in canvas.content.nodes.items()}
    assert frames["detector"].right() < frames["jitter_mtf"].left()
    assert frames["jitter_mtf"].right() < frames["charge"].left()
    # Again, from the new one: the chain grows.
    add_by_tab(canvas, hand, "vibration")
    assert "jitter_mtf.magnitude → vibration_mtf.magnitude" in links_of(session)
    session.undo()
    session.undo()
    assert "detector.magnitude → charge.magnitude" in links_of(session)
