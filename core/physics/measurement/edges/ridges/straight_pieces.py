"""Straight, or slightly bent, pieces of a picture's ridges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.ridges.ridge_points import RidgePoints
from core.physics.measurement.edges.ridges.spread_out import spread_out

Vector = NDArray[np.float64]
Index = NDArray[np.intp]

_SECTOR_DEG = 40.0
_LARGEST_TURN_DEG = 25.0  # between neighbours
_OFF = 0.8  # samples that a point may lie off its piece's parabola
_LARGEST_BEND = 2.5  # samples, of a piece's ends
_POINTS = 0.7  # a sample of length, at least: one row or column each, at 45°
_MOST_CHAINS = 3000  # of each sectors; twice as many as find_edges looks at
_INNER = 0.9  # of a chain's length, where it may be parted
_RIDGE = 1e-12  # of points at both ends alone, bend and offset are one
_SHARED = 0.3  # of its points, above which a piece repeats a longer one
_NEIGHBOURS = [(0, 1), (1, -1), (1, 0), (1, 1), (0, 2), (1, -2), (1, 2), (2, -1), (2, 0), (2, 1)]


@dataclass(frozen=True)
class Piece:
    """A piece of a ridge.

    Parameters
    ----------
    x, y : float
        Its middle.
    angle_deg : float
        Of the normal towards the brighter side.
    length : float
        Samples.
    bend : float
        Of its ends off the tangent at the middle, along the normal.
    strength : float
        Median gradient of its points.
    points : ndarray of int
        Which they are.
    """

    x: float
    y: float
    angle_deg: float
    length: float
    bend: float
    strength: float
    points: Index


def straight_pieces(
    *,
    points: RidgePoints,
    shape: tuple[int, ...],
    least_length: float,
    least_strength: float = 0.0,
    strength_of_16: float = 0.0,
) -> list[Piece]:
    """Link ridge points of like direction and part them into pieces, longest first.

    Parameters
    ----------
    points : RidgePoints
        Ridges of a picture.
    shape : tuple of int
        Rows and columns of it.
    least_length : float
        Of a piece, samples.
    least_strength, strength_of_16 : float
        Of a chain of any length, and of one of 16 points; of others as the root of the number.

    Notes
    -----
    Neighbours are linked within sectors of 40°, once more with the sectors shifted by half, so
    that every direction lies well inside one; of pieces that share their points the longest
    remains. A chain that leaves its parabola is parted where it is farthest from its chord. Of
    more than 3,000 chains, as of a picture full of texture, the clearest are taken.
    """
    if len(points.x) == 0:
        return []
    pairs = _neighbours(points, shape)
    parted: dict[int, Index] = {}  # chains, by their first point
    pieces: list[Piece] = []
    for shift in (0.0, _SECTOR_DEG / 2.0):
        sector = ((points.angle_deg + shift) % 360.0 // _SECTOR_DEG).astype(np.intp)
        label = _components(*_within(pairs, sector), len(sector))
        count = np.bincount(label)
        mean = np.bincount(label, points.strength) / np.maximum(count, 1)
        needed = np.maximum(least_strength, strength_of_16 * np.sqrt(16.0 / np.maximum(count, 1)))
        enough = (count >= _POINTS * least_length) & (mean >= needed)
        for chain in _clearest(points, _chains(label, count, enough), mean[enough], shape):
            if not np.array_equal(chain, parted.get(int(chain[0]), ())):
                pieces.extend(_parted(points, chain, least_length))
            parted[int(chain[0])] = chain
    pieces.sort(key=lambda piece: -piece.length)
    claimed = np.zeros(len(points.x), np.bool_)
    chosen = []
    for piece in pieces:
        if np.mean(claimed[piece.points]) <= _SHARED:
            claimed[piece.points] = True
            chosen.append(piece)
    return chosen


def _neighbours(points: RidgePoints, shape: tuple[int, ...]) -> tuple[Index, Index]:
    """Pairs of points that are neighbours and have nearly the same direction."""
    rows, columns = shape
    number = np.full((rows + 4, columns + 4), -1, np.int32)
    number[points.row + 2, points.column + 2] = np.arange(len(points.x), dtype=np.int32)
    first, second = [], []
    for down, right in _NEIGHBOURS:
        other = number[points.row + 2 + down, points.column + 2 + right]
        here = np.flatnonzero(other >= 0)
        there = other[here].astype(np.intp)
        turn = np.abs(points.angle_deg[here] - points.angle_deg[there])
        alike = np.minimum(turn, 360.0 - turn) < _LARGEST_TURN_DEG
        first.append(here[alike])
        second.append(there[alike])
    return np.concatenate(first), np.concatenate(second)


def _within(pairs: tuple[Index, Index], sector: Index) -> tuple[Index, Index]:
    """Pairs within one sector."""
    first, second = pairs
    same = sector[first] == sector[second]
    return first[same], second[same]


def _chains(label: Index, count: Index, enough: NDArray[np.bool_]) -> list[Index]:
    """The points of each label that is enough."""
    order = np.argsort(label, kind="stable")
    ends = np.cumsum(count)
    return [order[ends[k] - count[k] : ends[k]] for k in np.flatnonzero(enough)]


def _clearest(
    points: RidgePoints, chains: list[Index], strength: Vector, shape: tuple[int, ...]
) -> list[Index]:
    """At most as many chains as are parted, the clearest of all parts of a picture."""
    if len(chains) <= _MOST_CHAINS:
        return chains
    first = np.array([chain[0] for chain in chains])
    order = spread_out(
        x=points.x[first],
        y=points.y[first],
        angle_deg=points.angle_deg[first],
        merit=strength * np.sqrt([len(chain) for chain in chains]),
        shape=shape,
    )
    return [chains[k] for k in np.sort(order[:_MOST_CHAINS])]


def _components(first: Index, second: Index, size: int) -> Index:
    """Smallest number among the points that hang together with each, by links."""
    label = np.arange(size)
    while len(first):
        one, other = label[first], label[second]
        apart = one != other
        first, second, one, other = first[apart], second[apart], one[apart], other[apart]
        np.minimum.at(label, np.maximum(one, other), np.minimum(one, other))
        while True:
            further = label[label]
            if np.array_equal(further, label):
                break
            label = further
    return label


def _parted(points: RidgePoints, chain: Index, least_length: float) -> list[Piece]:
    """Pieces of a chain that lie along parabolas."""
    waiting, pieces = [chain], []
    while waiting:
        part = waiting.pop()
        if len(part) < _POINTS * least_length:
            continue
        x, y = points.x[part], points.y[part]
        middle_x, middle_y = float(x.mean()), float(y.mean())
        x, y = x - middle_x, y - middle_y
        angle = np.radians(points.angle_deg[part])
        direction = math.atan2(float(np.sin(angle).sum()), float(np.cos(angle).sum()))
        for _ in range(3):
            across_x, across_y = math.cos(direction), math.sin(direction)
            along, away = across_x * y - across_y * x, across_x * x + across_y * y
            direction -= math.atan(float(along @ away) / max(float(along @ along), 1e-300))
        across_x, across_y = math.cos(direction), math.sin(direction)
        along, away = across_x * y - across_y * x, across_x * x + across_y * y
        start, end = float(along.min()), float(along.max())
        length, centre = end - start, (start + end) / 2.0
        if length < least_length:
            continue
        place = (along - centre) / (length / 2.0)
        powers = np.stack([np.ones(len(place)), place, place**2])
        products = powers @ powers.T + _RIDGE * len(place) * np.eye(3)
        offset, tilt, bend = np.linalg.solve(products, powers @ away)
        off = np.abs(away - offset - tilt * place - bend * powers[2])
        if float(off.max()) > _OFF or abs(bend) > _LARGEST_BEND:
            inner = np.abs(place) < _INNER
            # Of a chain that has its points at both ends alone, its middle parts these.
            at = along[np.argmax(np.where(inner, np.abs(away), -1.0))] if inner.any() else centre
            waiting.extend([part[along < at], part[along >= at]])
            continue
        pieces.append(
            Piece(
                x=middle_x + offset * across_x - centre * across_y,
                y=middle_y + offset * across_y + centre * across_x,
                angle_deg=math.degrees(direction - math.atan(tilt / (length / 2.0))),
                length=length,
                bend=float(bend),
                strength=float(np.median(points.strength[part])),
                points=part,
            )
        )
    return pieces
