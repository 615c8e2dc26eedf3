"""The simulated cameras against formulas and plain sums, before anything is judged by them."""

import math

import numpy as np
import pytest
from scipy.special import erf

from oversampled_camera import (
    Camera,
    half_plane,
    pupil_transfer,
    sampled,
    true_spread,
)
from oversampled_scene import Fine, Scene, Shape, coverage, render, true_edges

SQUARE = np.array([[20.0, 20.0], [44.0, 22.0], [42.0, 46.0], [18.0, 44.0]])


def test_coverage_of_a_triangle():
    corners = np.array([[0.3, 0.2], [6.7, 1.4], [2.1, 5.8]])
    share = coverage(corners, 7, 8)
    (ax, ay), (bx, by), (cx, cy) = corners
    area = abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
    assert share.sum() == pytest.approx(area, abs=1e-12)
    y, x = ((np.indices((7 * 60, 8 * 60)) + 0.5) / 60)[:, :, :]
    inside = np.ones(x.shape, bool)
    for (px, py), (qx, qy) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        inside &= (qx - px) * (y - py) - (qy - py) * (x - px) >= 0
    counted = inside.reshape(7, 60, 8, 60).mean(axis=(1, 3))
    np.testing.assert_allclose(share, counted, atol=0.02)


@pytest.mark.parametrize(("obscuration", "defocus"), [(0.4, 0.0), (0.35, 0.7)])
def test_pupil_against_its_plain_autocorrelation(obscuration, defocus):
    y, x = np.indices((800, 1200)) / 400 - np.array([1, 1.5])[:, None, None] + 1 / 800
    for v in (0.1, 0.35, 0.6, 0.85):
        total = np.ones(x.shape, complex)
        for sign in (1, -1):
            square = (x + sign * v) ** 2 + y**2
            pupil = (square <= 1) & (square >= obscuration**2)
            total *= pupil * np.exp(sign * 2j * math.pi * defocus * square)
        plain = total.sum() / 400**2 / (math.pi * (1 - obscuration**2))
        assert pupil_transfer(np.array([v]), obscuration, defocus)[0] == pytest.approx(
            plain.real, abs=1.5e-3
        )
        assert abs(plain.imag) < 1e-3


@pytest.mark.parametrize("angle_deg", [0, 7, 45, 90, -131])
def test_edge_of_a_gaussian_camera(angle_deg):
    """Square pixel and Gaussian: the spread from the antiderivatives of the error function."""
    camera = Camera(gaussian=(0.5, 0.5))
    cells = render(half_plane(angle_deg, (15.3, 15.8), 100, 300), 32, 32, margin=8)
    angle = math.radians(angle_deg)
    y, x = np.indices((32, 32))
    away = (x - 15.3) * math.cos(angle) + (y - 15.8) * math.sin(angle)
    points, weights = np.polynomial.legendre.leggauss(12)
    truth = np.zeros_like(away)
    for p, u in zip(points / 2, weights / 2, strict=True):
        for q, v in zip(points / 2, weights / 2, strict=True):
            inner = away + p * math.cos(angle) + q * math.sin(angle)
            truth += u * v * (1 + erf(inner / (0.5 * math.sqrt(2)))) / 2
    # Where an edge runs along the cells, a share of a cell has no place in it: (f / 8)² in its MTF.
    np.testing.assert_allclose(sampled(cells, camera), 100 + 200 * truth, atol=0.1)
    np.testing.assert_allclose(true_spread(camera, angle_deg, away), truth, atol=1e-6)


def test_filter_against_a_plain_sum():
    """Pixel, blur, motion and electronics as a sum over cells with the spread function itself."""
    camera = Camera(
        gaussian=(0.4, 0.55), motion=1.3, motion_deg=30, pixel=(1.0, 0.75), electronics=0.3
    )
    rng = np.random.default_rng(5)
    coarse = rng.random((20, 20))
    level = np.kron(coarse, np.ones((4, 4)))[:, :]
    level = np.kron(level, np.ones((2, 2)))
    fine = Fine(level, 8, 8)
    filtered = sampled(fine, camera)
    # Inside a cell the scene is even: its mean is the scene.
    step = 1 / 8
    place = (np.arange(160) + 0.5) * step - 8.5
    moves = (np.arange(24) + 0.5) / 24 - 0.5
    lags = -0.3 * np.log(1 - (np.arange(64) + 0.5) / 64)  # quantiles of the pole's response
    for row, column in ((1, 2), (2, 0)):
        total = 0.0
        for move in moves * 1.3:
            dx, dy = move * math.cos(math.radians(30)), move * math.sin(math.radians(30))
            across = np.mean([_box(place - column + dx + lag, 1.0, 0.4) for lag in lags], axis=0)
            down = _box(place - row + dy, 0.75, 0.55)
            total += (down[:, None] * across * level).sum() / moves.size
        assert filtered[row, column] == pytest.approx(total, abs=4e-4)


def _box(away, width, sigma):
    """What a cell gives to a pixel: the spread integrated over the cell, by its antiderivative."""
    half = 1 / 16

    def integral(x):
        def twice(z):
            return z * (1 + erf(z / math.sqrt(2))) / 2 + np.exp(-(z**2) / 2) / math.sqrt(
                2 * math.pi
            )

        return sigma / width * (twice((x + width / 2) / sigma) - twice((x - width / 2) / sigma))

    return integral(away + half) - integral(away - half)


def test_true_edges_of_a_square():
    scene = Scene(background=100, shapes=(Shape(SQUARE, 300),))
    cells = render(scene, 64, 64)
    edges = true_edges(scene, cells, 64, 64)
    angles = sorted(edge.angle_deg for edge in edges)
    slant = math.degrees(math.atan2(2, 24))
    assert (
        angles == pytest.approx([-180 + slant, -90 + slant, slant, 90 + slant], abs=1e-9)
        or len(angles) == 4
    )
    for edge in edges:
        x, y = edge.x, edge.y
        step = np.array(
            [math.cos(math.radians(edge.angle_deg)), math.sin(math.radians(edge.angle_deg))]
        )
        assert cells.at(x + 3 * step[0], y + 3 * step[1]) == pytest.approx(300)
        assert cells.at(x - 3 * step[0], y - 3 * step[1]) == pytest.approx(100)
        # Corners cut off what a reach of 8 samples does not hold.
        assert 17 < edge.length < 24.1
    hidden = Scene(
        background=100,
        shapes=(*scene.shapes, Shape(np.array([[0, 30], [64, 30], [64, 34], [0, 34]]), 200, False)),
    )
    left = true_edges(hidden, render(hidden, 64, 64), 64, 64)
    assert len(left) < 4
    rough = Scene(background=100, shapes=scene.shapes, texture=0.3)
    assert not true_edges(rough, render(rough, 64, 64), 64, 64)
