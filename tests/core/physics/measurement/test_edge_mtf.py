"""MTF across found edges against edges whose spread is an integral over the true MTF."""

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from core.errors import DataError
from core.physics.measurement.edge_mtf import MtfCurve, measure_edge, pooled_mtf
from core.physics.measurement.edge_search import find_edges
from core.physics.measurement.found_edge import FoundEdge
from edge_pictures import edge_mtf, edge_picture

FREQUENCY = np.linspace(0.0, 0.4, 21)  # cycles per sample, to 0.8 of Nyquist


def optics(frequency, cutoff, sigma):
    """Diffraction of a round pupil, and a Gaussian."""
    u = np.clip(np.abs(frequency) / cutoff, 0.0, 1.0)
    round_pupil = 2.0 / np.pi * (np.arccos(u) - u * np.sqrt(1.0 - u * u))
    return round_pupil * np.exp(-2.0 * (np.pi * sigma * frequency) ** 2)


def true_mtf(frequency, camera, angle_deg):
    """Optics times the pixel, along a normal."""
    angle = math.radians(angle_deg)
    pixel = np.sinc(frequency * math.cos(angle)) * np.sinc(frequency * math.sin(angle))
    return np.abs(optics(frequency, *camera) * pixel)


def edge_frame(camera, angle_deg, low, high, noise, seed, size=80):
    """Picture of an endless edge: its spread is summed over frequencies up to the cutoff."""
    step = 1.0 / 512.0
    frequency = np.arange(step / 2.0, camera[0], step)
    angle = math.radians(angle_deg)
    pixel = np.sinc(frequency * math.cos(angle)) * np.sinc(frequency * math.sin(angle))
    weight = optics(frequency, *camera) * pixel * step / (np.pi * frequency)
    place = np.linspace(-60.0, 60.0, 4801)
    spread = 0.5 + np.sin(2.0 * np.pi * np.outer(place, frequency)) @ weight
    y, x = np.mgrid[:size, :size] - (size - 1) / 2.0
    away = (x - 0.3) * math.cos(angle) + y * math.sin(angle)
    picture = low + (high - low) * np.interp(away, place, spread)
    return picture + np.random.default_rng(seed).normal(0.0, noise, picture.shape)


def measured(camera, angle_deg, *, noise=0.5, length=50.0, reach=10.0, seed=0):
    """An edge from 50 to 90, its end 0.1 samples off and its middle 0.3."""
    picture = edge_frame(camera, angle_deg, 50.0, 90.0, noise, seed)
    turned = angle_deg + math.degrees(0.2 / length)
    edge = FoundEdge(39.5, 39.5, turned, length, reach, 50.0, 90.0, noise)
    return measure_edge(picture=picture, edge=edge, frequency=FREQUENCY)


def test_errors_cover_the_truth():
    """Of 24 cameras: within 3 errors nearly always, within one about as often as said, or more."""
    rng = np.random.default_rng(5)
    pulls = []
    for seed in range(24):
        camera = (rng.uniform(0.6, 2.0), rng.uniform(0.0, 0.8))
        angle = rng.uniform(-180.0, 180.0)
        settings = {"noise": 40.0 / 10 ** rng.uniform(1.0, 2.5), "length": rng.uniform(20.0, 55.0)}
        one = measured(camera, angle, reach=rng.uniform(5.0, 16.0), seed=seed, **settings)
        truth = true_mtf(FREQUENCY, camera, one.angle_deg)
        pulls.append((one.mtf - truth)[1:] / one.sigma[1:])
    pulls = np.array(pulls)
    assert np.mean(np.abs(pulls) < 3.0) >= 0.99
    assert 0.6 < np.mean(np.abs(pulls) < 1.0) < 0.95
    assert abs(np.mean(pulls)) < 0.35


def test_noise_that_hangs_together_along_the_edge_is_in_the_error():
    """Smoothed over 3 samples along the edge, 2 % of the step: the spread of 30 measurements."""
    edge = FoundEdge(39.5, 39.5, 8.0, 50.0, 10.0, 50.0, 90.0, 0.8)
    clean = edge_frame((1.0, 0.4), 8.0, 50.0, 90.0, 0.0, 0)
    found = []
    for seed in range(30):
        noise = gaussian_filter1d(np.random.default_rng(seed).normal(size=clean.shape), 3.0, axis=0)
        picture = clean + 0.8 * noise / noise.std()
        found.append(measure_edge(picture=picture, edge=edge, frequency=FREQUENCY))
    spread = np.std([one.mtf for one in found], axis=0)
    said = np.sqrt(np.mean([one.sigma**2 for one in found], axis=0))
    assert spread[10:16] == pytest.approx(said[10:16], rel=0.25)


def true_half(camera, angle_deg):
    fine = np.linspace(0.0, 1.0, 4001)
    return float(np.interp(-0.5, -true_mtf(fine, camera, angle_deg), fine))


def test_the_error_of_mtf50_of_noisy_edges():
    """Contrast 20 times the noise: departures over errors scatter by 1."""
    rng, pulls = np.random.default_rng(77), []
    frequency = np.linspace(0.0, 1.0, 65)
    for _ in range(20):
        camera, angle = (rng.uniform(0.7, 2.0), rng.uniform(0.0, 0.6)), rng.uniform(3.0, 12.0)
        clean, truth = edge_frame(camera, angle, 50.0, 90.0, 0.0, 0), true_half(camera, angle)
        for length in rng.uniform(30.0, 60.0, 6):
            edge = FoundEdge(39.8, 39.5, angle, length, 16.0, 50.0, 90.0, 2.0)
            picture = clean + rng.normal(0.0, 2.0, clean.shape)
            one = measure_edge(picture=picture, edge=edge, frequency=frequency)
            pulls.append((one.mtf50 - truth) / one.mtf50_sigma)
    assert 0.8 < np.std(pulls) < 1.2
    assert np.max(np.abs(pulls)) < 4.5


def textured(seed, angle_deg, camera=(1.2, 0.5)):
    """An edge of 40 above a ground whose texture, 3 rms, hangs together over some samples."""
    rng = np.random.default_rng(seed)
    across, down = np.meshgrid(np.fft.rfftfreq(80), np.fft.fftfreq(80))
    field = np.fft.rfft2(rng.normal(0.0, 1.0, (80, 80)))
    field = np.fft.irfft2(field * np.exp(-2.0 * (np.pi * 1.6) ** 2 * (across**2 + down**2)))
    field *= 3.0 / field.std()
    share = (edge_frame(camera, angle_deg, 0.0, 1.0, 0.0, 0)).clip(0.0, 1.0)
    picture = 50.0 + 40.0 * share + field * (1.0 - share) + rng.normal(0.0, 0.2, field.shape)
    edge = FoundEdge(39.5, 39.5, angle_deg, 24.0, 10.0, 50.0, 90.0, 0.9)
    return measure_edge(picture=picture, edge=edge, frequency=FREQUENCY)


def test_texture_beside_the_edge_is_in_the_error():
    pulls = []
    for seed in range(16):
        angle = 7.3 + 23.1 * seed
        one = textured(seed, angle)
        pulls.append((one.mtf - true_mtf(FREQUENCY, (1.2, 0.5), angle))[1:] / one.sigma[1:])
    assert np.mean(np.abs(pulls) < 3.0) >= 0.985
    assert np.mean(np.abs(pulls) < 1.0) > 0.55


def test_rows_that_never_differ():
    with pytest.raises(
        DataError, match=r"cannot be supersampled: at 0\.0°, the supersampled profile"
    ):
        measure_edge(
            picture=edge_frame((1.0, 0.4), 0.0, 50.0, 90.0, 0.1, 1),
            edge=FoundEdge(39.8, 39.5, 0.0, 40.0, 10.0, 50.0, 90.0, 0.1),
            frequency=FREQUENCY,
        )


@pytest.mark.parametrize("angle", [1.0, 7.125, 11.3, 18.435, 26.565, 40.0])
def test_without_noise_found_anywhere(angle):
    """To a thousandth where the blur is sampled well; the pixel alone has tails of its own."""
    for sigma, within in ((0.3, 0.001), (1.0, 0.0005), (2.0, 0.0005), (3.0, 0.0005)):
        picture = 100.0 + 900.0 * edge_picture(angle, sigma, (80, 80))
        (edge,) = [edge for edge in find_edges(picture=picture) if edge.used] or [None]
        if edge is None:  # not enough of a wide spread beside an edge across the frame
            assert sigma == 3.0
            continue
        one = measure_edge(picture=picture, edge=edge, frequency=FREQUENCY)
        off = np.abs(one.mtf - edge_mtf(FREQUENCY, angle, sigma))
        assert np.max(off) < within
        assert np.all(off[1:] < 3.0 * one.sigma[1:])


def pretended(angle, mtf, sigma):
    errors = np.full(len(FREQUENCY), sigma)
    return MtfCurve(angle, FREQUENCY, mtf, errors, np.zeros(len(FREQUENCY)), None, None)


def test_pool_of_edges_that_agree_and_that_do_not():
    rng = np.random.default_rng(8)
    truth = np.exp(-8.0 * FREQUENCY**2)
    noise = rng.normal(0.0, 0.02, (16, len(FREQUENCY)))
    angles = rng.uniform(-25.0, 25.0, 16) + 180.0 * (np.arange(16) % 2)
    pool = pooled_mtf(
        edges=[pretended(a, truth + n, 0.02) for a, n in zip(angles, noise, strict=True)], axis="x"
    )
    assert pool.edges == 16
    assert pool.scatter < 1.15
    assert np.all(np.abs(pool.mtf - truth) < 4.0 * pool.sigma)
    assert np.all(pool.sigma < 0.012)
    worse = pooled_mtf(
        edges=[pretended(a, truth + 4.0 * n, 0.02) for a, n in zip(angles, noise, strict=True)],
        axis="x",
    )
    assert worse.scatter == pytest.approx(4.0, rel=0.2)
    assert np.median(worse.sigma) > 2.5 * np.median(pool.sigma)


def test_pool_of_a_blur_that_differs_with_direction():
    """A Gaussian of 0.6 samples across and 0.3 down."""

    def mtf(angle):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        return np.exp(-2.0 * (np.pi * FREQUENCY) ** 2 * ((0.6 * c) ** 2 + (0.3 * s) ** 2))

    edges = [pretended(angle, mtf(angle), 0.005) for angle in (-170, -70, 20, 28, 65, 110, 150)]
    for axis, angle in (("x", 0.0), ("y", 90.0)):
        pool = pooled_mtf(edges=edges, axis=axis)
        assert np.all(np.abs(pool.mtf - mtf(angle)) < 3.0 * pool.sigma)
        assert np.max(np.abs(pool.mtf - mtf(angle))) < 0.04
    assert pooled_mtf(edges=edges[1:2], axis="x") is None


def test_tails_of_neighbours_are_in_the_error():
    """Bars 8 samples wide, cutoff 0.7: their tails make the step too small, alike for all."""
    camera = (0.7, 0.0)
    frames = [edge_frame(camera, 7.0, 0.0, 40.0, 0.0, 0, 160)]
    x = np.arange(160.0)
    for number in range(-4, 5):
        place = x - number * 8.0 / math.cos(math.radians(7.0))
        frames.append(np.stack([np.interp(place, x, row) for row in frames[0]]))
    signs = (-1.0) ** np.arange(-4, 5)
    bars = np.tensordot(signs, np.stack(frames[1:]), 1)[40:120, 40:120]
    bars = bars + np.random.default_rng(0).normal(0.0, 0.1, bars.shape)
    edge = FoundEdge(39.8, 39.5, 7.0, 50.0, 5.0, 0.0, 40.0, 0.1)
    one = measure_edge(picture=bars, edge=edge, frequency=FREQUENCY)
    off = one.mtf - true_mtf(FREQUENCY, camera, 7.0)
    assert np.all(np.abs(off[1:]) < 3.0 * one.sigma[1:])
    assert np.max(np.abs(off)) > 0.09  # which is what they do
