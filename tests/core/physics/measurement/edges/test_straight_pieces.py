"""Chains of ridge points parted into straight pieces."""

import numpy as np

from core.physics.measurement.edges.ridges import RidgePoints, straight_pieces

SIDE = 40


def points(x, y, angle_deg=0.0):
    x, y = np.asarray(x, float), np.asarray(y, float)
    column, row = np.rint(x).astype(int), np.rint(y).astype(int)
    return RidgePoints(x, y, column, row, np.full(len(x), angle_deg), np.ones(len(x)))


def test_a_chain_with_points_at_its_ends_alone_comes_to_an_end():
    """Two rows of points 13 apart; those that link them are placed on one or the other."""
    across = np.arange(6.0, 30.0)
    x = np.concatenate([across, across, np.full(12, 29.0)])
    y = np.concatenate([np.full(24, 10.0), np.full(24, 23.0), np.arange(11.0, 23.0)])
    made = points(x, y)
    y = np.where(y < 17, 10.0, 23.0)
    made = RidgePoints(x, y, made.column, made.row, made.angle_deg, made.strength)
    for piece in straight_pieces(points=made, shape=(SIDE, SIDE), least_length=11):
        assert piece.length < 30
