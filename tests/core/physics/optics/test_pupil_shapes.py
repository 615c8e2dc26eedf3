"""Exit pupil shapes: what they refuse and how they are sampled."""

import math
from itertools import combinations

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.optics.pupil_shapes import (
    PupilShape,
    edge_offset_samples,
    sample_pupil,
    smallest_circle,
    support_circle,
)


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"shape": "square", "radius": 5}, "shape"),
        ({"shape": "clear", "radius": 0}, "radius"),
        ({"shape": "clear", "radius": math.nan}, "radius"),
        ({"shape": "cassegrain", "radius": 5, "obscuration_radius": 5}, "obscuration_radius"),
        ({"shape": "cassegrain_slit", "radius": 5, "slit_width": 10}, "slit_width"),
        ({"shape": "hinged", "radius": 5, "slit_width": 11}, "slit_width"),
        ({"shape": "spider", "radius": 5, "vanes": -1}, "vanes"),
        ({"shape": "spider", "radius": 5, "vanes": 2.5}, "vanes"),
        ({"shape": "spider", "radius": 5, "vanes": 61}, "vanes"),
        ({"shape": "spider", "radius": 5, "vanes": 2, "vane_width": 10}, "vane_width"),
        ({"shape": "spider", "radius": 5, "vanes": 6, "vane_width": 5.001}, "vane_width"),
    ],
)
def test_refuses_what_is_no_pupil(given, named):
    with pytest.raises(ParameterError) as caught:
        PupilShape(**given)
    assert caught.value.parameter == named


def test_ignores_what_a_shape_does_not_have():
    for shape in ("clear", "half_moon"):
        whole = PupilShape(shape, 5, 7, 20, 3, 40)
        alone = PupilShape(shape, 5)
        np.testing.assert_array_equal(
            sample_pupil(whole, rows=12, columns=13), sample_pupil(alone, rows=12, columns=13)
        )


def test_oversampling_is_a_larger_pupil():
    fine = sample_pupil(PupilShape("cassegrain", 5.2, 2.0), rows=12, columns=15, oversampling=3)
    large = sample_pupil(PupilShape("cassegrain", 15.6, 6.0), rows=36, columns=45)
    np.testing.assert_array_equal(fine, large)


@pytest.mark.parametrize(
    ("shape", "size", "offset"),
    [
        (PupilShape("clear", 100), 256, 0.0),
        (PupilShape("half_moon", 100), 255, 0.5),
        (PupilShape("hinged", 100, slit_width=30), 256, 0.0),
        (PupilShape("hinged", 100, slit_width=30.4), 256, 0.2),
        (PupilShape("spider", 100, vanes=3, vane_width=6), 256, 0.0),
        (PupilShape("spider", 100, vanes=4, vane_width=6), 255, 0.5),
    ],
)
def test_offset_of_edges_from_the_pixels_borders(shape, size, offset):
    assert edge_offset_samples(shape, rows=size, columns=size) == pytest.approx(offset, abs=1e-12)


@pytest.mark.parametrize(("vanes", "offset"), [(3, 0.0), (4, 0.5)])
def test_only_four_vanes_have_edges_along_columns(vanes, offset):
    shape = PupilShape("spider", 100, vanes=vanes, vane_width=6)
    assert edge_offset_samples(shape, rows=256, columns=255) == offset


def test_offset_of_oversampled_edges_counts_finer_samples():
    shape = PupilShape("hinged", 250, slit_width=25.3)
    plain = edge_offset_samples(shape, rows=512, columns=512)
    fine = edge_offset_samples(shape, rows=512, columns=512, oversampling=2)
    assert plain == pytest.approx(0.35, abs=1e-12)  # 26 samples for 25.3
    assert fine == pytest.approx(0.3, abs=1e-12)  # 50 finer ones for 50.6


# Smallest circles against all pairs and triples of points, and outlines of known radius.


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
    with pytest.raises(ParameterError, match="transmit light"):
        support_circle(np.zeros((3, 3)))
