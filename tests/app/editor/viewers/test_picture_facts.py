"""Samples as 8-bit levels, their histogram and quantiles, against double precision. No Qt."""

import math

import numpy as np
import pytest

from app.editor.viewers.picture.picture_facts import (
    BINS,
    between_ends,
    grey_levels,
    quantiles,
    spread_of,
)
from core.machine import Workers

DRAW = np.random.default_rng(7)
PICTURES = {
    "noise": (DRAW.normal(size=(37, 53)) * 3 + 20).astype(np.float32),
    "on a high level": (1e6 + DRAW.random((40, 31)) * 8).astype(np.float32),
    "huge": (DRAW.random((20, 21)) * 6e38 - 3e38).astype(np.float32),
    "signed": DRAW.integers(-3000, 3000, (17, 20)).astype(np.int16),
    "turned": (DRAW.normal(size=(53, 37))).astype(np.float32).T,
}


def exact_share(samples, low, high):
    """(sample − low)/(high − low) in the longest floating point there is."""
    wide = samples.astype(np.longdouble)
    return (wide - np.longdouble(low)) / (np.longdouble(high) - np.longdouble(low))


@pytest.mark.parametrize("name", PICTURES)
def test_levels_are_the_nearest_of_256(name):
    samples = PICTURES[name]
    least, most = float(samples.min()), float(samples.max())
    inside = least * 0.7 + most * 0.3, least * 0.2 + most * 0.8
    for low, high in ((least, most), inside):
        found = grey_levels(samples, low, high)
        wanted = np.clip(exact_share(samples, low, high) * 255, 0, 255)
        assert found.dtype == np.uint8
        # Half a level, and what single precision makes of a sample between two levels.
        assert np.abs(found - wanted).max() <= 0.5 + 1e-4


def test_levels_of_a_constant_picture_are_mid_grey():
    assert (grey_levels(np.full((3, 4), 5.0, np.float32), 5.0, 5.0) == 128).all()


@pytest.mark.parametrize("name", PICTURES)
def test_spread_counts_every_sample_in_its_bin_and_gives_quantiles(name):
    samples = PICTURES[name]
    found = spread_of(samples)
    assert (found.low, found.high) == (float(samples.min()), float(samples.max()))
    share = exact_share(samples, found.low, found.high) * BINS
    bins = np.minimum(np.floor(share), BINS - 1).astype(int)
    wanted = np.bincount(bins.ravel(), minlength=BINS)
    assert found.counts.sum() == samples.size
    # A sample next to the edge of a bin may be rounded over it.
    near = (np.abs(share - np.rint(share)) < 1e-3) & (share > 0.5) & (share < BINS - 0.5)
    assert np.abs(found.counts - wanted).sum() <= 2 * np.count_nonzero(near)
    # Quantiles are those of the sorted samples.
    shares = (0.0, 0.005, 0.25, 0.5, 0.995, 1.0)
    values = quantiles(samples, found, shares)
    ordered = np.sort(samples.astype(np.float64).ravel())
    for value, share in zip(values, shares, strict=True):
        rank = share * (samples.size - 1)
        lower, part = math.floor(rank), rank - math.floor(rank)
        upper = min(lower + 1, samples.size - 1)
        assert value == ordered[lower] * (1 - part) + ordered[upper] * part


def test_threads_change_nothing():
    samples = DRAW.normal(size=(1100, 1003)).astype(np.float32)
    workers = Workers()

    def each(function, items):
        workers.for_each(function, items, 4)

    alone, many = spread_of(samples), spread_of(samples, for_each=each)
    assert (alone.counts == many.counts).all()
    assert (grey_levels(samples, -1, 1) == grey_levels(samples, -1, 1, for_each=each)).all()


def test_a_picture_clipped_throughout_is_white_or_black():
    for levels, bits, drawn in (
        ((255.0, 255.0), 8, (0.0, 255.0)),  # clipped throughout: white
        ((0.0, 0.0), 8, (0.0, 255.0)),
        ((128.0, 128.0), 8, (128.0, 128.0)),
        ((255.0, 255.0), None, (255.0, 255.0)),  # no converter: no ends
    ):
        assert between_ends(*levels, bits) == drawn
