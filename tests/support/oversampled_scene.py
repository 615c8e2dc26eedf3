"""Scenes on a fine grid: exact shares of polygons, 1/f texture, shading, points, and their edges.

Nothing of the product is imported: what is measured and fitted is judged by it. x is across, y
down, in samples; the middle of sample (row i, column j) is x = j, y = i.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from scipy import fft

TEXTURE_BAND = 1.5  # cycles per sample: finer texture would be lost in any pixel


@dataclass(frozen=True)
class Shape:
    """A polygon of one level.

    `corners` are x, y in samples; `straight` says whether its sides count as edges (those of a
    many-sided disc do not); `texture` is the rms of its texture relative to its level.
    """

    corners: np.ndarray
    level: float
    straight: bool = True
    texture: float = 0.0


@dataclass(frozen=True)
class Scene:
    """Shapes, each over those before it, on a background with shading; texture; then points.

    `shading` is the relative change of the level per 100 samples across and down. `points` are x,
    y and flux, in level times sample area. With `disjoint`, shapes share sides but nothing more,
    and a cell that two of them share has nothing of the background.
    """

    background: float = 1000.0
    shapes: tuple[Shape, ...] = ()
    texture: float = 0.0
    texture_power: float = 2.0  # of the power spectrum, f^-p
    texture_seed: int = 0
    shading: tuple[float, float] = (0.0, 0.0)
    disjoint: bool = False
    points: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))


@dataclass(frozen=True)
class TrueEdge:
    """A straight edge between two even sides, as the scene has it.

    `angle_deg` is that of the normal towards the brighter side, from x towards y; `reach` the
    samples on both sides that are even, within `tolerance` of the contrast.
    """

    x: float
    y: float
    angle_deg: float
    length: float
    reach: float
    low: float
    high: float


@dataclass(frozen=True)
class Fine:
    """A scene on cells: `fine` a sample across and down, `margin` samples round the frame."""

    level: np.ndarray
    fine: int
    margin: int

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Level of the cells that hold the places."""
        row = np.floor((y + self.margin + 0.5) * self.fine).astype(int)
        column = np.floor((x + self.margin + 0.5) * self.fine).astype(int)
        return self.level[row, column]


def coverage(corners, rows, columns):
    """Share of each unit cell inside a polygon, exact; cell (i, j) is x in j…j+1, y in i…i+1.

    Each side is cut where it crosses the grid. A cut of height dy adds dy times the width to the
    right of its middle to its own cell, and dy to all cells further right (signed area).
    """
    corners = np.asarray(corners, float)
    total = np.zeros((rows, columns + 2))
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        cuts = np.concatenate(([0.0, 1.0], _crossings(y0, y1, rows), _crossings(x0, x1, columns)))
        cuts.sort()
        middle = (cuts[1:] + cuts[:-1]) / 2
        height = np.diff(cuts) * (y1 - y0)
        x = x0 + middle * (x1 - x0)
        row = np.floor(y0 + middle * (y1 - y0)).astype(int)
        inside = (row >= 0) & (row < rows) & (x < columns) & (height != 0)
        x, row, height = np.maximum(x[inside], 0.0), row[inside], height[inside]
        column = np.floor(x).astype(int)
        right = 1 - (x - column)
        np.add.at(total, (row, column), height * right)
        np.add.at(total, (row, column + 1), height * (1 - right))
    return np.abs(np.cumsum(total, axis=1)[:, :columns]).clip(0, 1)


def _crossings(start, end, last):
    """Where, from 0 to 1, a side crosses the grid's lines 0 … last."""
    if start == end:
        return np.empty(0)
    low, high = min(start, end), max(start, end)
    lines = np.arange(max(0, math.ceil(low)), min(last, math.floor(high)) + 1)
    return ((lines - start) / (end - start)).clip(0, 1)


def render(scene, rows, columns, *, fine=8, margin=24):
    """The scene's mean level in each cell of the fine grid."""
    shape = (rows + 2 * margin) * fine, (columns + 2 * margin) * fine
    level = np.full(shape, float(scene.background))
    texture = np.full(shape, scene.texture) if _has_texture(scene) else None
    for one in scene.shapes:
        corners = (np.asarray(one.corners, float) + margin + 0.5) * fine
        first = np.floor(corners.min(axis=0)).astype(int).clip(0, shape[::-1])
        last = np.ceil(corners.max(axis=0)).astype(int).clip(0, shape[::-1])
        if (last <= first).any():
            continue
        share = coverage(corners - first, last[1] - first[1], last[0] - first[0])
        place = np.s_[first[1] : last[1], first[0] : last[0]]
        below = scene.background if scene.disjoint else level[place]
        level[place] += share * (one.level - below)
        if texture is not None:
            texture[place] += share * (one.texture - texture[place])
    if texture is not None:
        level *= 1 + texture * _texture(scene, shape, fine)
    if any(scene.shading):
        y, x = ((np.arange(n) + 0.5) / fine - 0.5 - margin for n in shape)
        level *= 1 + (scene.shading[0] * x + scene.shading[1] * y[:, None]) / 100
    for x, y, flux in scene.points:
        row, column = (int((v + margin + 0.5) * fine) for v in (y, x))
        level[row, column] += flux * fine**2
    return Fine(level, fine, margin)


def _has_texture(scene):
    return scene.texture > 0 or any(one.texture > 0 for one in scene.shapes)


def _texture(scene, shape, fine):
    """A Gaussian field of mean square 1 whose power falls with the frequency, within ±3."""
    rng = np.random.default_rng([scene.texture_seed, 77])
    fy = fft.fftfreq(shape[0], 1 / fine)
    fx = fft.rfftfreq(shape[1], 1 / fine)
    rows = np.flatnonzero(np.abs(fy) <= TEXTURE_BAND)
    columns = np.flatnonzero(fx <= TEXTURE_BAND)
    radius = np.hypot(fy[rows][:, None], fx[columns])
    radius[0, 0] = np.inf
    drawn = rng.standard_normal((2, rows.size, columns.size))
    spectrum = np.zeros((shape[0], shape[1] // 2 + 1), complex)
    spectrum[np.ix_(rows, columns)] = (drawn[0] + 1j * drawn[1]) * radius ** (
        -scene.texture_power / 2
    )
    texture = fft.irfft2(spectrum, shape, overwrite_x=True)
    return (texture / texture.std()).clip(-3, 3)


def true_edges(scene, fine, rows, columns, *, reach=8.0, tolerance=0.05, shortest=16.0):
    """Straight sides that are seen with even levels on both sides, from the scene on its cells.

    Along each side the levels at 0.5 … `reach` samples on both sides must lie within `tolerance` of
    the contrast from their medians, and in the frame; the longest stretch that does is an edge.
    """
    away = np.arange(0.5, reach + 0.01, 0.5)
    edges = []
    for one in scene.shapes:
        if not one.straight:
            continue
        for start, end in zip(one.corners, np.roll(one.corners, -1, axis=0), strict=True):
            edge = _side(fine, np.asarray(start), np.asarray(end), away, tolerance, rows, columns)
            if edge is not None and edge.length >= shortest:
                edges.append(edge)
    return tuple(edges)


def _side(fine, start, end, away, tolerance, rows, columns):
    length = float(np.hypot(*(end - start)))
    if length < 2:
        return None
    along = (end - start) / length
    normal = np.array([-along[1], along[0]])
    at = np.arange(0.25, length, 0.5)
    middle = start + at[:, None] * along
    sides = []
    inside = np.ones(at.size, bool)
    for sign in (-1, 1):
        x = middle[:, :1] + sign * away * normal[0]
        y = middle[:, 1:] + sign * away * normal[1]
        good = (x > 0) & (x < columns - 1) & (y > 0) & (y < rows - 1)
        inside &= good.all(axis=1)
        sides.append(fine.at(x.clip(0, columns - 1), y.clip(0, rows - 1)))
    if not inside.any():
        return None
    low, high = (np.median(side[inside]) for side in sides)
    contrast = abs(high - low)
    even = inside.copy()
    for side, level in zip(sides, (low, high), strict=True):
        even &= (np.abs(side - level) <= tolerance * contrast).all(axis=1)
    first, last = _longest(even)
    if last <= first or contrast == 0:
        return None
    x, y = start + along * (at[first] + at[last - 1]) / 2
    angle = math.degrees(math.atan2(*(normal * np.sign(high - low))[::-1]))
    levels = sorted((float(low), float(high)))
    return TrueEdge(float(x), float(y), angle, (last - first) / 2, float(away[-1]), *levels)


def _longest(good):
    """First and last + 1 of the longest run of true."""
    steps = np.flatnonzero(np.diff(np.concatenate(([0], good.astype(int), [0]))))
    if not steps.size:
        return 0, 0
    firsts, lasts = steps[::2], steps[1::2]
    best = np.argmax(lasts - firsts)
    return int(firsts[best]), int(lasts[best])
