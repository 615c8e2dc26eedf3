"""Wires go past the nodes in their way."""

import random

import pytest
from PySide6.QtCore import QPointF

from app.editor.canvas import wires
from app.editor.canvas.canvas import Canvas
from app.editor.canvas.content import distance
from app.editor.canvas.wires import Ground, course_of, overlap, wire_path
from canvas_networks import long_chain
from core.editing.document import Document
from core.editing.operations import Move, Remove

BESIDE = 10.0


def lane_for(start, end, boxes, beside):
    return course_of(start, end, Ground(boxes), beside).lane


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


def test_the_lane_below_is_taken_where_it_is_much_nearer():
    boxes = [(100.0, -400.0, 280.0, 20.0)]
    assert lane_for((0, 0), (700, 0), boxes, BESIDE) == 20.0 + BESIDE


def test_a_lane_that_is_taken_is_passed_too():
    boxes = [(100.0, -50.0, 280.0, 50.0), (340.0, -140.0, 520.0, -55.0), (100.0, 55, 280, 4000.0)]
    lane = lane_for((0, 0), (700, 0), boxes, BESIDE)
    assert not any(box[1] < lane < box[3] for box in boxes)


def test_paths_begin_and_end_at_the_ports():
    for lane in (None, -80.0):
        path = wire_path(QPointF(3, 4), QPointF(600, 90), lane)
        assert path.pointAtPercent(0) == QPointF(3, 4)
        assert path.pointAtPercent(1) == QPointF(600, 90)


def test_distance_to_a_broken_line():
    line = [QPointF(0, 0), QPointF(10, 0), QPointF(10, 10)]
    assert distance(line, QPointF(5, 3)) == pytest.approx(3.0)
    assert distance(line, QPointF(13, 14)) == pytest.approx(5.0)
    assert distance(line, QPointF(10, 5)) == 0.0


def courses(canvas):
    canvas.show()
    return {link: wire.path() for link, wire in canvas.content.wires.items()}


def test_only_nodes_within_a_wires_reach_change_its_course():
    lot = random.Random(5)
    boxes = [(x, y, x + 170.0, y + 90.0) for x in range(0, 2400, 260) for y in range(0, 1600, 200)]
    lanes = 0
    for _ in range(300):
        some = lot.sample(boxes, 50)
        start, end = ((lot.uniform(0, 2400), lot.uniform(0, 1600)) for _ in range(2))
        course = course_of(start, end, Ground(some), BESIDE)
        lanes += course.lane is not None
        x, y = lot.uniform(-200, 2600), lot.uniform(-200, 1800)
        new = (x, y, x + 170.0, y + 90.0)
        if not overlap(new, course.reach):
            assert course_of(start, end, Ground([*some, new]), BESIDE).lane == course.lane
    assert lanes > 50


def test_wires_run_after_edits_as_in_a_canvas_opened_anew(session, canvas, library, qtbot):
    session.open(Document(long_chain(60), library=library))
    lot = random.Random(3)
    for name in lot.sample(list(session.network.nodes), 25):
        session.do(Move({name: (lot.randrange(0, 2400), lot.randrange(0, 960))}))
    session.do(Remove(("jitter_20", "jitter_33")))
    session.undo()
    anew = Canvas(session)
    qtbot.addWidget(anew)
    assert courses(canvas) == courses(anew)


def test_a_move_leads_few_wires(session, canvas, library, monkeypatch):
    session.open(Document(long_chain(400), library=library))
    led = []

    def count(*given):
        led.append(given)
        return course_of(*given)

    monkeypatch.setattr(wires, "course_of", count)
    x, y = session.network.layout["jitter_397"]
    session.do(Move({"jitter_397": (x, y + 50)}))
    assert 0 < len(led) <= 40  # of 797
