"""The pupil on the panel of Exit Pupils: what is drawn, and when."""

import numpy as np
import pytest

from app.editor.evaluation.queries import Answer
from core.editing.operations import set_parameter
from core.errors import DataError
from illustration_hands import grey_pixels, sensor, told


def test_an_answer_that_comes_late_does_not_hide_what_the_document_says(bench):
    widget = bench.show(sensor("exit_pupil"))
    query, owner = widget.queries()[0], widget.owner
    bench.evaluator.answered.emit(Answer(99, owner, query, error=DataError("of an old edit")))
    assert told(widget).startswith("clear")
    assert not widget.problem
    widget.session.do(set_parameter("node", "radius", 400.0))
    bench.evaluator.answered.emit(Answer(99, owner, query, None))
    assert "diameter 800" in told(widget)
    assert widget.problem


def test_a_value_that_is_not_allowed_is_said_until_it_is_mended(qtbot, session, bench):
    widget = bench.show(sensor("exit_pupil"))
    session.do(set_parameter("node", "radius", 400.0))
    assert "at least the aperture's diameter 800" in told(widget)
    assert widget.problem
    session.do(set_parameter("node", "radius", 100.0))
    assert not widget.problem or not told(widget).startswith("size_x")
    bench.settle()
    assert told(widget).startswith("clear")
    assert not widget.problem


def test_what_is_open_of_a_shape_is_light(session, bench):
    """The half moon is open at its right."""
    widget = bench.show(sensor("exit_pupil", {"radius": 200.0}), evaluated=False)

    def light():
        pixels = grey_pixels(widget)[20:105] > 200
        return pixels[:, 45:90].mean(), pixels[:, 98:143].mean()

    left, right = light()
    assert left == pytest.approx(right, abs=0.05)
    assert left > 0.5
    session.do(set_parameter("node", "shape", "half_moon"))
    assert light() == pytest.approx((0.0, right), abs=0.05)


def test_the_middle_of_the_array_is_drawn_where_the_aperture_is_small(session, bench):
    widget = bench.show(sensor("exit_pupil", {"radius": 20.0, "size_x": 1024}), evaluated=False)
    assert widget.shown_samples() == (128.0, 64.0)
    session.do(set_parameter("node", "radius", 200.0))
    widget.grab()
    assert widget.shown_samples() == (1024.0, 512.0)


def test_a_wavefront_error_is_coloured(session, bench):
    widget = bench.show(sensor("exit_pupil", {"radius": 200.0}), evaluated=False)

    def colours():
        image = widget.grab().toImage()
        places = [(x, y) for x in range(0, 180, 3) for y in range(0, image.height(), 3)]
        return max(image.pixelColor(x, y).hsvSaturation() for x, y in places)

    assert colours() < 60
    session.do(set_parameter("node", "defocus_waves", 0.5))
    assert colours() > 120
    assert "rms 0.14" in told(widget)


def test_a_file_of_a_pupil_takes_the_place_of_a_shape_and_gives_way_again(
    qtbot, session, bench, tmp_path
):
    np.save(tmp_path / "pupil.npy", np.tile([0.0, 1.0], (32, 16)))
    widget = bench.show(sensor("exit_pupil", {"path": "pupil.npy"}))
    assert told(widget).startswith("clear")
    session.do(set_parameter("node", "shape", "file"))
    bench.settle()
    assert told(widget) == "file, 32 × 32 samples, 50 % transmitted"
    session.undo()
    assert told(widget).startswith("clear")
    assert widget.pupil is not None
