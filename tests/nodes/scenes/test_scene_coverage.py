"""Coverage and profiles of the scenes against polygon clipping and quadrature."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from nodes.scenes.coverage import (
    band,
    bell,
    ellipse_coverage,
    half_plane_coverage,
    power,
    star_coverage,
    steps,
    wave,
)


def clip_polygon(polygon, a, b, c):
    """Part of a polygon where a*x + b*y >= c (Sutherland and Hodgman)."""
    kept = []
    for (x0, y0), (x1, y1) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        d0, d1 = a * x0 + b * y0 - c, a * x1 + b * y1 - c
        if d0 >= 0:
            kept.append((x0, y0))
        if (d0 > 0 > d1) or (d0 < 0 < d1):
            t = d0 / (d0 - d1)
            kept.append((x0 + t * (x1 - x0), y0 + t * (y1 - y0)))
    return kept


def area(polygon):
    total = 0.0
    for (x0, y0), (x1, y1) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        total += x0 * y1 - x1 * y0
    return abs(total) / 2


def cells(x_edges, y_edges):
    for j in range(y_edges.size - 1):
        for i in range(x_edges.size - 1):
            x0, x1, y0, y1 = x_edges[i], x_edges[i + 1], y_edges[j], y_edges[j + 1]
            yield j, i, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 5.0, 45.0, 90.0, 137.0, 180.0, -60.0])
def test_half_plane_is_the_clipped_polygon(angle):
    x_edges, y_edges = np.linspace(-3, 3, 8), np.linspace(-2, 2.5, 10)
    a, b, c = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle)), 0.13
    share = half_plane_coverage(x_edges, y_edges, normal_x=a, normal_y=b, offset=c)
    for j, i, cell in cells(x_edges, y_edges):
        exact = area(clip_polygon(cell, a, b, c)) / area(cell)
        assert share[j, i] == pytest.approx(exact, abs=1e-13)


def test_ellipse_matches_quadrature_and_total_area():
    x_edges, y_edges = np.linspace(0, 1, 8), np.linspace(0, 1, 6)
    shape = {"centre_x": 0.45, "centre_y": 0.52, "radius_x": 0.31, "radius_y": 0.4}
    share = ellipse_coverage(x_edges, y_edges, **shape)

    def chord_in(y, x0, x1):
        half = 0.31 * mp.sqrt(max(0, 1 - ((y - 0.52) / 0.4) ** 2))
        return max(0, min(x1, 0.45 + half) - max(x0, 0.45 - half))

    for j, i, cell in cells(x_edges, y_edges):
        (x0, y0), (x1, _), (_, y1), _ = cell
        kinks = {y0, y1}
        for x in (x0, x1):
            rise = 1 - ((x - 0.45) / 0.31) ** 2
            if rise > 0:
                kinks |= {0.52 + s * 0.4 * rise**0.5 for s in (-1, 1)}
        kinks |= {0.12, 0.92}
        nodes = sorted(k for k in kinks if y0 <= k <= y1)
        exact = mp.quad(lambda y, x0=x0, x1=x1: chord_in(y, x0, x1), nodes) / area(cell)
        assert share[j, i] == pytest.approx(float(exact), abs=1e-9)
    total = share.sum() * (1 / 7) * (1 / 5)
    assert total == pytest.approx(np.pi * 0.31 * 0.4, rel=1e-14)


@pytest.mark.parametrize(("width", "height"), [(8, 6), (9, 7), (8, 7), (31, 40)])
@pytest.mark.parametrize("spokes", [1, 2, 5, 8])
def test_star_is_the_sum_of_its_wedges(width, height, spokes):
    x_edges = np.arange(width + 1) - width / 2
    y_edges = np.arange(height + 1) - height / 2
    share = star_coverage(x_edges, y_edges, spokes=spokes)
    for j, i, cell in cells(x_edges, y_edges):
        exact = 0.0
        for k in range(spokes):
            # Two quarter-turn-safe halves, so that every wedge is the cut of two half planes.
            for low, high in ((-0.5, 0.0), (0.0, 0.5)):
                t0 = (2 * k + low) * np.pi / spokes
                t1 = (2 * k + high) * np.pi / spokes
                part = clip_polygon(cell, -np.sin(t0), np.cos(t0), 0.0)
                exact += area(clip_polygon(part, np.sin(t1), -np.cos(t1), 0.0)) if part else 0.0
        assert share[j, i] == pytest.approx(exact, abs=1e-12)


def test_profiles_match_quadrature():
    edges = np.array([-0.1, 0.05, 0.2, 0.21, 0.5, 0.93, 1.2])
    cases = [
        (band(0.1, 0.7), lambda u: u**0, (0.1, 0.7)),
        (power(0.1, 0.7, 2), lambda u: ((u - 0.1) / 0.6) ** 2, (0.1, 0.7)),
        (
            wave(0.1, 0.9, cycles=3.7, phase=0.4),
            lambda u: mp.cos(7.4 * mp.pi * u + 0.4),
            (0.1, 0.9),
        ),
        (bell(0.4, 0.1), lambda u: mp.exp(-(((u - 0.4) / 0.1) ** 2) / 2), (-0.1, 0.9)),
    ]
    for profile, function, (low, high) in cases:
        for k, mean in enumerate(profile.means(edges)):
            a, b = max(edges[k], low), min(edges[k + 1], high)
            exact = mp.quad(function, mp.linspace(a, b, 5)) if b > a else 0
            assert mean == pytest.approx(float(exact / (edges[k + 1] - edges[k])), abs=1e-12)
    comb = steps([0.1, 0.3], [0.2, 0.8], [2.0, -1.0]).means(np.array([0.0, 0.15, 0.5, 1.0]))
    assert comb == pytest.approx([0.1 / 0.15, (0.1 - 0.2) / 0.35, -0.3 / 0.5], abs=1e-14)
