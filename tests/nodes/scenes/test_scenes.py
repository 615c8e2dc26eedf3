"""Test scenes against Planck's law, quadrature and their own geometry."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import ParameterError
from core.evaluation.work import Policy
from node_bench import NodeBench
from nodes.library import standard_library
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
        bench = NodeBench(standard_library(), tmp_path, {"scene": ("test_scene", values)}, [])
        return bench.engine.value(bench.plan, "scene.image", bench.engine.work(Policy("double")))

    with pytest.raises(ParameterError) as caught:
        drawn()
    assert caught.value.parameter == parameter
