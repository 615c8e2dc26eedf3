"""Long tails of a camera's blur, seen in how the even sides of a picture's edges change.

Veiling glare, scintillators and diffusion spread some per cent of the light over tens of samples.
An edge's own surroundings end before that light does: the step between them is too small, and the
MTF, which is divided by it, too large at all frequencies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.found_edge import EdgeSamples, FoundEdge, rectangle_samples
from core.physics.measurement.edges.ridges import between

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Index = NDArray[np.intp]

_LENGTHS = tuple(7.0 * 1.18**k for k in range(12))  # samples, to 43
_DIFFRACTION = ("Lorentzian", 4.0)  # what an edge's own fit has, too
_DIFFRACTED = 0.08, 0.06  # light in it over that in the core, and the doubt of that: 0.1 / cutoff
_FORMS = ("exponential", "Gaussian", "Lorentzian")
_FARTHEST = 120.0  # samples from an edge to which its sides are followed
_NEAREST, _WIDTHS = 6.0, 5.0  # samples, and widths of the blur, from which they are
_WIDE, _PIECES, _LONGEST = 3.0, 4, 120.0  # samples of a strip, pieces along an edge, and samples
_JUMP, _CHANGE = 0.03, 0.08  # of the contrast, from strip to strip and altogether
_SPREAD = 1.5  # times the noise, that samples of a strip scatter at most
_FILLED = 0.7  # of a strip's samples, that lie in the frame
_LEAST_NOISE = 2e-4  # of the contrast
_ODD, _ROUNDS = 2.0, 6  # times the usual square of what is left of a side; fits that find it
_MOST_EDGES = 24
_MOST_CELLS = 400_000  # of the grid on which the tails are computed
_BEYOND = 60.0  # samples beyond the frame, where the scene is taken to go on
_MOST, _USUAL = 0.4, 0.08  # light in the tail over that in the core
_NO_TAIL, _NO_SLOPE = 0.7, 0.7  # probabilities before looking
_SLOPE = 0.1  # of the contrast over 100 samples, that light may be uneven by
_POINTS = 9  # of each tail's share
_LIKELY = 0.03  # probability of any tail, below which there is none
_NEGLIGIBLE = 3e-3  # of that probability, below which a tail is left out


@dataclass(frozen=True)
class TailShare:
    """How much of all light lies in long tails."""

    # of all light, and its standard error
    share: float
    error: float
    beyond: float  # share of all light that lies farther away than the sides of the edges are seen
    seen: float  # samples from the edges to which these are, median


@dataclass(frozen=True)
class LongTails:
    """What is known of the light in long tails: possible tails and how likely each is."""

    # of each tail, and its length in samples
    form: tuple[str, ...]
    length: tuple[float, ...]
    # light that each tail brings to each cell, for one unit in the core; shape (tails, rows,
    # columns), in the picture's unit
    spread: NDArray[np.float64]
    factor: int  # samples along the side of a cell
    which: Index  # tail of each possibility; 0 of the one without any, whose `ratio` is 0
    # light in the tail over that in the core, and the probability
    ratio: Vector
    weight: Vector
    seen: float  # samples from the edges to which their sides could be followed, median

    @property
    def share(self) -> TailShare:
        """How much of all light lies in the tail."""
        share = self.ratio / (1.0 + self.ratio)
        mean = float(self.weight @ share)
        left = np.array(
            [
                _left(form, self.seen / length)
                for form, length in zip(self.form, self.length, strict=True)
            ]
        )
        return TailShare(
            share=mean,
            error=math.sqrt(float(self.weight @ (share - mean) ** 2)),
            beyond=float(self.weight @ (share * left[self.which])),
            seen=self.seen,
        )

    def at(self, tail: int, x: Vector, y: Vector) -> Vector:
        """What a tail brings to places of the picture."""
        return _between(self.spread[tail], self.factor, x, y)

    def transfer(self, tail: int, frequency: Vector) -> Vector:
        """Transfer function of a tail, cycles per sample."""
        return _transfer(self.form[tail], self.length[tail], frequency)


@dataclass(frozen=True)
class _Sides:
    """Means of strips beside edges: value, variance, place; and the side and piece of each."""

    value: Vector
    variance: Vector
    x: Vector
    y: Vector
    unit: Index
    seen: Vector


def long_tails(
    *,
    picture: NDArray[np.floating],
    edges: Sequence[FoundEdge],
    missing: NDArray[np.bool_] | None = None,
    check: Callable[[], None] = lambda: None,
) -> LongTails | None:
    """Estimate the light in long tails from the sides of a picture's edges.

    Parameters
    ----------
    missing : ndarray of bool, optional
        Samples that hold no data; the mean of the others takes their place.

    Returns
    -------
    LongTails or None
        None where no side is long enough to show any, or none is likely.

    Notes
    -----
    The picture is (1 − w)·c∗s + w·t∗s of the scene s, the core c and the tail t. With u =
    (1 − w)·c∗s and b = w / (1 − w) it is u + b·t∗u, and t∗u follows from the picture by division
    with 1 + b·T in the frequency domain; the scene is taken to go on beyond the frame's sides.
    Beside an edge the scene is even: there the picture changes as b·t∗u does, whatever else lies in
    the frame. For tails whose line spread is exponential (scintillators, light guides), Gaussian
    (halo) or Lorentzian (veiling glare; ISO 9358:1994), b follows by least squares with a level for
    each side; unevenness of the light is allowed for by a plane. Tails are averaged by their
    probability (Hoeting, Madigan, Raftery and Volinsky, Bayesian model averaging, Statistical
    Science 14, 1999), beside the possibility that there is none; residuals that hang together make
    it less sharp.
    """
    chosen = edges[:_MOST_EDGES]
    factor = max(2, math.ceil(math.sqrt(picture.size / _MOST_CELLS)))
    seen = picture
    if missing is not None:
        seen = np.where(missing, np.nan, picture)
        picture = np.where(missing, float(picture[~missing].mean()), picture)
    sides = _sides(seen, chosen, factor)
    if sides is None:
        return None
    check()
    contrast = float(np.median([edge.contrast for edge in chosen]))
    waves, radius, inner = _coarse_waves(picture, factor)
    lengths = [length for length in _LENGTHS if length >= factor]
    tails = [(form, length) for length in lengths for form in _FORMS]
    if not tails:
        return None
    level = _without_levels(sides.value, sides)
    plane = np.stack([_without_levels(at, sides) for at in (sides.x, sides.y)])
    plane = plane * (_SLOPE * contrast / 100.0)
    spreads, columns = [], []
    for form, length in [*tails, _DIFFRACTION]:
        check()
        passed = _transfer(form, length, radius)
        spread, ratio = np.zeros(0), 0.0
        for _ in range(2):  # the second with the light that the first has found in the tail
            spread = _back(waves * passed / (1.0 + ratio * passed), inner)
            column = _without_levels(_between(spread, factor, sides.x, sides.y), sides)
            weighted = column / sides.variance
            square = max(float(weighted @ column), 1e-300)
            ratio = min(max(float(weighted @ level) / square, 0.0), _MOST)
        spreads.append(spread)
        columns.append(column)
    diffracted = columns.pop()
    level = level - _DIFFRACTED[0] * diffracted
    others = np.stack([_DIFFRACTED[1] * diffracted, *plane])
    sides = _in_accord(level, np.stack(columns), others, sides)
    which, ratio_of, weight = _possibilities(level, np.stack(columns), others, sides)
    tailed = ratio_of > 0.0
    likely = float(weight[tailed].sum())
    if likely < _LIKELY:
        return None
    each = np.bincount(which[tailed], weight[tailed], len(tails))
    kept = ~tailed | (each > _NEGLIGIBLE * likely)[which]
    which, ratio_of, weight = which[kept], ratio_of[kept], weight[kept]
    which = np.where(ratio_of > 0.0, which, which[ratio_of > 0.0][0])
    used, place = np.unique(which, return_inverse=True)
    return LongTails(
        form=tuple(tails[k][0] for k in used),
        length=tuple(tails[k][1] for k in used),
        spread=np.stack([spreads[k] for k in used]),
        factor=factor,
        which=place.astype(np.intp),
        ratio=ratio_of,
        weight=weight / weight.sum(),
        seen=float(np.median(sides.seen)),
    )


def _possibilities(
    level: Vector, columns: Matrix, beside: Matrix, sides: _Sides
) -> tuple[Index, Vector, Vector]:
    """Which tail, its ratio, and the probability of each possibility."""
    sharpness = 1.0
    terms = []
    for slope in (False, True):
        others = beside if slope else beside[:1]
        right, square, normal, on_level = _alone(level, columns, others, sides)
        gain = float(on_level @ np.linalg.solve(normal, on_level)) / 2.0
        lost = float(np.linalg.slogdet(normal)[1]) / 2.0
        terms.append((right, square, gain, lost))
    # Residuals about the best of all tails, and how far they hang together.
    best, rest = _best(level, columns, beside, sides)
    units = int(sides.unit.max()) + 1
    scores = np.bincount(sides.unit, rest * columns[best] / sides.variance, units)
    sizes = np.bincount(sides.unit, columns[best] ** 2 / sides.variance, units)
    degrees = max(1, len(rest) - units - 3)
    apart = float(np.sum(scores**2)) / max(float(np.sum(sizes)), 1e-300)
    sharpness = 1.0 / max(1.0, float(np.sum(rest**2 / sides.variance)) / degrees, apart)
    which, ratios, logs = [], [], []
    for slope, (right, square, gain, lost) in zip((False, True), terms, strict=True):
        about = math.log(1.0 - _NO_SLOPE if slope else _NO_SLOPE) - lost + gain * sharpness
        which.append(np.zeros(1, np.intp))
        ratios.append(np.zeros(1))
        logs.append(np.array([about + math.log(_NO_TAIL)]))
        prior = about + math.log((1.0 - _NO_TAIL) / (len(columns) * _USUAL))
        for k, (on, of) in enumerate(zip(right * sharpness, square * sharpness, strict=True)):
            middle, width = on / of, 1.0 / math.sqrt(of)
            low = min(max(0.0, middle - 4.0 * width), 0.9 * _MOST)
            high = min(_MOST, max(middle + 4.0 * width, low + width))
            ratio = low + (np.arange(_POINTS) + 0.5) / _POINTS * (high - low)
            log = ratio * on - ratio**2 * of / 2.0 - ratio / _USUAL
            which.append(np.full(_POINTS, k))
            ratios.append(ratio)
            logs.append(prior + log + math.log((high - low) / _POINTS))
    log = np.concatenate(logs)
    weight = np.exp(log - log.max())
    return np.concatenate(which).astype(np.intp), np.concatenate(ratios), weight / weight.sum()


def _alone(
    level: Vector, columns: Matrix, beside: Matrix, sides: _Sides
) -> tuple[Vector, Vector, Matrix, Vector]:
    """Products of tails with the levels, and their squares, without what may lie beside them.

    Then the normal matrix of that, and its products with the levels.
    """
    whitened = beside / sides.variance
    normal = np.eye(len(beside)) + whitened @ beside.T
    on_level, on_columns = whitened @ level, whitened @ columns.T
    solved = np.linalg.solve(normal, on_columns)
    right = columns @ (level / sides.variance) - solved.T @ on_level
    square = np.sum(columns**2 / sides.variance, axis=1) - np.sum(on_columns * solved, axis=0)
    return right, np.maximum(square, 1e-12), normal, on_level


def _best(level: Vector, columns: Matrix, beside: Matrix, sides: _Sides) -> tuple[int, Vector]:
    """The tail that explains most, and what it leaves of the levels."""
    right, square, normal, _ = _alone(level, columns, beside, sides)
    ratio = np.clip(right / square, 0.0, _MOST)
    best = int(np.argmax(ratio * right - ratio**2 * square / 2.0))
    rest = level - ratio[best] * columns[best]
    parts = np.linalg.solve(normal, beside @ (rest / sides.variance))
    return best, np.asarray(rest - parts @ beside, np.float64)


def _in_accord(level: Vector, columns: Matrix, beside: Matrix, sides: _Sides) -> _Sides:
    """The sides with a larger variance of those that do not change as the others do.

    Notes
    -----
    A corner of something else in some strips of one side is no tail, and would make all others
    look as if they showed none. Least squares with weights from the residuals, again and again.
    """
    count, given = np.bincount(sides.unit), sides.variance
    for _ in range(_ROUNDS):
        _, rest = _best(level, columns, beside, sides)
        apart = np.bincount(sides.unit, rest**2 / given) / np.maximum(count - 1, 1)
        usual = max(1.0, float(np.median(apart)))
        larger = np.maximum(1.0, apart / (_ODD * usual))
        sides = replace(sides, variance=given * larger[sides.unit])
    return sides


def _sides(picture: NDArray[np.floating], edges: Sequence[FoundEdge], factor: int) -> _Sides | None:
    """Strips beside the edges, outwards to where the frame or something else begins."""
    parts, units = [], 0
    seen: list[float] = []
    for edge in edges:
        start = max(_NEAREST, _WIDTHS * edge.softness, 2.0 * factor)
        half = min(edge.length, _LONGEST) / 2.0
        bend = edge.bend * (2.0 * half / edge.length) ** 2
        samples = rectangle_samples(
            picture=picture, middle=(edge.x, edge.y), angle_deg=edge.angle_deg,
            half_length=half, reach=_FARTHEST, bend=bend,
        )  # fmt: skip
        mean, variance, good = _strips(samples, half, start, edge.contrast)
        length = good.sum(axis=1)
        seen += [start + _WIDE * n for n in length]
        good[length < 2] = False
        which, strip = np.nonzero(good)
        if len(which) == 0:
            continue
        away = (start + (strip + 0.5) * _WIDE) * np.where(which >= _PIECES, 1.0, -1.0)
        along = ((which % _PIECES + 0.5) / _PIECES * 2.0 - 1.0) * half
        across_x, across_y = edge.normal
        moved = away + bend * (along / half) ** 2
        x = edge.x + moved * across_x - along * across_y
        y = edge.y + moved * across_y + along * across_x
        parts.append((mean[which, strip], variance[which, strip], x, y, which + units))
        units += 2 * _PIECES
    if not parts:
        return None
    value, variance, x, y, unit = (np.concatenate(column) for column in zip(*parts, strict=True))
    return _Sides(value, variance, x, y, np.unique(unit, return_inverse=True)[1], np.array(seen))


def _strips(
    samples: EdgeSamples, half: float, start: float, contrast: float
) -> tuple[Matrix, Matrix, NDArray[np.bool_]]:
    """Mean of each strip, the variance of that, and whether all up to it are even.

    Shapes are (sides and pieces along the edge, strips outwards); samples that are no numbers are
    missing.
    """
    away = np.abs(samples.distance) - start
    chosen = np.isfinite(samples.value) & (away > 0.0)
    strips = math.ceil((_FARTHEST - start) / _WIDE)
    piece = np.clip(((samples.along / half + 1.0) / 2.0 * _PIECES).astype(int), 0, _PIECES - 1)
    piece = piece + _PIECES * (samples.distance > 0.0)
    cell = (piece * strips + (away / _WIDE).astype(int))[chosen]
    value, shape = samples.value[chosen], (2 * _PIECES, strips)
    count = np.bincount(cell, minlength=2 * _PIECES * strips).reshape(shape)
    many = np.maximum(count, 1)
    mean = np.bincount(cell, value, many.size).reshape(shape) / many
    off = value - mean.ravel()[cell]
    scatter = np.sqrt(np.bincount(cell, off**2, many.size).reshape(shape) / many)
    filled = count >= _FILLED * 2.0 * half / _PIECES * _WIDE
    near = [part[:3][full[:3]] for part, full in zip(scatter, filled, strict=True)]
    noises = [float(np.median(part)) if len(part) else math.inf for part in near]
    noise = np.maximum(np.array(noises)[:, np.newaxis], _LEAST_NOISE * contrast)
    doubt = 4.0 * noise / np.sqrt(many)
    first = mean[:, :1]
    steps = np.abs(np.diff(mean, axis=1, prepend=first))
    even = (steps <= _JUMP * contrast + math.sqrt(2.0) * doubt) & (
        np.abs(mean - first) <= _CHANGE * contrast + 2.0 * doubt
    )
    even &= scatter <= _SPREAD * noise + _JUMP * contrast
    good = np.logical_and.accumulate(filled & even, axis=1)
    # The last strip before something else may have a part of it.
    after = np.logical_and.accumulate(filled, axis=1)
    good[:, :-1] &= good[:, 1:] | ~after[:, 1:]
    return np.asarray(mean, np.float64), np.asarray(noise**2 / many, np.float64), good


def _without_levels(value: Vector, sides: _Sides) -> Vector:
    """Values less the mean of their side and piece."""
    total = np.bincount(sides.unit, 1.0 / sides.variance)
    mean = np.bincount(sides.unit, value / sides.variance) / total
    return np.asarray(value - mean[sides.unit], np.float64)


def _transfer(form: str, length: float, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Transfer function of a round tail by its line spread's form; half of it within about 0.7."""
    place = 2.0 * np.pi * length * np.abs(frequency)
    if form == "exponential":
        return np.asarray(1.0 / (1.0 + place**2), np.float64)
    if form == "Gaussian":
        return np.asarray(np.exp(-(place**2) / 2.0), np.float64)
    return np.asarray(np.exp(-place / 2.0), np.float64)


def _left(form: str, lengths: float) -> float:
    """Share of a tail's line spread farther away than so many of its lengths."""
    if form == "exponential":
        return math.exp(-lengths)
    if form == "Gaussian":
        return math.erfc(lengths / math.sqrt(2.0))
    return 1.0 - 2.0 / math.pi * math.atan(2.0 * lengths)


def _coarse_waves(
    picture: NDArray[np.floating], factor: int
) -> tuple[Matrix, Matrix, tuple[slice, slice]]:
    """Cosine transform of means of squares of samples, its waves' frequency, and the frame in it.

    Beyond the frame's sides the scene is taken to go on as it is at them.
    """
    from scipy import fft

    rows, columns = (size // factor for size in picture.shape)
    squares = picture[: rows * factor, : columns * factor].reshape(rows, factor, columns, factor)
    beyond = math.ceil(_BEYOND / factor)
    cells = np.pad(squares.mean(axis=(1, 3)), beyond, mode="edge")
    waves = fft.dctn(cells, norm="ortho")
    down, across = (np.arange(size) / (2.0 * size * factor) for size in cells.shape)
    inner = slice(beyond, beyond + rows), slice(beyond, beyond + columns)
    return np.asarray(waves, np.float64), np.hypot(down[:, np.newaxis], across), inner


def _back(waves: Matrix, inner: tuple[slice, slice]) -> Matrix:
    from scipy import fft

    return np.ascontiguousarray(fft.idctn(waves, norm="ortho")[inner], np.float64)


def _between(cells: Matrix, factor: int, x: Vector, y: Vector) -> Vector:
    """Values at places of the picture, linear between the middles of cells."""
    rows, columns = cells.shape
    down = np.clip((y - (factor - 1) / 2.0) / factor, 0.0, rows - 1.0)
    across = np.clip((x - (factor - 1) / 2.0) / factor, 0.0, columns - 1.0)
    return between(cells, down, across)
