"""The window goes on whatever the worker computes, and shows pictures while it is edited.

How long its event loop stands still, and how many pictures a second it shows, depends on the
machine: ``tests/benchmarks/run.py --only editor`` measures that. Here events are counted.
"""

import itertools

import pytest
from PySide6.QtCore import QCoreApplication, QPoint, Qt
from PySide6.QtTest import QTest

from core.editing.operations import set_parameter
from editor_queries import Asking, Gate, Readouts, Samples
from scripted_drag import drag
from slider_drag import handle_of, open_slider
from trial_window import PaintedPictures

FINAL = Samples("frame_grabber.image")
LEFT = Qt.MouseButton.LeftButton
PICTURES = 3

# What is dragged, and between which values: an MTF, and the scene itself.
DRAGS = [("aberration", "sigma_x_mrad", 0.05, 0.5), ("scene", "temperature_K", 285.0, 300.0)]


def edits(node, name, low, high):
    values = (low + (high - low) * (step % 250) / 250 for step in itertools.count())
    return (set_parameter(node, name, value) for value in values)


def test_while_the_worker_computes_edits_are_taken_and_events_handled(opened, evaluator, qtbot):
    """The worker is held in the middle of its pass: whoever waited for it would wait for ever."""
    session, gate, turns = opened("kodak_kir310"), Gate(), []
    evaluator.ask("viewer", [Asking(gate)])
    qtbot.waitUntil(gate.entered.is_set)
    for operation in itertools.islice(edits(*DRAGS[0]), 50):
        session.do(operation, gesture="drag")
        QCoreApplication.processEvents()
        turns.append(evaluator.idle)
    session.end_gesture()
    assert turns == [False] * 50
    gate.opened.set()
    qtbot.waitUntil(lambda: evaluator.idle)


@pytest.mark.parametrize("dragged", DRAGS, ids=lambda each: f"{each[0]}.{each[1]}")
def test_pictures_of_1024_follow_edits_that_do_not_pause(opened, evaluator, qtbot, dragged):
    session = opened("kodak_kir310")
    assert session.network.nodes["scene"].params["width"] == 1024
    evaluator.ask("viewer", [FINAL])
    evaluator.ask("panel", [Readouts("electronics")])
    qtbot.waitUntil(lambda: evaluator.idle)
    seen = drag(
        qtbot,
        session,
        evaluator,
        edits(*dragged),
        lambda so_far: len(so_far.full) + len(so_far.previews) >= PICTURES,
    )
    for shown in (seen.full, seen.previews):
        numbers = [answer.generation for answer in shown]
        assert numbers == sorted(set(numbers))
    assert seen.edits > 0
    qtbot.waitUntil(lambda: evaluator.idle)


# The sizes of pictures, and the slider that is dragged.
WINDOWS = [(1024, "aberration", "sigma_x_mrad")]


@pytest.mark.parametrize("dragged", WINDOWS, ids=lambda each: f"{each[0]}-{each[1]}.{each[2]}")
def test_the_whole_window_paints_pictures_while_a_slider_is_held(window, qtbot, dragged):
    """All of it: canvas, panel with its illustration, viewers, curves, figures."""
    window.resize(1600, 900)
    slider = open_slider(window, *dragged)
    painted = PaintedPictures(window, window.viewers.images[1])
    values, handle = set(), handle_of(slider)
    # The hand holds the slider and moves on once it has seen the picture: each is painted in the
    # middle of the gesture.
    QTest.mousePress(slider, LEFT, pos=handle)
    for number in range(PICTURES):
        QTest.mouseMove(slider, QPoint(slider.width() * (number + 2) // 6, handle.y()))
        values.add(window.session.network.nodes[dragged[1]].params[dragged[2]])
        qtbot.waitUntil(lambda number=number: len(painted.times) > number)
    assert slider.isSliderDown()
    QTest.mouseRelease(slider, LEFT, pos=handle)
    assert len(values) == PICTURES
