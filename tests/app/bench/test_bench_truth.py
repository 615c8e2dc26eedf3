"""The benchmark's truths are true: against other independent ways, and against the engine."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from app.bench.measuring.kodak import PIXELS, Kodak
from app.bench.measuring.loaded_network import Chain
from app.bench.precision import precision_scanning, precision_skip
from app.bench.precision.precision_poisson import kolmogorov_distance
from app.bench.precision.precision_scanning import Scanner
from app.bench.truth.network_pupils import SHAPES
from app.bench.truth.stage_by_stage import optics, whole_chain
from app.bench.truth.truth_laws import poisson_cumulative
from app.bench.truth.truth_pictures import (
    Sensor,
    cosine_spectrum,
    mirrored_column,
    mirrored_frame,
    mirrored_picture,
    periodic_picture,
)
from app.bench.truth.truth_pupils import Aperture
from core.evaluation.policy import Policy


def test_stage_by_stage_is_the_same_optics():
    """Two independent programs of one chain agree, periodic as in 1996."""
    kodak = Kodak(64, "double")
    network = kodak.without_photons().with_parameter("init", "edges", "periodic")
    expected = optics(kodak.scene)
    got = kodak.value(network, PIXELS)
    # 1 − 0.99999 keeps eleven digits, and 640 transfers of that error are left.
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    picture = whole_chain(kodak.scene, lines=30, samples=32, seed=1)
    assert picture.shape == (30, 32)
    assert len(np.unique(optics(np.full((8, 8), 7.0)).round(12))) == 1


@pytest.mark.parametrize(
    ("edges", "direct"), [("reflect", mirrored_picture), ("periodic", periodic_picture)]
)
def test_direct_sums(edges, direct):
    kodak = Kodak(36, "double")
    network = kodak.without_photons().with_parameter("init", "edges", edges)
    interval = math.radians(25) * 1000 / 36
    expected = direct(kodak.scene, Sensor(interval))
    got = kodak.value(network, PIXELS)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_weak_stages_are_those_of_the_network():
    network, sensor = precision_skip.weak_chain(36)
    chain = Chain(network, Policy(precision="double", tolerance=0.0))
    expected = mirrored_frame(chain.scene, sensor)
    got = chain.value(network, precision_skip.END)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    # The weakest are seen: without one of the strongest two the error is its strength.
    fewer = Sensor(sensor.interval_mrad, **precision_skip.SENSOR, transfers=0)
    assert np.abs(mirrored_frame(chain.scene, fewer) - expected).max() > 1e-5


def test_what_is_left_out_keeps_to_its_tolerance():
    """The promise that the table of tolerances shows: rms error at most t·(max − min)."""
    network, sensor = precision_skip.weak_chain(36)
    scene = Chain(network, Policy(precision="double")).scene
    expected = mirrored_frame(scene, sensor)
    counts = []
    for tolerance in (1e-6, 1e-4, 1e-2):
        chain = Chain(network, Policy(precision="double", tolerance=tolerance), scene)
        error = precision_skip._rms(chain.value(network, precision_skip.END), expected)
        assert 1e-12 < error <= tolerance
        counts.append(len(precision_skip._delivered(chain).spent(chain.work)[1]))
    assert counts == [8, 12, 16]


def test_a_column_is_that_of_the_frame():
    scene = np.random.default_rng(5).uniform(1.0, 2.0, (20, 20))
    sensor = Sensor(3.0, transfers=0)
    frame = mirrored_frame(scene, sensor)
    for column in (0, 7, 19):
        got = mirrored_column(cosine_spectrum(scene), sensor, column, 3.0)
        np.testing.assert_allclose(got, frame[:, column], rtol=0, atol=1e-13)


@pytest.mark.parametrize("aperture", [True, False])
@pytest.mark.parametrize("field", precision_scanning.FIELDS_DEG)
def test_line_by_line_is_the_direct_sum(field, aperture):
    scanner = Scanner(36, field, aperture, "double")
    columns, expected = scanner.expected()
    atol = 1e-12 * np.abs(expected).max()
    direct = scanner.line_by_line("direct")[:, columns]
    np.testing.assert_allclose(direct, expected, rtol=0, atol=atol)
    # One scale errs visibly at the ends of the scan, and blended scales close in on the truth.
    whole, two, four = (
        np.abs(picture[:, columns] - expected).max()
        for picture in (scanner.whole(), *(scanner.line_by_line("nodes", n) for n in (2, 4)))
    )
    assert whole > 10 * two
    assert four < 1e-5 * np.abs(expected).max()
    if aperture:
        assert two > four
    else:
        assert two < atol


def test_overlap_areas_by_counting():
    """The chord integrals against counted points, and the disc's closed form."""
    fine = 1200  # shifts of whole points: straight edges lie on the points' borders
    x, y = np.meshgrid(*2 * [(np.arange(2 * fine) + 0.5) / fine * 50 - 50])

    def lit(aperture, x, y):
        square = x * x + y * y
        inside = (square <= aperture.radius**2) & (square >= aperture.inner**2)
        inside &= (np.abs(x) >= aperture.half_bar) & (np.abs(y) >= aperture.half_beam)
        return inside & (x >= 0) if aperture.half_moon else inside

    for shape, (_, aperture) in SHAPES.items():
        here = lit(aperture, x, y)
        counted = np.mean(here & lit(aperture, x - 3.75, y - 1.875)) / np.mean(here)
        assert aperture.otf(3.75, 1.875) == pytest.approx(counted, abs=2e-4), shape
        assert aperture.otf(0.0, 0.0) == 1.0
    v = 0.3
    disc = 2 / math.pi * (math.acos(v) - v * math.sqrt(1 - v * v))
    assert Aperture(45.0).otf(0.0, 90 * v) == pytest.approx(disc, abs=1e-14)
    assert Aperture(45.0).otf(90 * v, 0.0) == pytest.approx(disc, abs=1e-14)


@pytest.mark.parametrize("mean", [0.0034, 3.0, 3000.0])
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
