"""Exit pupils given by geometry: their description, and their samples."""

import math
from collections.abc import Callable
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats
from core.errors import ParameterError
from core.records import dataclass

SHAPES = ("clear", "half_moon", "cassegrain", "hinged", "cassegrain_slit", "spider")
OBSCURED_SHAPES = ("cassegrain", "cassegrain_slit", "spider")
BARRED_SHAPES = ("hinged", "cassegrain_slit")
MOST_VANES = 60


@dataclass(frozen=True)
class PupilShape:
    """A geometric exit pupil, centred on the pupil array; x runs across, y along.

    Parameters
    ----------
    shape : str
        ``clear`` (disc), ``half_moon`` (its half x >= 0), ``cassegrain`` (annulus), ``hinged``
        (disc with the bar), ``cassegrain_slit`` (annulus with the bar) or ``spider`` (annulus
        with vanes). What a shape does not have is ignored.
    radius, obscuration_radius : float
        Outer and inner radius [samples].
    slit_width : float
        Width of the opaque bar abs(x) <= slit_width / 2 over the full height [samples].
    vanes : int
        Number of vanes, from the centre to the rim, at 360°/vanes from +x.
    vane_width : float
        Width of a vane [samples].

    Source: Tantalo 1996, section 4.3.
    """

    shape: str
    radius: float
    obscuration_radius: float = 0.0
    slit_width: float = 0.0
    vanes: int = 0
    vane_width: float = 0.0

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise ParameterError("shape", self.shape, "one of " + ", ".join(SHAPES))
        for name in ("radius", "obscuration_radius", "slit_width", "vane_width"):
            value = float(getattr(self, name))
            object.__setattr__(self, name, value)
            if not (math.isfinite(value) and value >= 0.0):
                raise ParameterError(name, value, "a finite number, 0 or more", unit="samples")
        if self.radius == 0.0:
            raise ParameterError("radius", self.radius, "above 0", unit="samples")
        if self.vanes != int(self.vanes) or not 0 <= self.vanes <= MOST_VANES:
            raise ParameterError("vanes", self.vanes, f"a whole number from 0 to {MOST_VANES}")
        object.__setattr__(self, "vanes", int(self.vanes))
        self._check_opening()

    def _check_opening(self) -> None:
        if self.shape in OBSCURED_SHAPES and self.obscuration_radius >= self.radius:
            allowed = f"below the radius, {self.radius:g} samples"
            value = self.obscuration_radius
            raise ParameterError("obscuration_radius", value, allowed, unit="samples")
        if self.shape in BARRED_SHAPES and self.slit_width >= 2.0 * self.radius:
            allowed = f"below the diameter, {2.0 * self.radius:g} samples"
            raise ParameterError("slit_width", self.slit_width, allowed, unit="samples")
        if self.shape == "spider" and self.vanes > 1:
            widest = 2.0 * self.radius * math.sin(math.pi / self.vanes)
            if self.vane_width >= widest:
                allowed = (
                    f"below {widest:g} samples for {self.vanes} vanes (an opening must remain)"
                )
                raise ParameterError("vane_width", self.vane_width, allowed, unit="samples")

    @property
    def inner_radius(self) -> float:
        """Radius of the central obscuration this shape really has [samples]."""
        return self.obscuration_radius if self.shape in OBSCURED_SHAPES else 0.0

    @property
    def bar_width(self) -> float:
        """Width of the bar this shape really has [samples]."""
        return self.slit_width if self.shape in BARRED_SHAPES else 0.0

    @property
    def vane_count(self) -> int:
        """Number of vanes with a width that this shape really has."""
        return self.vanes if self.shape == "spider" and self.vane_width > 0.0 else 0


def vane_direction(*, index: int, count: int) -> tuple[float, float]:
    """Cosine and sine of the direction of vane `index` of `count`; exact along the axes."""
    quarters = 4 * index / count
    if quarters == int(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    angle = 2.0 * math.pi * index / count
    return math.cos(angle), math.sin(angle)


def sample_pupil(
    shape: PupilShape, *, rows: int, columns: int, oversampling: int = 1
) -> NDArray[np.float64]:
    """Samples of a pupil at the pixel centres: 1 transparent, 0 opaque.

    The array has `rows` × `columns`, each divided by `oversampling`, with the pupil in its middle.
    Pixels are never grey: an autocorrelation squares them, so that area-averaged pixels make
    the normalised OTF worse (error 1/N), not better.
    """
    fine = oversampling
    x = (np.arange(columns * fine) - (columns * fine - 1) / 2.0) / fine
    y = ((np.arange(rows * fine) - (rows * fine - 1) / 2.0) / fine)[:, np.newaxis]
    square = x * x + y * y
    clear = square <= shape.radius**2
    clear &= square >= shape.inner_radius**2
    if shape.shape == "half_moon":
        clear &= x >= 0.0
    if shape.bar_width > 0.0:
        clear &= np.abs(x) > shape.bar_width / 2.0
    for index in range(shape.vane_count):
        cos, sin = vane_direction(index=index, count=shape.vane_count)
        vane = np.abs(cos * y - sin * x) <= shape.vane_width / 2.0
        clear &= ~(vane & (cos * x + sin * y >= 0.0))
    return clear.astype(np.float64)


def edge_offset_samples(
    shape: PupilShape, *, rows: int, columns: int, oversampling: int = 1
) -> float:
    """How far the shape's edges along rows or columns lie from the borders of its samples.

    The largest offset for the arguments of `sample_pupil`, in its samples; 0 without such edges.
    """
    offsets = [0.0]
    rows, columns = rows * oversampling, columns * oversampling
    bar, vane = shape.bar_width * oversampling, shape.vane_width * oversampling
    if shape.shape == "half_moon":
        offsets.append(0.5 * (columns % 2))
    if bar > 0.0:
        offsets.append(_bar_offset(bar, columns))
    count = shape.vane_count
    if count:
        offsets.append(_bar_offset(vane, rows))
    if count % 4 == 0 and count:
        offsets.append(_bar_offset(vane, columns))
    return max(offsets)


def _bar_offset(width: float, size: int) -> float:
    """Half the difference between a centred bar's width and the pixels it covers."""
    places = np.arange(size) - (size - 1) / 2.0
    return abs(float(np.count_nonzero(np.abs(places) <= width / 2.0)) - min(width, size)) / 2.0


# The smallest circle round points, such as the samples of an aperture of unknown outline.

Circle = tuple[float, float, float]
FAINT = 0.01  # of the largest transmission: black as scanners and JPEG leave it, no aperture
_SLACK = 1e-9  # of the radius: points as far outside lie on the circle but for rounding


def support_circle(samples: ArrayLike) -> Circle:
    """Smallest circle round the centres of all samples above 1 % of the largest: x, y and radius.

    The centre is counted from the array's first sample; half a sample is the least radius.
    Edges are known to about half a sample, which leaves the centre of a half disc's circle loose
    by several: where a circle about the array's centre is at most one sample larger, it is that.

    The disc on which Zernike polynomials are orthogonal is the one that just holds the aperture:
    Mahajan 1994, Zernike circle polynomials and optical aberrations of systems with circular
    pupils, Applied Optics 33, 8121. Of a disc, a ring or a half disc it is the outline's own
    circle, of a disc or a ring wherever it lies in the array.
    """
    transmission = np.asarray(samples)
    lit = transmission > FAINT * transmission.max(initial=0.0)
    rows = np.flatnonzero(lit.any(axis=1))
    if len(rows) == 0:
        raise ParameterError("samples", 0, "the pupil must transmit light in at least one sample")
    # Only the first and the last of a row can lie on the circle.
    first = np.argmax(lit[rows], axis=1)
    last = lit.shape[1] - 1 - np.argmax(lit[rows, ::-1], axis=1)
    points = np.column_stack([np.concatenate([first, last]), np.tile(rows, 2)]).astype(float)
    x, y, radius = smallest_circle(points)
    middle_y, middle_x = (lit.shape[0] - 1) / 2, (lit.shape[1] - 1) / 2
    about_middle = float(np.hypot(points[:, 0] - middle_x, points[:, 1] - middle_y).max())
    if about_middle <= radius + 1.0:
        x, y, radius = middle_x, middle_y, about_middle
    return x, y, max(radius, 0.5)


def smallest_circle(points: NDArray[np.float64]) -> Circle:
    """Smallest circle round points, shape (number, 2): centre x, y and radius.

    The farthest point outside joins the two or three that hold the circle, which grows each time.
    Source: Gaertner 1999, Fast and robust smallest enclosing balls, ESA'99, LNCS 1643, 325.
    """
    holding = points[:1]
    while True:
        x, y, radius = _held(holding)
        away = np.hypot(points[:, 0] - x, points[:, 1] - y)
        farthest = int(np.argmax(away))
        if away[farthest] <= radius + _SLACK * (1.0 + radius):
            return x, y, radius
        candidates = np.vstack([holding, points[farthest]])
        holding = _fewest(candidates)


def _fewest(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of at most four points, the last among them, whose circle holds all, the smallest."""
    best, least = points, np.inf
    for count in (2, 3):
        for chosen in combinations(range(len(points)), count):
            x, y, radius = _held(points[list(chosen)])
            away = np.hypot(points[:, 0] - x, points[:, 1] - y).max()
            if away <= radius + _SLACK * (1.0 + radius) and radius < least:
                best, least = points[list(chosen)], radius
    return best


def _held(points: NDArray[np.float64]) -> Circle:
    """Circle through one to three points; of two, that of their distance."""
    if len(points) < 3:
        x, y = points.mean(axis=0)
        return float(x), float(y), float(np.hypot(*(points[0] - (x, y))))
    start, (b, c) = points[0], points[1:] - points[0]
    area = 2.0 * (b[0] * c[1] - b[1] * c[0])
    if area == 0.0:
        return float(start[0]), float(start[1]), -1.0  # on one line: no circle, and none needed
    bb, cc = b @ b, c @ c
    x = (c[1] * bb - b[1] * cc) / area
    y = (b[0] * cc - c[0] * bb) / area
    return float(start[0] + x), float(start[1] + y), float(np.hypot(x, y))


# Pointwise functions evaluated piece by piece, so that what they need stays in the cache.


# Points of a tile. Smaller ones would be quicker on one thread, but two threads then wait for each
# other: half the points take half as long again.
POINTS = 1 << 15
COLUMNS = 1 << 8  # nearly square, so that what holds nowhere in a tile can be left out of it


def by_tiles(function: Callable[..., Floats], *coordinates: Floats) -> Floats:
    """Values of a pointwise function of arrays that broadcast.

    It is given as many arrays of two axes, of which each may have one row or column only.
    """
    shape = np.broadcast_shapes(*(coordinate.shape for coordinate in coordinates))
    if len(shape) == 2:
        arrays = [
            coordinate.reshape((1,) * (2 - coordinate.ndim) + coordinate.shape)
            for coordinate in coordinates
        ]
    else:
        arrays = [np.broadcast_to(coordinate, shape).reshape(1, -1) for coordinate in coordinates]
    values: Floats = np.empty(np.broadcast_shapes(*(array.shape for array in arrays)))
    rows, columns = values.shape
    width = min(columns, max(COLUMNS, POINTS // max(1, rows)))
    height = max(1, POINTS // max(1, width))
    for top in range(0, rows, height):
        for left in range(0, columns, width):
            place = slice(top, top + height), slice(left, left + width)
            values[place] = function(*(part_of(array, place) for array in arrays))
    return values.reshape(shape)


def part_of(values: NDArray[np.float64], place: tuple[slice, slice]) -> NDArray[np.float64]:
    """Rows and columns of an array; of one row or column every one is the same."""
    rows, columns = (
        lines if size > 1 else slice(None) for lines, size in zip(place, values.shape, strict=True)
    )
    return np.asarray(values[rows, columns])
