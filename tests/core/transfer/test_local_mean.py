"""Local means against weights summed over the mirrored frame."""

import numpy as np
import pytest

from core.chain.random_fields import local_mean
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work

TOLERANCE = {"double": 1e-12, "single": 2e-6}


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
