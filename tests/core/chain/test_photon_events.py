"""Events that move: their distribution against that of deviates about a local mean summed here."""

import numpy as np
import pytest

from core.chain.random_fields import (
    LARGEST_SIGMA_PX,
    LEAST_SIGMA_PX,
    MOST,
    Stream,
    displaced_events,
    events_are_few,
)
from core.machine import Workers


def stream(seed=1996):
    return Stream(seed, "photons", "photons")


def local_mean(picture, sigma):
    """Gaussian weights over the frame mirrored without end, sample by sample."""

    def weights(size):
        matrix = np.zeros((size, size))
        reach = int(12 * sigma) + 1
        for place in range(size):
            for step in range(-reach, reach + 1):
                source = (place + step) % (2 * size)
                source = min(source, 2 * size - 1 - source)
                matrix[place, source] += np.exp(-0.5 * (step / sigma) ** 2)
        return matrix / matrix.sum(axis=1, keepdims=True)

    rows, columns = picture.shape
    return weights(rows) @ picture @ weights(columns).T


def scene(shape):
    rows, columns = np.indices(shape)
    return 1.0 + np.sin(rows) * np.cos(0.3 * columns) + 3.0 * ((rows == 2) & (columns == 1))


@pytest.mark.thorough(but=6)
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 5), (13, 12)])
@pytest.mark.parametrize("sigma", [2.5, 4.0, 30.0])
def test_mean_and_variance_of_every_sample_are_the_local_mean(shape, sigma):
    picture, share, draws = scene(shape), 0.05, 6000
    expected = share * local_mean(picture, sigma)
    drawn = np.array(
        [displaced_events(picture, stream(n), share=share, sigma_px=sigma) for n in range(draws)]
    )
    # A Poisson deviate of mean m has variance m and a fourth central moment of m + 3m².
    spread = np.sqrt(expected / draws)
    assert np.abs((drawn.mean(axis=0) - expected) / spread).max() < 5
    squares = np.square(drawn - expected).mean(axis=0)
    spread = np.sqrt((expected + 2 * expected**2) / draws)
    assert np.abs((squares - expected) / spread).max() < 5


def test_samples_are_independent_of_each_other():
    picture, draws = scene((6, 7)), 8000
    drawn = np.array(
        [displaced_events(picture, stream(n), share=0.2, sigma_px=3.0) for n in range(draws)]
    ).reshape(draws, -1)
    correlation = np.corrcoef(drawn.T) - np.eye(42)
    assert np.abs(correlation).max() < 5 / np.sqrt(draws)


def test_the_distribution_is_that_of_poisson():
    picture = np.full((40, 50), 2.0)
    counts = np.concatenate(
        [displaced_events(picture, stream(n), share=0.3, sigma_px=5.0).ravel() for n in range(40)]
    )
    expected = np.exp(-0.6) * np.array([1, 0.6, 0.18, 0.036]) * counts.size
    seen = np.bincount(counts.astype(int), minlength=4)[:4]
    assert (np.square(seen - expected) / expected).sum() < 20  # χ² with 4 degrees of freedom


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_same_counts_for_any_number_of_threads(dtype):
    picture = np.full((1100, 2000), 1.5, dtype)
    one, two = (
        displaced_events(
            picture,
            stream(),
            share=0.01,
            sigma_px=5.0,
            for_each=lambda function, items, n=n: Workers().for_each(function, items, n),
        )
        for n in (1, 2)
    )
    assert one.dtype == dtype
    assert one.tobytes() == two.tobytes()
    assert abs(one.sum() - 0.015 * picture.size) < 5 * np.sqrt(0.015 * picture.size)


def test_nothing_happens_without_radiance():
    assert not displaced_events(np.zeros((5, 6)), stream(), share=0.5, sigma_px=5.0).any()


def test_only_few_events_of_a_wide_blur_of_no_negative_radiance():
    few = {"share": 0.01, "sigma_px": 5.0}
    assert events_are_few(np.ones((3, 4)), **few)
    assert not events_are_few(np.full((3, 4), 101 * MOST), **few)
    assert not events_are_few(np.array([[1.0, -1e-9]]), **few)
    for sigma in (0.99 * LEAST_SIGMA_PX, 1.01 * LARGEST_SIGMA_PX, 1e300):
        assert not events_are_few(np.ones((3, 4)), share=0.01, sigma_px=sigma)
