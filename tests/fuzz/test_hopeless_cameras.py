"""Pictures that no MTF can be measured on: they end in words, never in a number."""

from dataclasses import replace

import pytest

from app.measure.measuring import edges_of, pooled
from camera_scenes import box, turned
from oversampled_camera import Camera, half_plane, take
from oversampled_scene import Scene, Shape

CAMERA = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=50, read_e=30, bits=8, offset_dn=5)
TOP = 255.0
BOXES = ((11, (28, 30), 9000), (27, (72, 66), 7000))


def scene(background=3000, brighter=1):
    shapes = [
        Shape(turned(box(36, 36), angle, middle), level * brighter)
        for angle, middle, level in BOXES
    ]
    return Scene(background=background, shapes=tuple(shapes))


def measured(pictured, camera):
    frame = take(pictured, camera, rows=96, columns=100, seed=1)
    edges = edges_of(picture=frame.picture, number=0, clip_levels=(0.0, TOP))
    return edges, [pooled(edges, axis) for axis in ("x", "y")]


def test_the_camera_as_it_is():
    edges, axes = measured(scene(), CAMERA)
    assert sum(edge.used for edge in edges) >= 6
    assert all(curve is not None for curve, _ in axes)


@pytest.mark.parametrize(
    ("pictured", "camera", "words"),
    [
        (Scene(background=5000), CAMERA, "no straight edge"),
        (scene(-2000, 2), CAMERA, "clipped"),
        (scene(), replace(CAMERA, jpeg_quality=75), "compressed"),
        (scene(), replace(CAMERA, field_shift=2.0), "interlaced"),
    ],
    ids=["flat", "clipped", "jpeg", "interlaced"],
)
def test_words_in_place_of_a_number(pictured, camera, words):
    edges, axes = measured(pictured, camera)
    assert not any(edge.used for edge in edges)
    for curve, reason in axes:
        assert curve is None
        assert words in reason


def test_nothing_is_said_of_what_an_edge_does_not_show():
    """An edge down the picture shows nothing of the blur along it."""
    _, ((across, _), (along, reason)) = measured(
        half_plane(3, (50, 48), 3000, 9000), replace(CAMERA, gaussian=(0.2, 0.9))
    )
    assert across is not None
    assert along is None
    assert "vertical" in reason
