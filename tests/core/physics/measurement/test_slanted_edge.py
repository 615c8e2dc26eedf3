"""The slanted edge's MTF against that of edges blurred by known amounts."""

import math

import numpy as np
import pytest

from core.errors import DataError
from core.physics.measurement.slanted_edge import falls_to, modulus_error, slanted_edge
from edge_pictures import edge_mtf, edge_picture

FREQUENCY = np.linspace(0, 0.5, 65)  # cycles per sample, to Nyquist
ANGLES = [2, 2.5, 3, 4.3, 5, 6, 7.125, 8.13, 9.46, 10]  # among them tangents of 1/8, 1/7, 1/6


def error_of(picture, angle, sigma, **settings):
    found = slanted_edge(picture=picture, frequency=FREQUENCY, **settings)
    return np.max(np.abs(found.mtf - edge_mtf(FREQUENCY, angle, sigma)))


@pytest.mark.thorough(but=14)
@pytest.mark.parametrize("sigma", [0.3, 0.5, 1, 2])
@pytest.mark.parametrize("angle", ANGLES)
def test_mtf_of_a_noise_free_edge(angle, sigma):
    for size in ((64, 64), (100, 61)):
        assert error_of(edge_picture(angle, sigma, size), angle, sigma) < 0.005


@pytest.mark.parametrize("angle", [-5, 5, 12, 20])
def test_either_slant_either_polarity_and_any_window(angle):
    picture = edge_picture(angle, 0.7)
    assert error_of(picture, angle, 0.7) < 0.001
    assert error_of(1 - picture, angle, 0.7) < 0.001
    assert error_of(picture[:, ::-1], -angle, 0.7) < 0.001
    assert error_of(picture, angle, 0.7, window="none") < 0.001
    assert error_of(picture, angle, 0.7, window="hamming") < 0.005


def test_angle_is_found():
    for angle in ANGLES:
        found = slanted_edge(picture=edge_picture(angle, 1), frequency=FREQUENCY)
        assert abs(found.line.angle_deg) == pytest.approx(angle, abs=1e-3)


@pytest.mark.parametrize(("angle", "sigma"), [(2.4, 0.5), (7.7, 2)])
def test_noisy_edge_is_within_three_standard_errors(angle, sigma):
    """Signal to noise 50. Of normal errors 0.3 % lie beyond three; of ours, few more may."""
    picture, truth = edge_picture(angle, sigma, (100, 64)), edge_mtf(FREQUENCY, angle, sigma)
    beyond, squares = [], []
    for seed in range(25):
        noise = np.random.default_rng(seed).normal(0, 1 / 50, picture.shape)
        found = slanted_edge(picture=picture + noise, frequency=FREQUENCY)
        score = (found.mtf - truth)[1:] / found.error[1:]
        beyond.append(np.mean(np.abs(score) > 3))
        squares.append(np.mean(score**2))
    assert np.mean(beyond) < 0.015
    assert 0.6 < np.mean(squares) < 1.5  # neither too small an error, nor one that is no help


@pytest.mark.parametrize("true", [0.0, 1.0, 2.0, 5.0, 50.0])
def test_error_of_a_modulus_where_noise_matters_most(true):
    """Means of 24 complex normals about a transform of so many standard errors."""
    random = np.random.default_rng(11)
    trials = 8000
    parts = true + np.sqrt(24) * (random.normal(size=(24, trials, 2)) @ [1, 1j])
    whole = parts.mean(axis=0)
    error = modulus_error(whole=whole, replicas=(24 * whole - parts) / 23)
    # Of 24 groups, 3 standard errors miss 0.64 % (Student's t), and more where H is lost in noise.
    assert np.mean(np.abs(np.abs(whole) - true) > 3 * error) < 0.01
    assert np.median(error) < 2.0


def test_level_is_found_between_points():
    frequency, mtf = np.array([0, 1.0, 2.0]), np.array([1, 0.6, 0.2])
    assert falls_to(frequency=frequency, mtf=mtf, level=0.5) == pytest.approx(1.25)
    assert falls_to(frequency=frequency, mtf=mtf, level=0.1) is None


def bar(size=(64, 64)):
    picture = np.zeros(size)
    picture[:, 20:40] = 1
    return picture


REFUSED = {
    "uniform": (np.full((64, 64), 3.0), "uniform"),
    "noise": (np.random.default_rng(3).normal(size=(64, 64)), "no "),
    "a bar": (bar(), "no |not slanted"),
    "upright": (edge_picture(0, 0.7), "not slanted"),
    "nearly upright": (edge_picture(0.5, 0.7), "not slanted"),
    "45 degrees": (edge_picture(45, 0.7), "tilted by about 45°"),
    "repeating": (edge_picture(26.565051, 0.7, (40, 64)), "at the same distances"),
    "few columns": (edge_picture(5, 0.7, (64, 12)), "too small"),
    "few rows": (edge_picture(5, 0.7, (8, 64)), "too small"),
    "at the side": (edge_picture(5, 0.7, phase=26), "leaves the region"),
    # Half of the bins on a side, of 64 columns: the outer quarters are its levels.
    "blur wider than the region": (edge_picture(5, 12), r"more than 1[3-5]\.?\d* samples from"),
    "clipped with noise": (
        np.minimum(edge_picture(5, 1) + np.random.default_rng(2).normal(0, 0.02, (64, 64)), 1.0),
        "clipped",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_measured_is_refused_with_the_reason(case):
    picture, reason = REFUSED[case]
    with pytest.raises(DataError, match=reason):
        slanted_edge(picture=picture, frequency=FREQUENCY)


def cut_off(picture, level, ends):
    picture = np.minimum(picture, level) if ends != "below" else picture
    return np.maximum(picture, 1 - level) if ends != "above" else picture


@pytest.mark.parametrize("level", [0.7, 0.8, 0.95])
@pytest.mark.parametrize("sigma", [0.3, 1])
@pytest.mark.parametrize("ends", ["above", "below", "both"])
def test_noise_that_ends_beside_the_edge_tells_of_clipping(sigma, level, ends):
    noise = np.random.default_rng(9).normal(0, 0.02, (100, 64))
    picture = cut_off(edge_picture(5, sigma, (100, 64)) + noise, level, ends)
    with pytest.raises(DataError, match="clipped"):
        slanted_edge(picture=picture, frequency=FREQUENCY)


@pytest.mark.parametrize("sigma", [0.3, 1])
def test_photons_on_black_are_not_taken_for_clipped(sigma):
    for seed, angle in enumerate((2.5, 3, 5, 7.7, 9)):
        photons = 2500 * np.maximum(edge_picture(angle, sigma, (100, 64)), 0)
        picture = np.random.default_rng(seed).poisson(photons) / 2500
        assert np.count_nonzero(picture == 0) > 0.4 * picture.size
        slanted_edge(picture=picture, frequency=FREQUENCY)


@pytest.mark.parametrize("angle", [2, 2.5, 5, 9, 9.5, 10])
def test_unblurred_edges_and_smears_are_not_taken_for_clipped(angle):
    """Means over the pixel, and over a straight smear, of a step: their ends are sharp."""
    tilt = math.radians(angle)
    rows, columns = np.mgrid[:100, :64]
    away = (columns - 31.2) * math.cos(tilt) + (rows - 49.5) * math.sin(tilt)
    down = ((np.arange(99) + 0.5) / 99 - 0.5) * math.sin(tilt)
    steps = [np.clip((away + each) / math.cos(tilt) + 0.5, 0, 1) for each in down]
    slanted_edge(picture=np.mean(steps, axis=0), frequency=FREQUENCY)
    smear = (np.arange(99) + 0.5) / 99 * 4 - 2
    steps = [
        np.clip((away + each + along) / math.cos(tilt) + 0.5, 0, 1)
        for each in down[::12]
        for along in smear
    ]
    slanted_edge(picture=np.mean(steps, axis=0), frequency=FREQUENCY)


@pytest.mark.parametrize("parts", [1.5, 2, 3, 4, 6, 8, 30])
def test_edges_of_a_part_of_a_pixel_are_measured(parts):
    """As of a finer picture of which one sample of several is taken: no noise, nothing cut off.

    The MTF is that of the part, up to what doubt of the line and bins of a quarter sample leave.
    """
    rows, columns = np.mgrid[:100, :64]
    for angle in (2, 3, 5, 7, 10):
        tilt = math.radians(angle)
        for phase in (30.9, 31.2):
            away = (columns - phase) * math.cos(tilt) + (rows - 49.5) * math.sin(tilt)
            picture = np.clip(parts * away + 0.5, 0, 1)
            found = slanted_edge(picture=picture, frequency=FREQUENCY)
            assert np.abs(found.mtf - np.sinc(FREQUENCY / parts)).max() < 0.05


@pytest.mark.parametrize("steps", [16, 64, 256])
def test_quantized_edges_are_not_taken_for_clipped(steps):
    noise = np.random.default_rng(5).normal(0, 0.02, (64, 64))
    for picture in (edge_picture(5, 1), 0.2 + 0.6 * edge_picture(5, 1) + noise):
        rounded = np.rint(picture * steps) / steps
        found = slanted_edge(picture=rounded, frequency=FREQUENCY)
        assert found.mtf[16] == pytest.approx(edge_mtf(0.125, 5, 1), abs=0.06)
