"""The map in the corner: there when it is of use, true to the scene, and a way to go elsewhere."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from canvas_networks import long_chain
from core.editing.document import Document
from core.editing.operations import move_nodes

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


@pytest.fixture
def chain(session, library, canvas):
    """A hundred nodes far from each other, so that a corner of the view is mostly free."""
    dense = long_chain(100)
    layout = {name: (960.0 * (n % 11), 640.0 * (n // 11)) for n, name in enumerate(dense.nodes)}
    session.open(Document(replace(dense, layout=layout), library=library))
    canvas.frame_all()
    return session


def spot(canvas, point):
    """The pixel of the map at a point of the scene, from the corners of the whole network."""
    whole, size = canvas.content.bounds(), canvas.minimap.size()
    share_x = (point.x() - whole.left()) / whole.width()
    share_y = (point.y() - whole.top()) / whole.height()
    inset = 6
    return QPoint(
        round(inset + share_x * (size.width() - 2 * inset)),
        round(inset + share_y * (size.height() - 2 * inset)),
    )


def test_it_is_shown_while_something_is_out_of_sight_and_a_press_goes_there(chain, canvas):
    assert not canvas.minimap.isVisible()
    for name in ("scene", "jitter_97"):
        canvas.zoom_by(8.0)
        assert canvas.minimap.isVisible()
        corner = canvas.minimap.geometry().bottomRight()
        assert canvas.view.viewport().rect().contains(corner)
        middle = canvas.content.nodes[name].frame().center()
        QTest.mouseClick(canvas.minimap, LEFT, PLAIN, spot(canvas, middle))
        seen = canvas.view.visible_rect()
        assert seen.contains(middle)
        whole = canvas.content.bounds()
        assert abs(seen.center().x() - middle.x()) < whole.width() / canvas.minimap.width() * 2
        assert canvas.view.hasFocus()
        canvas.frame_all()
        assert not canvas.minimap.isVisible()


def covered(canvas):
    ground = canvas.view.mapToScene(canvas.minimap.geometry()).boundingRect()
    return any(ground.intersects(node.frame()) for node in canvas.content.nodes.values())


def test_a_node_dragged_under_it_drives_it_away(chain, canvas, hand):
    for _ in range(20):
        hand.wheel(hand.middle("jitter_50"), 120)
    first = canvas.minimap.pos()
    assert not covered(canvas)
    hand.drag(hand.head("jitter_50"), canvas.minimap.geometry().center())
    assert canvas.minimap.isVisible()
    assert canvas.minimap.pos() != first
    assert not covered(canvas)


def test_it_covers_no_node_but_moves_to_a_free_corner_or_hides(chain, canvas):
    canvas.zoom_by(8.0)
    shown = [canvas.minimap.pos()]
    here = canvas.view.visible_rect()
    corners = [(here.right(), here.bottom()), (here.left(), here.bottom()),
               (here.right(), here.top()), (here.left(), here.top())]  # fmt: skip
    for number, (x, y) in enumerate(corners):
        place = (x - 120 if number % 2 == 0 else x + 20, y - 80 if number < 2 else y + 20)
        chain.do(move_nodes({f"jitter_{number + 1}": place}))
        if number < 3:
            assert canvas.minimap.isVisible()
            assert not covered(canvas)
            shown.append(canvas.minimap.pos())
    assert not canvas.minimap.isVisible()
    assert len({at.toTuple() for at in shown}) == 4  # each of the corners in its turn
    chain.undo()
    assert canvas.minimap.isVisible()
