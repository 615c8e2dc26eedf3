"""Smallest circles against all pairs and triples of points, and outlines of known radius."""

from itertools import combinations

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.optics.pupil_shapes import (
    PupilShape,
    sample_pupil,
    smallest_circle,
    support_circle,
)


def by_all(points):
    """Radius of the smallest of all circles on two points' distance, or through three."""
    if len(points) == 1:
        return 0.0
    circles = []
    for a, b in combinations(points, 2):
        circles.append(((a + b) / 2, np.linalg.norm(a - b) / 2))
    for a, b, c in combinations(points, 3):
        system = 2 * np.array([b - a, c - a])
        if abs(np.linalg.det(system)) > 1e-12:
            centre = np.linalg.solve(system, [b @ b - a @ a, c @ c - a @ a])
            circles.append((centre, np.linalg.norm(centre - a)))
    holds = [
        radius
        for centre, radius in circles
        if np.linalg.norm(points - centre, axis=1).max() <= radius * (1 + 1e-9)
    ]
    return min(holds)


@pytest.mark.parametrize("seed", range(60))
def test_against_all_pairs_and_triples(seed):
    random = np.random.default_rng(seed)
    number = 1 + seed % 12
    # Of few whole numbers, so that points coincide, lie on lines and on common circles.
    points = random.integers(-4, 5, (number, 2)).astype(float)
    if seed % 3 == 0:
        points = random.normal(size=(number, 2)) * random.choice([1e-3, 1.0, 1e4])
    x, y, radius = smallest_circle(points)
    assert radius == pytest.approx(by_all(points) if len(set(map(tuple, points))) > 1 else 0.0)
    assert np.hypot(points[:, 0] - x, points[:, 1] - y).max() <= radius * (1 + 1e-8) + 1e-12


@pytest.mark.parametrize("shape", ["clear", "half_moon", "cassegrain", "hinged", "spider"])
@pytest.mark.parametrize(("size", "radius"), [(96, 30.0), (97, 41.3), (512, 75.0)])
def test_of_an_aperture_anywhere_in_its_array(shape, size, radius):
    outline = PupilShape(
        shape, radius=radius, obscuration_radius=9.0, slit_width=6.0, vanes=3, vane_width=2.0
    )
    samples = sample_pupil(outline, rows=size, columns=size)
    middle = (size - 1) / 2
    x, y, found = support_circle(samples * 0.3)
    assert (x, y) == (middle, middle)
    assert radius - 0.6 <= found <= radius + 1e-9
    if shape == "half_moon":
        return
    placed = np.zeros((size + 40, size + 20))
    placed[30 : 30 + size, 5 : 5 + size] = samples * 0.3
    x, y, found = support_circle(placed)
    assert (x - 5, y - 30) == pytest.approx((middle, middle), abs=0.5)
    assert radius - 0.6 <= found <= radius + 1e-9


def test_of_a_single_sample_and_of_none():
    lonely = np.zeros((5, 7))
    lonely[4, 6] = 2.0
    assert support_circle(lonely) == (6.0, 4.0, 0.5)
    with pytest.raises(ParameterError, match="transparent"):
        support_circle(np.zeros((3, 3)))
