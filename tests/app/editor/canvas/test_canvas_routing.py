"""Wires go past the nodes in their way."""

import random

import pytest
from PySide6.QtCore import QPointF

from app.editor.canvas.canvas import Canvas
from app.editor.canvas.wires import Ground, course_of, wire_path
from app.editor.session import Level
from canvas_networks import long_chain
from core.editing.document import Document
from core.editing.operations import move_nodes, remove_nodes
from panel_hands import NoEvaluator

BESIDE = 10.0


def lane_for(start, end, boxes, beside):
    return course_of(start, end, Ground(boxes), beside)[0]


def met(start, end, lane, box):
    """Whether the wire goes through a box."""
    path = wire_path(QPointF(*start), QPointF(*end), lane)
    points = (path.pointAtPercent(n / 400) for n in range(401))
    return any(box[0] < p.x() < box[2] and box[1] < p.y() < box[3] for p in points)


def test_without_anything_in_the_way_there_is_no_lane():
    assert lane_for((0, 0), (500, 40), [(100, 200, 300, 280)], BESIDE) is None
    assert lane_for((0, 0), (60, 40), [(20, -20, 40, 80)], BESIDE) is None
    assert lane_for((500, 0), (0, 40), [(100, -20, 300, 80)], BESIDE) is None


@pytest.mark.parametrize("end_y", [0.0, 35.0, -60.0])
def test_a_node_in_the_way_is_passed(end_y):
    start, end = (0.0, 0.0), (700.0, end_y)
    boxes = [(100.0, -50.0, 280.0, 50.0), (340.0, -50.0, 520.0, 60.0)]
    lane = lane_for(start, end, boxes, BESIDE)
    assert lane is not None
    assert not any(met(start, end, lane, box) for box in boxes)
    assert any(met(start, end, None, box) for box in boxes)


def courses(canvas):
    canvas.show()
    return {link: wire.path() for link, wire in canvas.content.wires.items()}


def test_wires_run_after_edits_as_in_a_canvas_opened_anew(session, canvas, library, qtbot):
    session.open(Document(long_chain(60), library=library))
    lot = random.Random(3)
    for name in lot.sample(list(session.network.nodes), 25):
        session.do(move_nodes({name: (lot.randrange(0, 2400), lot.randrange(0, 960))}))
    session.do(remove_nodes(("jitter_20", "jitter_33")))
    session.undo()
    anew = Canvas(Level(session, session), NoEvaluator(session))
    qtbot.addWidget(anew)
    assert courses(canvas) == courses(anew)
