"""The benchmark's truths are true: against other independent ways, and against the engine."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from app.bench import precision
from app.bench.speed import plain_optics, whole_chain
from app.bench.timing import PIXELS, Chain, kodak_chain, without_photons
from app.bench.truth import (
    Sensor,
    kolmogorov_distance,
    mirrored_frame,
    mirrored_picture,
    periodic_picture,
    poisson_cumulative,
    pupil_otf,
)
from core.evaluation.work import Policy


def test_stage_by_stage_is_the_same_optics():
    """Two independent programs of one chain agree, periodic as in 1996."""
    kodak = kodak_chain(64, "double")
    network = without_photons(kodak.network).with_parameter("init", "edges", "periodic")
    expected = plain_optics(kodak.scene)
    got = kodak.value(network, PIXELS)
    # 1 − 0.99999 keeps eleven digits, and 640 transfers of that error are left.
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    picture = whole_chain(kodak.scene, 30, 32, 1)
    assert picture.shape == (30, 32)
    assert len(np.unique(plain_optics(np.full((8, 8), 7.0)).round(12))) == 1


@pytest.mark.parametrize(
    ("edges", "direct"), [("reflect", mirrored_picture), ("periodic", periodic_picture)]
)
def test_direct_sums(edges, direct):
    kodak = kodak_chain(36, "double")
    network = without_photons(kodak.network).with_parameter("init", "edges", edges)
    interval = math.radians(25) * 1000 / 36
    expected = direct(kodak.scene, Sensor(interval))
    got = kodak.value(network, PIXELS)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_weak_stages_are_those_of_the_network():
    network, sensor = precision.weak_chain(36)
    chain = Chain(network, Policy(precision="double", tolerance=0.0))
    expected = mirrored_frame(chain.scene, sensor)
    got = chain.value(network, "back.image")
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    # The weakest are seen: without one of the strongest two the error is its strength.
    fewer = replace(sensor, blurs_mrad=())
    assert np.abs(mirrored_frame(chain.scene, fewer) - expected).max() > 1e-5


def test_what_is_left_out_keeps_to_its_tolerance():
    """The promise that the table of tolerances shows: rms error at most t·(max − min)."""
    network, sensor = precision.weak_chain(36)
    scene = Chain(network, Policy(precision="double")).scene
    expected = mirrored_frame(scene, sensor)
    counts = []
    for tolerance in (1e-6, 1e-4, 1e-2):
        chain = Chain(network, Policy(precision="double", tolerance=tolerance), scene)
        error, skipped = precision.left_out(chain, expected)
        assert 1e-12 < error <= tolerance
        counts.append(skipped)
    assert counts == [8, 12, 16]


@pytest.mark.parametrize("half_moon", [False, True])
def test_overlap_areas_by_counting(half_moon):
    """The chord integrals against counted points, and the disc's closed form."""
    fine, radius = 1200, 45.0  # shifts of whole points: straight edges lie on the points' borders
    x, y = np.meshgrid(*2 * [(np.arange(2 * fine) + 0.5) / fine * 50 - 50])

    def lit(x, y):
        return (x * x + y * y <= radius**2) & (x >= 0 if half_moon else True)

    for shift in ((3.75, 1.875), (-3.75, 30.0), (0.0, -60.0)):
        counted = np.mean(lit(x, y) & lit(x - shift[0], y - shift[1])) / np.mean(lit(x, y))
        found = pupil_otf(radius, *shift, half_moon=half_moon)
        assert found == pytest.approx(counted, abs=2e-4)
    assert pupil_otf(radius, 0.0, 0.0, half_moon=half_moon) == pytest.approx(1.0, abs=1e-14)
    v = 0.3
    disc = 2 / math.pi * (math.acos(v) - v * math.sqrt(1 - v * v))
    assert half_moon or pupil_otf(radius, 0.0, 90 * v) == pytest.approx(disc, abs=1e-14)
    assert half_moon or pupil_otf(radius, 90 * v, 0.0) == pytest.approx(disc, abs=1e-14)


@pytest.mark.parametrize("mean", [0.0034, 3000.0])
def test_poisson_law_is_the_incomplete_gamma_function(mean):
    law = poisson_cumulative(mean)
    assert law[-1] == pytest.approx(1.0, abs=1e-11)
    with mpmath.workdps(30):
        for count in (0, 1, round(mean), round(mean + 3 * math.sqrt(mean))):
            exact = mpmath.gammainc(count + 1, mpmath.mpf(mean), regularized=True)
            assert law[count] == pytest.approx(float(exact), rel=0, abs=1e-11)


def test_kolmogorov_distance_of_a_few_counts():
    """Counts 0, 0, 1, 2 about the mean 1: e⁻¹ of them should be 0, and are a half."""
    found = kolmogorov_distance(np.array([[0.0, 0.0], [1.0, 2.0]]), 1.0)
    assert found == pytest.approx(0.5 - math.exp(-1), abs=1e-14)
    # Beyond everything that can be expected is as far as can be.
    assert kolmogorov_distance(np.array([1e9]), 1.0) == pytest.approx(1.0, abs=1e-12)
