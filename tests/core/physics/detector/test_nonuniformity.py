"""Corrections of known gains and offsets: the algebra by hand."""

import numpy as np
import pytest

from core.errors import DataError
from core.physics.detector.focal_plane_array import (
    one_point_offset,
    two_point_gain,
    two_point_offset,
)


@pytest.fixture
def maps():
    rng = np.random.default_rng(2)
    return 1.0 + 0.05 * rng.standard_normal((40, 50)), 3.0 * rng.standard_normal((40, 50))


def test_one_point_leaves_the_gains_times_the_distance_from_the_reference(maps):
    gain, offset = maps
    low = 100.0 * gain + offset
    found = 130.0 * gain + offset + one_point_offset(low=low)
    # y − y₁ + mean(y₁) = (S − S₁)·g + S₁·mean(g) + mean(o).
    expected = 30.0 * gain + 100.0 * gain.mean() + offset.mean()
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_two_points_leave_nothing_of_a_straight_response(maps):
    gain, offset = maps
    low, high = 100.0 * gain + offset, 150.0 * gain + offset
    factor = two_point_gain(low=low, high=high)
    np.testing.assert_allclose(factor, gain.mean() / gain, rtol=1e-12)
    for signal in (80.0, 100.0, 137.0, 400.0):
        seen = (signal * gain + offset) * factor + two_point_offset(low=low, gain=factor)
        np.testing.assert_allclose(seen, signal * gain.mean() + offset.mean(), rtol=1e-12)


def test_of_a_bent_response_the_bow_is_left(maps):
    """y = g·S·(1 − c·g·S): the line through two points misses by g²c(S − S₁)(S₂ − S)."""
    gain, _ = maps
    bend, low_s, high_s, signal = 1e-4, 100.0, 200.0, 150.0

    def response(level):
        return gain * level * (1 - bend * gain * level)

    low, high = response(low_s), response(high_s)
    factor = two_point_gain(low=low, high=high)
    found = response(signal) * factor + two_point_offset(low=low, gain=factor)
    bow = bend * gain**2 * (signal - low_s) * (high_s - signal)
    line = low.mean() + (high - low).mean() * (signal - low_s) / (high_s - low_s)
    np.testing.assert_allclose(found, line + bow * factor, rtol=1e-12)


def test_a_dead_pixel_keeps_its_gain():
    low, high = np.full((4, 5), 10.0), np.full((4, 5), 20.0)
    low[1, 2] = high[1, 2] = 0.0
    factor = two_point_gain(low=low, high=high)
    assert factor[1, 2] == 1.0
    assert factor[0, 0] == pytest.approx(0.95)


def test_references_that_are_alike_are_refused():
    with pytest.raises(DataError, match="on average"):
        two_point_gain(low=np.ones((3, 3)), high=np.ones((3, 3)))
