"""Random fields: distributions within sampling error, same bits for any number of threads."""

import numpy as np
import pytest
from scipy import special

from core.chain import random_fields
from core.chain.random_fields import (
    BLOCK,
    LARGEST_SIGMA_PX,
    LEAST_SIGMA_PX,
    MOST,
    Stream,
    displaced_events,
    events_are_few,
    local_mean,
    normal_field,
    poisson_field,
    uniform_field,
)
from core.errors import DataError
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from core.machine import Workers

SEEDS = range(20)
DTYPES = [np.float32, np.float64]


def stream(seed=1996, node="electronics", field="detector"):
    return Stream(seed, node, field)


def chi_square_probability(observed, expected):
    statistic = np.sum((observed - expected) ** 2 / expected)
    return special.chdtrc(len(expected) - 1, statistic)


def poisson_chi_square(counts, mean):
    """Probability of so bad a fit or worse, bins pooled to at least 20 expected."""
    highest = int(mean + 8 * np.sqrt(mean) + 8)
    k = np.arange(highest + 1)
    expected = counts.size * np.exp(k * np.log(mean) - mean - special.gammaln(k + 1))
    observed = np.bincount(counts.astype(int).ravel(), minlength=highest + 1)
    assert observed.size == highest + 1, "an event beyond eight deviations"
    used = np.flatnonzero(expected >= 20)
    inner = slice(used[0], used[-1] + 1)
    both = [
        np.concatenate([[v[: used[0]].sum()], v[inner], [v[used[-1] + 1 :].sum()]])
        for v in (observed, expected)
    ]
    both[1][-1] = counts.size - both[1][:-1].sum()
    few = both[1] < 5
    observed, expected = ([*v[~few], v[few].sum()] if few.any() else v for v in both)
    observed, expected = np.array(observed), np.array(expected)
    solid = expected > 1
    return chi_square_probability(observed[solid], expected[solid])


@pytest.mark.parametrize("dtype", DTYPES)
def test_normal_moments_and_shape(dtype):
    probabilities = []
    for seed in SEEDS:
        values = normal_field(stream(seed), (300, 333), dtype=dtype).astype(float)
        n = values.size
        assert abs(values.mean()) < 5 / np.sqrt(n)
        assert abs(values.var() - 1) < 5 * np.sqrt(2 / n)
        assert abs((values**3).mean()) < 5 * np.sqrt(15 / n)
        assert abs((values**4).mean() - 3) < 5 * np.sqrt(96 / n)
        edges = special.ndtri(np.arange(1, 100) / 100)
        observed = np.bincount(np.searchsorted(edges, values.ravel()), minlength=100)
        probabilities.append(chi_square_probability(observed, np.full(100, n / 100)))
    assert min(probabilities) > 1e-4
    assert 0.2 < np.mean(probabilities) < 0.8


@pytest.mark.parametrize("dtype", DTYPES)
def test_normal_tails(dtype):
    values = np.abs(normal_field(stream(), (1500, 1501), dtype=dtype))
    for limit in (3.0, 4.0):
        expected = values.size * special.erfc(limit / np.sqrt(2))
        assert abs(np.count_nonzero(values > limit) - expected) < 5 * np.sqrt(expected)
    assert 4.4 < values.max() < 7


@pytest.mark.parametrize("dtype", DTYPES)
def test_neighbours_and_the_halves_of_a_block_are_uncorrelated(dtype):
    values = normal_field(stream(), (4 * BLOCK,), dtype=dtype).astype(float)
    bound = 5 / np.sqrt(values.size)
    for lag in (1, 2, 512, 8192, 16384, BLOCK // 2, BLOCK):
        assert abs(np.mean(values[:-lag] * values[lag:])) < bound * np.sqrt(1.5)
        squares = values**2 - 1
        assert abs(np.mean(squares[:-lag] * squares[lag:])) < 2 * bound * np.sqrt(1.5)


@pytest.mark.parametrize("dtype", DTYPES)
def test_uniform(dtype):
    values = uniform_field(stream(), (500, 401), dtype=dtype)
    assert values.dtype == dtype
    assert 0.0 <= values.min() < values.max() < 1.0
    observed = np.bincount((values * 64).astype(int).ravel(), minlength=64)
    assert chi_square_probability(observed, np.full(64, values.size / 64)) > 1e-4


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("mean", [0.003, 0.3, 1.0, 3.9, 4.1, 12.0, 50.0, 1000.0])
def test_poisson_distribution(dtype, mean):
    mean = float(dtype(mean))
    probabilities = []
    for seed in range(6):
        counts = poisson_field(np.full((250, 301), mean, dtype), stream(seed))
        assert counts.dtype == dtype
        assert abs(counts.mean(dtype=float) - mean) < 5 * np.sqrt(mean / counts.size)
        spread = 5 * np.sqrt((mean + 2 * mean**2) / counts.size)
        assert abs(counts.astype(float).var() - mean) < spread
        probabilities.append(poisson_chi_square(counts, mean))
    assert min(probabilities) > 1e-4


def test_thinned_events_follow_a_mean_that_varies():
    mean = np.zeros((200, 300))
    mean[:, 100:200], mean[:, 200:] = 0.05, 2.0
    counts = poisson_field(mean, stream())
    assert not counts[:, :100].any()
    assert poisson_chi_square(counts[:, 100:200], 0.05) > 1e-3
    assert poisson_chi_square(counts[:, 200:], 2.0) > 1e-3


@pytest.mark.parametrize("mean", [1e6, 1e10, 0.9e12, 1.1e12, 1e15, 1e18, 1e30, 1e300])
def test_large_means_have_the_normal_limit(mean):
    counts = poisson_field(np.full(100_000, mean), stream())
    z = (counts - mean) / np.sqrt(mean)
    rounding = np.spacing(mean) / np.sqrt(mean)
    assert abs(z.mean()) < 5 / np.sqrt(z.size) + rounding
    assert abs(z.var() - 1) < 5 * np.sqrt(2 / z.size) + rounding
    assert np.all(counts == np.rint(counts))


def in_threads(threads):
    """In so many threads."""
    return lambda function, items: Workers().for_each(function, items, threads)


@pytest.mark.parametrize("size", [0, 1, 2, 3, 5, 100, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 7])
@pytest.mark.parametrize("dtype", DTYPES)
def test_any_size_and_the_same_bits_for_any_number_of_threads(size, dtype):
    mean = np.linspace(0, 3, size, dtype=dtype)
    for draw in (
        lambda threads: normal_field(stream(), (size,), dtype=dtype, for_each=in_threads(threads)),
        lambda threads: uniform_field(stream(), (size,), dtype=dtype, for_each=in_threads(threads)),
        lambda threads: poisson_field(mean, stream(), for_each=in_threads(threads)),
        lambda threads: poisson_field(mean * dtype(10), stream(), for_each=in_threads(threads)),
    ):
        one, two, three = (draw(threads) for threads in (1, 2, 3))
        assert one.dtype == dtype
        assert one.shape == (size,)
        assert np.all(np.isfinite(one))
        assert one.tobytes() == two.tobytes() == three.tobytes()


def test_streams_of_other_names_are_independent():
    base = normal_field(stream(), (BLOCK,))
    assert np.array_equal(base, normal_field(stream(), (BLOCK,)))
    others = [
        stream(1997),
        stream(node="electronics 2"),
        stream(field="amplifier"),
        Stream(1996, "electronicsdet", "ector"),
        Stream(199, "6electronics", "detector"),
        stream(-1),
        stream(10**40),
    ]
    for other in others:
        values = normal_field(other, (BLOCK,))
        assert abs(np.mean(base * values)) < 5 / np.sqrt(BLOCK)


@pytest.mark.parametrize("bad", [-1e-9, np.nan, np.inf])
def test_means_that_are_none_are_refused(bad):
    mean = np.ones((3, 4))
    mean[1, 2] = bad
    with pytest.raises(DataError, match=r": 1 of 12; .* at \(1, 2\)"):
        poisson_field(mean, stream())


def test_generator_of_a_block_is_what_the_field_is_made_of():
    field = normal_field(stream(), (2 * BLOCK,))
    second = stream().generator(1).standard_normal(BLOCK)
    assert np.array_equal(field[BLOCK:], second)
    assert random_fields.BLOCK == 131072


@pytest.mark.parametrize("size", [1, 6, 7, 1000, 1001])
def test_single_normals_are_box_and_mullers_of_the_words_of_their_block(size):
    """Radii of the first half of a block's 32-bit words, angles of the second; in double here."""
    half = (size + 1) // 2
    words = stream().generator(0).integers(0, 2**64, size=half, dtype=np.uint64).view(np.uint32)
    radius = np.sqrt(-2.0 * np.log((words[:half] + 0.5) / 2.0**32))
    angle = np.pi / 2**31 * words[half:].view(np.int32)
    expected = np.concatenate([np.cos(angle) * radius, np.sin(angle) * radius])[:size]
    assert normal_field(stream(), (size,), dtype=np.float32) == pytest.approx(expected, abs=3e-6)


# Events that move: their distribution against that of deviates about a local mean summed here.


def events(picture, draws, **how):
    streams = (Stream(seed, "photons", "photons") for seed in range(draws))
    return np.array([displaced_events(picture, stream, **how) for stream in streams])


def summed(image, sigma):
    """Continuous Gaussian weights sampled and added over many mirror images, axis by axis."""

    def matrix(size):
        reach = int(np.ceil(10 * sigma)) + 1
        offsets = np.arange(-reach, reach + 1)
        weights = np.exp(-0.5 * (offsets / sigma) ** 2)
        weights /= weights.sum()
        result = np.zeros((size, size))
        for row in range(size):
            for offset, weight in zip(offsets, weights, strict=True):
                place = (row + offset) % (2 * size)
                result[row, place if place < size else 2 * size - 1 - place] += weight
        return result

    return matrix(image.shape[0]) @ image @ matrix(image.shape[1]).T


def scene(shape):
    rows, columns = np.indices(shape)
    return 1.0 + np.sin(rows) * np.cos(0.3 * columns) + 3.0 * ((rows == 2) & (columns == 1))


@pytest.mark.thorough(but=6)
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 5), (13, 12)])
@pytest.mark.parametrize("sigma", [2.5, 4.0, 30.0])
def test_mean_and_variance_of_every_sample_are_the_local_mean(shape, sigma):
    picture, share, draws = scene(shape), 0.05, 6000
    expected = share * summed(picture, sigma)
    drawn = events(picture, draws, share=share, sigma_px=sigma)
    # A Poisson deviate of mean m has variance m and a fourth central moment of m + 3m².
    spread = np.sqrt(expected / draws)
    assert np.abs((drawn.mean(axis=0) - expected) / spread).max() < 5
    squares = np.square(drawn - expected).mean(axis=0)
    spread = np.sqrt((expected + 2 * expected**2) / draws)
    assert np.abs((squares - expected) / spread).max() < 5


def test_samples_are_independent_of_each_other():
    picture, draws = scene((6, 7)), 8000
    drawn = events(picture, draws, share=0.2, sigma_px=3.0).reshape(draws, -1)
    correlation = np.corrcoef(drawn.T) - np.eye(42)
    assert np.abs(correlation).max() < 5 / np.sqrt(draws)


def test_the_distribution_is_that_of_poisson():
    picture = np.full((40, 50), 2.0)
    counts = events(picture, 40, share=0.3, sigma_px=5.0)
    expected = np.exp(-0.6) * np.array([1, 0.6, 0.18, 0.036]) * counts.size
    seen = np.bincount(counts.astype(int).ravel(), minlength=4)[:4]
    assert (np.square(seen - expected) / expected).sum() < 20  # χ² with 4 degrees of freedom


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_same_counts_for_any_number_of_threads(dtype):
    picture = np.full((1100, 2000), 1.5, dtype)
    how = {"share": 0.01, "sigma_px": 5.0}
    one, two = (displaced_events(picture, stream(), for_each=in_threads(n), **how) for n in (1, 2))
    assert one.dtype == dtype
    assert one.tobytes() == two.tobytes()
    assert abs(one.sum() - 0.015 * picture.size) < 5 * np.sqrt(0.015 * picture.size)


def test_only_few_events_of_a_wide_blur_of_no_negative_radiance():
    few = {"share": 0.01, "sigma_px": 5.0}
    assert events_are_few(np.ones((3, 4)), **few)
    assert not events_are_few(np.full((3, 4), 101 * MOST), **few)
    assert not events_are_few(np.array([[1.0, -1e-9]]), **few)
    for sigma in (0.99 * LEAST_SIGMA_PX, 1.01 * LARGEST_SIGMA_PX, 1e300):
        assert not events_are_few(np.ones((3, 4)), share=0.01, sigma_px=sigma)


# Local means against weights summed over the mirrored frame.

TOLERANCE = {"double": 1e-12, "single": 2e-6}


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (37, 64), (128, 50)])
@pytest.mark.parametrize("sigma", [4.0, 5.0, 30.0])
def test_equals_the_sum(sigma, shape, precision):
    work = Work(Policy(precision=precision), Store())
    image = np.random.default_rng(4).uniform(20, 60, shape)
    got = local_mean(work, image.astype(work.policy.dtype), sigma_px=sigma)
    expected = summed(image, sigma)
    assert got.dtype == work.policy.dtype
    assert np.abs(got - expected).max() <= TOLERANCE[precision] * np.abs(expected).max()
