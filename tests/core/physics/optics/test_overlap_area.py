"""Overlaps of discs against fifty digits."""

from __future__ import annotations

import sys

import numpy as np
from mpmath import acos, mp, mpf, pi, sqrt

from core.physics.optics.overlap_area import disc_overlap_fraction


def test_near_tangency_no_digit_is_lost():
    """2/π·(arccos v − v·√(1 − v²)); the area is a cube of the angle, right to a few roundings."""
    ratio = np.concatenate([np.linspace(0.9, 0.999, 500), 1.0 - np.geomspace(1e-12, 1e-3, 100)])
    fractions = disc_overlap_fraction(distance_ratio=ratio)
    with mp.workdps(50):
        for v, fraction in zip(map(mpf, ratio.tolist()), fractions.tolist(), strict=True):
            true = 2 / pi * (acos(v) - v * sqrt(1 - v * v))
            assert abs(fraction / true - 1) <= 8 * sys.float_info.epsilon
