"""Long tails: light that lies farther from an edge than its own surroundings reach."""

import numpy as np
import pytest

from app.measure.measurement_text import remarks
from app.measure.measuring import Source, edges_of, measure_pictures
from app.measure.picture_measurement import MeasuredFile
from camera_scenes import box, half, turned
from oversampled_camera import Camera, half_plane, take, true_mtf
from oversampled_scene import Scene, Shape

CAMERA = {"cutoff": 1.2, "jitter": 0.3, "gain_e_per_dn": 2.0, "read_e": 10.0}


def picture(tail, *, rows=150, columns=200, middle=(100, 75), angle=6.0):
    camera = Camera(**CAMERA, tail=tail)
    scene = half_plane(angle, middle, 2000, 20000)
    taken = take(scene, camera, rows=rows, columns=columns, seed=4, fine=4, margin=120)
    return camera, taken.picture


def measured(samples):
    (edge,) = [edge for edge in edges_of(picture=samples, number=0) if edge.used]
    return edge


@pytest.mark.parametrize(
    ("tail", "too_large"),
    [
        (("scintillator", 0.08, 15.0), 0.06),
        (("halo", 0.15, 20.0), 0.12),
        (("veil", 0.12, 12.0), 0.06),
    ],
)
def test_light_in_long_tails_is_in_the_mtf(tail, too_large):
    camera, samples = picture(tail)
    edge = measured(samples)
    near = edge.curve.frequency <= 0.4
    truth = true_mtf(camera, edge.found.angle_deg, edge.curve.frequency)
    off = (edge.curve.mtf - truth)[near][1:]
    assert np.all(np.abs(off) < 3.0 * edge.curve.sigma[near][1:])
    core = true_mtf(Camera(**CAMERA), edge.found.angle_deg, edge.curve.frequency)
    assert np.median((core / truth)[near][5:]) - 1.0 > too_large  # what the near sides alone give
    assert np.max(np.abs(off)) < too_large / 2.0
    assert edge.curve.tail.share == pytest.approx(tail[1], abs=0.05)


def test_a_block_whose_corner_lies_in_one_side_does_not_hide_the_tails_of_all():
    """It counted as so much doubt of every side that no tail was likely, with a small error."""
    camera = Camera(**CAMERA, tail=("halo", 0.12, 24.0))
    wall, block = half(80.0, (124, 110)), turned(box(40, 30), 35.0, (120, 196))
    shapes = Shape(wall, 20000), Shape(block, 18500)
    scene = Scene(background=2000, shapes=shapes)
    taken = take(scene, camera, rows=208, columns=248, seed=4, fine=4, margin=120)
    edge = max((one for one in edges_of(picture=taken.picture, number=0) if one.used), key=length)
    off = edge.curve.mtf - true_mtf(camera, edge.found.angle_deg, edge.curve.frequency)
    assert edge.curve.tail.share == pytest.approx(0.12, abs=0.05)
    assert np.all(np.abs(off[1:26]) < 3.0 * edge.curve.sigma[1:26])


def length(edge):
    return edge.found.length


def test_where_the_frame_ends_first_the_error_is_wider_and_it_is_said():
    tail = ("scintillator", 0.15, 25.0)
    wide = measured(picture(tail)[1])
    camera, samples = picture(tail, columns=64, middle=(32, 75))
    narrow = measured(samples)
    assert narrow.curve.sigma[8] > 1.5 * wide.curve.sigma[8]
    off = narrow.curve.mtf - true_mtf(camera, narrow.found.angle_deg, narrow.curve.frequency)
    assert np.all(np.abs(off[1:26]) < 3.0 * narrow.curve.sigma[1:26])
    source = Source((MeasuredFile("one", 1, ""),), [samples], *samples.shape)
    lines = [line for line in remarks(measure_pictures(source)) if "long tails" in line]
    assert len(lines) == 1
    assert "the brightness beside them is not level yet" in lines[0]
