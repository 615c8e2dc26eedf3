"""Ridges of a picture's gradient: their points, and the straight pieces they make."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.arrays import Index, Vector, block_means
from core.records import dataclass, fields

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
    """A piece of a ridge."""

    # its middle
    x: float
    y: float
    angle_deg: float  # of the normal towards the brighter side
    length: float  # samples
    bend: float  # of its ends off the tangent at the middle, along the normal
    strength: float  # median gradient of its points
    points: Index


def straight_pieces(
    *,
    points: "RidgePoints",
    shape: tuple[int, ...],
    least_length: float,
    least_strength: float = 0.0,
    strength_of_16: float = 0.0,
) -> list[Piece]:
    """Link ridge points of like direction and part them into pieces, longest first.

    A piece has a least length, samples; a chain of any length a least strength, one of 16 points
    another, and others that of 16 as the root of their number. Neighbours are linked within sectors
    of 40°, once more with the sectors shifted by half, so that every direction lies well inside
    one; of pieces that share their points the longest remains. A chain that leaves its parabola is
    parted where it is farthest from its chord. Of more than 3,000 chains, as of a picture full of
    texture, the clearest are taken.
    """
    if len(points.x) == 0:
        return []
    pairs = _neighbours(points, shape)
    parted: dict[int, Index] = {}  # chains, by their first point
    pieces: list[Piece] = []
    for shift in (0.0, _SECTOR_DEG / 2.0):
        sector = ((points.angle_deg + shift) % 360.0 // _SECTOR_DEG).astype(np.intp)
        first, second = pairs
        same = sector[first] == sector[second]
        label = _components(first[same], second[same], len(sector))
        count = np.bincount(label)
        mean = np.bincount(label, points.strength) / np.maximum(count, 1)
        needed = np.maximum(least_strength, strength_of_16 * np.sqrt(16.0 / np.maximum(count, 1)))
        enough = (count >= _POINTS * least_length) & (mean >= needed)
        ordered, ends = np.argsort(label, kind="stable"), np.cumsum(count)
        chains = [ordered[ends[k] - count[k] : ends[k]] for k in np.flatnonzero(enough)]
        for chain in _clearest(points, chains, mean[enough], shape):
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


def _neighbours(points: "RidgePoints", shape: tuple[int, ...]) -> tuple[Index, Index]:
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


def _clearest(
    points: "RidgePoints", chains: list[Index], strength: Vector, shape: tuple[int, ...]
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
    """Number of the chain of each point, by links; chains in the order of their first points."""
    from scipy.sparse import coo_array  # imported where it is used: start-up time
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(first), np.bool_), (first, second)), shape=(size, size))
    return np.asarray(connected_components(links, directed=False)[1], np.intp)


def _parted(points: "RidgePoints", chain: Index, least_length: float) -> list[Piece]:
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


# Ridges of a picture's gradient: where steps may run, at sub-sample precision.

Picture = NDArray[np.floating]
Single = NDArray[np.float32]

SMOOTHING = 1.5  # samples, of the Gaussian whose derivative is taken
_STRIP = 512  # rows worked on at once
_MARGIN = 8  # rows beyond a strip that its results depend on
_BLOCK = 16  # samples, side of the blocks in which noise is looked at
_QUIET = 0.25  # share of the blocks taken as free of texture
_SHARE_OF_RANGE = 0.004  # of the picture's range, a step below which is no edge in any noise
_ABOVE_NOISE = 8.0


@dataclass(frozen=True)
class RidgePoints:
    """Places where the gradient is largest along its own direction."""

    # place, samples
    x: Vector
    y: Vector
    # the sample it belongs to
    column: Index
    row: Index
    angle_deg: Vector  # direction of the gradient, towards brighter, in [0, 360)
    strength: Vector  # gradient of the smoothed picture, per sample


def rough_noise(*, picture: Picture, missing: float = 0.0) -> float:
    """Standard deviation of a sample where the picture is quietest.

    A share of them, `missing`, has no noise, as it holds no data. Source: Immerkær, Fast noise
    variance estimation, 1996, in blocks of 16 × 16 samples of which the quietest quarter is taken.
    Good enough for thresholds.
    """
    rows, columns = (side // _BLOCK * _BLOCK for side in picture.shape)
    if rows == 0 or columns == 0:
        return 0.0
    blocks = []
    for top in range(0, rows, _STRIP):
        part = picture[top : min(rows, top + _STRIP), :columns].astype(np.float64)
        second = part[:, :-2] - 2.0 * part[:, 1:-1] + part[:, 2:]
        wide = np.zeros(part.shape)
        wide[1:-1, 1:-1] = np.abs(second[:-2] - 2.0 * second[1:-1] + second[2:])
        blocks.append(block_means(wide, _BLOCK).ravel())
    scale = (_BLOCK / (_BLOCK - 1)) * math.sqrt(math.pi / 2.0) / 6.0
    return float(np.quantile(np.concatenate(blocks), missing + (1.0 - missing) * _QUIET)) * scale


def ridge_points(
    *, picture: Picture, noise_sigma: float, check: Callable[[], None] = lambda: None
) -> RidgePoints:
    """Find the ridges of a picture's gradient.

    Notes
    -----
    Source: Canny, A computational approach to edge detection, 1986: derivative of a Gaussian, and
    of its modulus the largest along its direction; a parabola through three places gives the
    place between samples. White noise gives that gradient a standard deviation of
    σ/(√(8π)·1.5²).
    """
    level = float(np.median(picture[:: max(1, picture.shape[0] // 256)]))
    low, high = np.quantile(picture[:: max(1, picture.shape[0] // 512)], [0.001, 0.999])
    least = _ABOVE_NOISE * noise_sigma / (math.sqrt(8.0 * math.pi) * SMOOTHING**2)
    least = max(least, _SHARE_OF_RANGE * float(high - low) / (SMOOTHING * math.sqrt(2 * math.pi)))
    if not least > 0.0:
        least = math.ulp(1.0)
    strips: list[RidgePoints] = []
    rows = picture.shape[0]
    for top in range(0, rows, _STRIP):
        check()
        first, last = max(0, top - _MARGIN), min(rows, top + _STRIP + _MARGIN)
        part = (picture[first:last] - level).astype(np.float32)
        found = _ridges(_slope(part), _slope(part.T).T, least)
        own = (found.row + first >= top) & (found.row + first < top + _STRIP)
        place = found.x[own], found.y[own] + first, found.column[own], found.row[own] + first
        strips.append(RidgePoints(*place, found.angle_deg[own], found.strength[own]))
    return RidgePoints(
        *(np.concatenate([getattr(strip, f.name) for strip in strips]) for f in fields(RidgePoints))
    )


def _slope(part: Single) -> Single:
    """Derivative along the rows of a part smoothed along both, level beyond its borders."""
    reach = math.ceil(3.0 * SMOOTHING)
    away = np.arange(reach + 1)
    bell = np.exp(-0.5 * (away / SMOOTHING) ** 2)
    smooth = bell / (2.0 * bell.sum() - bell[0])
    steps = away * bell / (2.0 * np.sum(away**2 * bell))
    rows, columns = part.shape
    tall = np.pad(part, ((reach, reach), (0, 0)), mode="edge")
    down = np.float32(smooth[0]) * part
    for k in range(1, reach + 1):
        pair = tall[reach - k : reach - k + rows] + tall[reach + k : reach + k + rows]
        down += np.float32(smooth[k]) * pair
    wide = np.pad(down, ((0, 0), (reach, reach)), mode="edge")
    slope = np.zeros_like(part)
    for k in range(1, reach + 1):
        pair = wide[:, reach + k : reach + k + columns] - wide[:, reach - k : reach - k + columns]
        slope += np.float32(steps[k]) * pair
    return slope


def _ridges(slope_x: Picture, slope_y: Picture, least: float) -> RidgePoints:
    strength = np.hypot(slope_x, slope_y)
    inner = np.zeros(strength.shape, np.bool_)
    inner[2:-2, 2:-2] = strength[2:-2, 2:-2] > least
    row, column = np.nonzero(inner)
    here = strength[row, column]
    unit_x, unit_y = slope_x[row, column] / here, slope_y[row, column] / here
    before = _between(strength, row - unit_y, column - unit_x)
    after = _between(strength, row + unit_y, column + unit_x)
    ridge = (here >= before) & (here > after)
    row, column, unit_x, unit_y = row[ridge], column[ridge], unit_x[ridge], unit_y[ridge]
    here, before, after = here[ridge], before[ridge], after[ridge]
    curved = 2.0 * here - before - after
    off = np.clip(0.5 * (after - before) / np.maximum(curved, 1e-30), -0.7, 0.7)
    angle = np.degrees(np.arctan2(unit_y, unit_x)) % 360.0
    x, y = (column + off * unit_x).astype(np.float64), (row + off * unit_y).astype(np.float64)
    return RidgePoints(x, y, column, row, angle.astype(np.float64), here.astype(np.float64))


def _between(field: Picture, row: Vector, column: Vector) -> Vector:
    top = np.minimum(np.floor(row).astype(np.intp), field.shape[0] - 2)
    left = np.minimum(np.floor(column).astype(np.intp), field.shape[1] - 2)
    down, right = row - top, column - left
    upper = field[top, left] * (1 - right) + field[top, left + 1] * right
    lower = field[top + 1, left] * (1 - right) + field[top + 1, left + 1] * right
    return np.asarray(upper * (1 - down) + lower * down, np.float64)


# Order of a picture's lines in which all of its parts and directions have their turn.

_SIDE = 4  # parts of the picture across, and as many down
_DIRECTIONS = 3  # near x, near y, and between
_NEAR_DEG = 30.0


def spread_out(
    *, x: Vector, y: Vector, angle_deg: Vector, merit: Vector, shape: tuple[int, ...]
) -> Index:
    """Order lines by merit, less where better ones lie near and run alike.

    Notes
    -----
    The merit of the k-th best in a sixteenth of the picture and one of three classes of
    directions is divided by k: the first few then serve both axes and the whole frame, and weak
    lines come before strong ones only where these have many others beside them.
    """
    across = np.clip(x / shape[1] * _SIDE, 0, _SIDE - 1).astype(np.intp)
    down = np.clip(y / shape[0] * _SIDE, 0, _SIDE - 1).astype(np.intp)
    off = np.abs((angle_deg + 90.0) % 180.0 - 90.0)  # from x, 0 to 90
    direction = np.where(off <= _NEAR_DEG, 0, np.where(off >= 90.0 - _NEAR_DEG, 1, 2))
    group = (down * _SIDE + across) * _DIRECTIONS + direction
    order = np.lexsort((-merit, group))
    starts = np.searchsorted(group[order], group[order], side="left")
    rank = np.empty(len(order), np.intp)
    rank[order] = np.arange(len(order)) - starts
    return np.argsort(-merit / (rank + 1.0), kind="stable")
