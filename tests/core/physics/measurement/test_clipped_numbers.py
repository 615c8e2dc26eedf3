"""Pictures of numbers that are not whole, cut off at limits that nothing names."""

import numpy as np
import pytest

from camera_scenes import box, turned
from core.physics.measurement.edge_search import find_edges
from oversampled_camera import Camera, take
from oversampled_scene import Scene, Shape

LOW, HIGH = 2000.0, 9000.0
SCENE = Scene(
    background=LOW,
    shapes=(
        Shape(turned(box(36, 36), 11, (28, 30)), HIGH),
        Shape(turned(box(36, 36), 27, (72, 66)), HIGH),
    ),
)
NOISE = {
    "photons": {"read_e": 20.0},
    "read": {"photons": False, "read_e": 60.0},
    "little": {"photons": False, "read_e": 0.5},
}


def pictured(noise):
    camera = Camera(cutoff=1.2, jitter=0.3, **NOISE[noise])
    return take(SCENE, camera, rows=96, columns=100, seed=4).picture


def at(share):
    """A level between the scene's two."""
    return LOW + share * (HIGH - LOW)


@pytest.mark.parametrize("noise", ["photons", "read"])
@pytest.mark.parametrize(
    ("low", "high"),
    [(0.05, 2.0), (0.15, 2.0), (0.4, 2.0), (-1.0, 0.97), (-1.0, 0.9), (-1.0, 0.6), (0.1, 0.8)],
)
def test_no_edge_of_a_clipped_picture_is_used(noise, low, high):
    edges = find_edges(picture=pictured(noise).clip(at(low), at(high)))
    assert [edge for edge in edges if edge.used] == []
    assert any(edge.why_not.startswith("clipped: ") for edge in edges)


@pytest.mark.parametrize("noise", ["photons", "read"])
def test_noise_on_what_is_left_of_a_step_is_seen(noise):
    """With none, less than a sample of it looks as the unblurred edge of smaller pixels does."""
    edges = find_edges(picture=pictured(noise).clip(at(0.4), at(0.6)))
    assert [edge for edge in edges if edge.used] == []


def test_two_levels_are_no_edge():
    picture = np.where(pictured("little") > at(0.5), 7.25, 1.5)
    nearly = pictured("photons").clip(at(0.5), at(0.501))
    for one in (picture, nearly):
        edges = find_edges(picture=one)
        assert [edge for edge in edges if edge.used] == []
        assert any("two values" in edge.why_not for edge in edges)


@pytest.mark.parametrize("continuous", [True, False])
def test_photons_with_nothing_behind_them_are_used(continuous):
    """Their noise ends where they do, and the step goes over into the dark softly."""
    camera = Camera(cutoff=1.2, jitter=0.3, photons=False)
    electrons = take(SCENE, camera, rows=96, columns=100).clean - LOW
    electrons[electrons < 1e-6 * HIGH] = 0.0
    random = np.random.default_rng(8)
    noisy = electrons + np.sqrt(electrons) * random.standard_normal(electrons.shape)
    counted = random.poisson(electrons).astype(float)
    edges = find_edges(picture=noisy if continuous else counted)
    assert sum(edge.used for edge in edges) >= 6
