"""The thesis' MTF from the mean of rows, against its steps in plain numpy and known edges."""

import numpy as np
import pytest

from core.errors import DataError
from core.physics.measurement.row_average import row_average
from edge_pictures import edge_mtf, edge_picture


def test_steps_of_appendix_b():
    """Lines averaged, ends set level, differences of neighbours, modulus over its largest."""
    noise = np.random.default_rng(4).normal(0, 0.01, (3, 65))
    lines = edge_picture(0, 1.5, (3, 65)) + noise
    mean = (lines[0] + lines[1] + lines[2]) / 3
    mean[:26] = mean[:26].mean()
    mean[41:] = mean[41:].mean()
    differences = np.array([mean[n] - mean[n + 1] for n in range(64)])
    n = np.arange(64)
    centred = np.array([np.sum(differences * np.exp(-2j * np.pi * n * k / 64)) for k in range(33)])
    found = row_average(picture=lines, clip_left=26, clip_right=40)
    np.testing.assert_allclose(found.mtf, np.abs(centred) / np.abs(centred).max(), atol=1e-12)
    np.testing.assert_allclose(found.frequency, np.arange(33) / 64, atol=1e-15)
    np.testing.assert_allclose(found.clipped, mean, atol=1e-14)


@pytest.mark.parametrize("sigma", [1, 2])
def test_edge_is_read_lower_by_the_response_of_the_differences(sigma):
    found = row_average(picture=edge_picture(0, sigma, (20, 64)))
    truth = edge_mtf(found.frequency, 0, sigma) * np.sinc(found.frequency)
    np.testing.assert_allclose(found.mtf, truth, atol=0.004)


def test_standard_error_covers_the_scatter():
    """Of 40 noisy pictures the moduli scatter as each one's standard error says."""
    edge = edge_picture(0, 1, (48, 64))
    found = [
        row_average(picture=edge + np.random.default_rng(seed).normal(0, 0.1, edge.shape))
        for seed in range(40)
    ]
    scatter = np.std([each.mtf for each in found], axis=0)[3:16]
    told = np.sqrt(np.mean([each.error**2 for each in found], axis=0))[3:16]
    assert np.mean(told / scatter) == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize(
    ("picture", "settings", "reason"),
    [
        (np.random.default_rng(1).normal(size=(30, 40)), {}, "no edge found"),
        (np.ones((30, 40)), {"target": "line"}, "no line found"),
        (edge_picture(0, 1, (9, 6)), {}, "too small"),
        (
            edge_picture(0, 1, (9, 40)),
            {"clip_left": 30, "clip_right": 20},
            "the edge cannot extend",
        ),
        (edge_picture(0, 1, (9, 40)), {"clip_right": 40}, "the edge cannot extend"),
    ],
)
def test_what_cannot_be_measured_is_refused(picture, settings, reason):
    with pytest.raises(DataError, match=reason):
        row_average(picture=picture, **settings)
