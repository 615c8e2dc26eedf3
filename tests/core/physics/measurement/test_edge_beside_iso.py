"""The MTF of edges without noise beside theory, and beside e-SFR as ISO 12233 has it by bins."""

import math

import numpy as np
import pytest

from core.physics.measurement.edge_mtf import measure_edge
from core.physics.measurement.edge_search import find_edges
from oversampled_camera import Camera, half_plane, take, true_mtf

CAMERAS = {
    "visible, 5.86 µm, F/4": Camera(cutoff=5.86 / (0.55 * 4), photons=False),
    "visible, 3.45 µm, F/2.8, out of focus": Camera(
        cutoff=3.45 / (0.55 * 2.8), defocus=0.25, pixel=(0.95, 0.95), photons=False
    ),
    "long wave, 17 µm, F/1.1": Camera(
        cutoff=17 / (10 * 1.1), gaussian=(0.25, 0.25), pixel=(0.95, 0.95), photons=False
    ),
    "mid wave, 15 µm, F/4": Camera(
        cutoff=15 / (4.25 * 4), jitter=0.1, pixel=(0.95, 0.95), photons=False
    ),
}
BINS = 4


def e_sfr(picture):
    """Frequency along the normal and MTF: centroids of rows' derivatives, a line through them,
    four bins a sample, central difference, Hamming's window, and that difference divided out.

    What the mean over a bin takes is not divided out in the standard.
    """
    rows, columns = picture.shape
    x = np.arange(columns)
    change = np.gradient(picture, axis=1)
    place = (change * x).sum(axis=1) / change.sum(axis=1)
    for _ in range(2):
        fit = np.polyfit(np.arange(rows), place, 1)
        window = 0.54 + 0.46 * np.cos(
            np.pi * np.clip((x - np.polyval(fit, np.arange(rows))[:, None]) / (columns / 2), -1, 1)
        )
        place = (change * window * x).sum(axis=1) / (change * window).sum(axis=1)
    fit = np.polyfit(np.arange(rows), place, 1)
    whole = round(int(abs(fit[0]) * rows) / abs(fit[0]))  # rows of whole periods of the phase
    away = x - np.polyval(fit, np.arange(whole))[:, None]
    number = np.floor(away * BINS).astype(int) + columns * BINS // 2
    inside = (number >= 0) & (number < columns * BINS)
    sums = np.bincount(number[inside], picture[:whole][inside], columns * BINS)
    counts = np.bincount(number[inside], minlength=columns * BINS)
    half = columns * BINS // 2 - 8 * BINS
    spread = (sums / np.maximum(counts, 1))[8 * BINS : 8 * BINS + 2 * half]
    line = np.gradient(spread)
    line = np.roll(line, half - round((line * np.arange(2 * half)).sum() / line.sum()))
    modulus = np.abs(np.fft.rfft(line * np.hamming(2 * half)))
    frequency = np.fft.rfftfreq(2 * half, 1 / BINS)
    difference = np.minimum(1 / np.abs(np.sinc(2 * frequency / BINS)).clip(0.1), 10)
    return frequency / math.cos(math.atan(fit[0])), modulus / modulus[0] * difference


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize("angle", [3.0, 5.0])
def test_an_edge_without_noise(name, angle):
    """Within 8e-4 of theory up to Nyquist, and within its error; e-SFR by bins within 0.013,
    most of it the mean over a bin, sinc(f/4), which is 0.026 of the MTF at Nyquist."""
    camera = CAMERAS[name]
    scene = half_plane(angle, (64.3, 64.1), 200.0, 1000.0)
    picture = take(scene, camera, rows=128, columns=128, fine=16).clean
    [edge] = find_edges(picture=picture)
    frequency = np.linspace(0.01, 0.5, 99)
    found = measure_edge(picture=picture, edge=edge, frequency=frequency)
    away = np.abs(found.mtf - true_mtf(camera, angle, frequency))
    assert away.max() < 8e-4
    assert (away < found.sigma).all()
    places, binned = e_sfr(picture)
    near = (places > 0) & (places <= 0.5)
    standard = binned[near] - true_mtf(camera, angle, places[near])
    assert np.abs(standard).max() < 0.014
    mean_over_bin = np.sinc(places[near] / BINS)
    ours = np.interp(places[near], frequency, found.mtf)
    assert np.abs(binned[near] / mean_over_bin - ours).max() < 0.01
