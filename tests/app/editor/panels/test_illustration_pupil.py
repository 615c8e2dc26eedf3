"""The pupil on the panel of Exit Pupils: what is drawn, and when."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QBrush, QColor, QImage, QPainter

from app.editor.evaluation.queries import Answer
from app.editor.panels.illustrations.exit_pupil_illustration import draw_pupil
from core.editing.operations import set_parameter
from core.errors import DataError
from core.physics.optics.pupil_shapes import PupilShape, sample_pupil
from illustration_hands import IllustrationBench, sensor, told


@pytest.fixture
def bench(qtbot, session, tmp_path):
    made = IllustrationBench(qtbot, session, tmp_path)
    yield made
    made.close()


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


def drawn(shape, size=(512, 400), side=1024):
    """A pupil as it is drawn on that many pixels across: 0 opaque to 1 transparent."""
    high = round(side * size[1] / size[0])
    image = QImage(side, high, QImage.Format.Format_Grayscale8)
    image.fill(128)
    with QPainter(image) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        box = QRectF(0, 0, side, high)
        draw_pupil(painter, box, shape, size, QBrush(QColor("white")), QColor("black"))
    return np.frombuffer(image.constBits(), np.uint8).reshape(high, side) / 255.0


CHORD = 2 / math.pi * (0.25 * math.sqrt(1 - 0.25**2) + math.asin(0.25))


@pytest.mark.parametrize(
    ("shape", "share"),
    [
        (PupilShape("clear", 190.0), 1.0),
        (PupilShape("half_moon", 190.0), 0.5),
        (PupilShape("cassegrain", 190.0, 95.0), 0.75),
        (PupilShape("hinged", 190.0, slit_width=95.0), 1 - CHORD),
        (PupilShape("spider", 190.0, vanes=2, vane_width=95.0), 1 - CHORD),
    ],
    ids=lambda value: getattr(value, "shape", ""),
)
def test_the_drawing_of_a_pupil_has_its_area(shape, share):
    pixels = drawn(shape)
    area = pixels.sum() * (512 / 1024) ** 2
    assert area == pytest.approx(share * math.pi * 190.0**2, rel=2e-3)


def test_the_open_half_of_a_half_moon_is_at_the_right():
    pixels = drawn(PupilShape("half_moon", 190.0))
    assert not pixels[:, :510].any()
    assert pixels[400, 600] == 1


def test_vanes_lie_where_the_samples_have_them():
    shape = PupilShape("spider", 190.0, 40.0, vanes=3, vane_width=20.0)
    samples = sample_pupil(shape, rows=400, columns=512)
    pixels = drawn(shape).reshape(400, 2, 512, 2).mean(axis=(1, 3))
    assert np.abs(pixels - samples).mean() < 5e-3
    assert np.count_nonzero(np.abs(pixels - samples) > 0.9) == 0


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
