"""Test scenes, and what their shapes cover."""

import mpmath as mp
import numpy as np
import pytest

from core.errors import ParameterError
from core.evaluation.work import Policy
from node_bench import NodeBench
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
from nodes.scenes.draw import KINDS, draw_radiances, scene_radiances
from nodes.scenes.scene_canvas import Canvas
from planck_truth import band_radiance

SOURCES = {"cut_on_um": 8.0, "cut_off_um": 12.0, "temperature_K": 303.0, "delta_K": 10.0}
GEOMETRY = {"angle_deg": 5.0, "frequency": 12.0}
EXACT_KINDS = ("slanted_edge", "four_bar", "sine", "two_panel", "uniform")


def scene(kind, width, height, dtype=np.float64, **changes):
    values = {**SOURCES, **GEOMETRY, **changes}
    radiances = scene_radiances(kind=kind, **{name: values[name] for name in SOURCES})
    geometry = {name: values[name] for name in GEOMETRY}
    return draw_radiances(radiances, Canvas(width, height, dtype), kind=kind, **geometry)


def block_mean(picture):
    rows, columns = picture.shape
    return picture.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3))


@pytest.mark.parametrize("kind", EXACT_KINDS)
@pytest.mark.parametrize(("width", "height"), [(64, 64), (46, 62), (30, 90)])
def test_block_mean_is_the_smaller_scene(kind, width, height):
    small = scene(kind, width, height)
    large = scene(kind, 2 * width, 2 * height)
    assert block_mean(large) == pytest.approx(small, rel=1e-12)


@pytest.mark.parametrize("kind", ["dormitory", "airfield"])
def test_it_is_one_scene_at_every_size(kind):
    small = scene(kind, 512, 512)
    difference = block_mean(scene(kind, 1024, 1024)) - small
    span = np.ptp(small)
    # Exact where profiles are added (the open sky); elsewhere samples that hold several
    # painted borders differ by the share they have in common.
    if kind == "dormitory":
        assert np.abs(difference[:12, 300:]).max() < 1e-12 * span
    assert np.sqrt(np.mean(difference**2)) < 0.004 * span
    assert abs(difference.mean()) < 2e-4 * span


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (1, 640), (13, 7), (640, 480)])
def test_every_kind_is_positive_and_finite(kind, size):
    width, height = size
    double = scene(kind, width, height)
    single = scene(kind, width, height, dtype=np.float32)
    assert double.shape == single.shape == (height, width)
    assert double.dtype == np.float64
    assert single.dtype == np.float32
    assert np.isfinite(double).all()
    assert double.min() > 0.0
    assert np.array_equal(single, double.astype(np.float32))


def test_panels_are_planck_radiances():
    picture = scene("two_panel", 9, 3)
    cold, warm = band_radiance(8, 12, 303), band_radiance(8, 12, 313)
    assert picture[:, :4] == pytest.approx(np.full((3, 4), cold), rel=1e-11)
    assert picture[:, 5:] == pytest.approx(np.full((3, 4), warm), rel=1e-11)
    assert picture[:, 4] == pytest.approx(np.full(3, (cold + warm) / 2), rel=1e-11)
    assert scene("uniform", 2, 2) == pytest.approx(np.full((2, 2), cold), rel=1e-11)


def test_dormitory_surfaces_emit_and_mirror_the_sky():
    picture = scene("dormitory", 2048, 2048)
    sky = band_radiance(8, 12, 303 - 26)
    brightest = band_radiance(8, 12, 303 + 15) * 0.95 + 0.05 * sky
    # The chimney's rim is an even patch of the exhaust surface.
    assert picture[int(0.107 * 2048), int(0.283 * 2048)] == pytest.approx(brightest, rel=1e-11)
    assert picture[0, 5] == pytest.approx(sky, rel=1e-6)
    assert np.median(picture) == pytest.approx(band_radiance(8, 12, 303), rel=0.1)


def test_point_is_one_sample():
    picture = scene("point", 6, 5)
    rows, columns = np.nonzero(picture != picture[0, 0])
    assert (rows.tolist(), columns.tolist()) == ([2], [3])
    assert picture[2, 3] == pytest.approx(band_radiance(8, 12, 313), rel=1e-11)


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_sine_is_the_sample_mean(angle):
    width, height, frequency = 7, 5, 2.3
    picture = scene("sine", width, height, angle_deg=angle, frequency=frequency)
    low, high = band_radiance(8, 12, 303), band_radiance(8, 12, 313)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    x = (np.arange(width)[:, None] + 0.5 + nodes / 2 - width / 2).ravel()
    y = (np.arange(height)[:, None] + 0.5 + nodes / 2 - height / 2).ravel()[:, None]
    along = x * np.cos(np.deg2rad(angle)) + y * np.sin(np.deg2rad(angle))
    fine = (low + high) / 2 + (high - low) / 2 * np.cos(2 * np.pi * frequency / width * along)
    pieces = fine.reshape(height, 24, width, 24)
    exact = np.einsum("ajbk,j,k->ab", pieces, weights / 2, weights / 2)
    assert picture == pytest.approx(exact, rel=1e-11)


def test_slanted_edge_turns_about_the_centre():
    picture = scene("slanted_edge", 41, 30)
    share = (picture - picture.min()) / np.ptp(picture)
    assert share + share[::-1, ::-1] == pytest.approx(np.ones((30, 41)), abs=1e-12)
    crossing = share.sum(axis=1)
    assert np.diff(crossing) == pytest.approx(np.full(29, np.tan(np.deg2rad(5.0))), abs=1e-11)


def test_bars_are_seven_times_as_long_as_wide():
    picture = scene("four_bar", 1440, 1440, frequency=9.0)
    lit = picture > picture.mean(where=picture > picture.min()) - 0.5 * np.ptp(picture)
    top = int(np.argmax(lit.any(axis=1)))
    row = np.flatnonzero(np.diff(lit[top + 200].astype(int)))
    runs = np.diff(row[:8])
    assert runs == pytest.approx(np.full(7, 80), abs=1)
    column = np.flatnonzero(np.diff(lit[:, row[0] + 40].astype(int)))
    assert column[1] - column[0] == pytest.approx(560, abs=1)
    left, side = row[0] + 1, 560
    upright = lit[top : top + side, left : left + side]
    level = lit[top : top + side, left + 720 : left + 720 + side]
    assert np.mean(upright) == pytest.approx(4 / 7, abs=0.01)
    assert np.mean(upright != level.T) < 0.02  # samples at the bars' edges


@pytest.mark.parametrize("frequency", [9.0, 9.3, 9.8, 10.6, 12.0, 14.0, 17.0, 22.0])
@pytest.mark.parametrize(("width", "height"), [(600, 600), (900, 600), (600, 900)])
def test_bars_keep_off_the_border(width, height, frequency):
    picture = scene("four_bar", width, height, frequency=frequency)
    rows, columns = np.nonzero(picture > picture.min() + 1e-3 * np.ptp(picture))
    margin = 0.05 * 600 - 1  # of the shorter side, but for the sample that a bar ends in
    assert min(rows.min(), columns.min()) >= margin
    assert rows.max() < height - margin
    assert columns.max() < width - margin


@pytest.mark.parametrize(
    ("changes", "parameter"),
    [
        ({"kind": "castle"}, "kind"),
        ({"width": 0}, "width"),
        ({"height": 65537}, "height"),
        ({"width": 4.5}, "width"),
        ({"temperature_K": 0.0}, "temperature_K"),
        ({"temperature_K": float("nan")}, "temperature_K"),
        ({"delta_K": -303.0}, "delta_K"),
        ({"kind": "dormitory", "delta_K": 200.0}, "delta_K"),
        ({"cut_on_um": 12.0}, "cut_off_um"),
        ({"cut_on_um": -1.0}, "cut_on_um"),
        ({"frequency": -1.0}, "frequency"),
        ({"kind": "siemens_star", "frequency": 2.5}, "frequency"),
        ({"kind": "four_bar", "frequency": 3.0}, "frequency"),
        ({"angle_deg": float("inf")}, "angle_deg"),
    ],
)
def test_faults_name_the_parameter(tmp_path, changes, parameter):
    values = {"kind": "uniform", "width": 4, "height": 4, "temperature_K": 303.0, **changes}

    def drawn():
        bench = NodeBench(tmp_path, {"scene": ("test_scene", values)}, [])
        return bench.engine.value(bench.plan, "scene.image", bench.engine.work(Policy("double")))

    with pytest.raises(ParameterError) as caught:
        drawn()
    assert caught.value.parameter == parameter


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
