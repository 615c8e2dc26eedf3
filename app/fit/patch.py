"""The samples about one edge, as the fit takes them."""

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from core.physics.measurement.found_edge import FoundEdge, edge_samples

# The part of a picture about an edge.

Matrix = NDArray[np.float64]

MARGIN = 32  # samples about an edge, beyond which nothing is looked at


@dataclass(frozen=True)
class Window:
    """A part of a picture; beyond its frame the nearest samples stand."""

    samples: Matrix  # shape (rows, columns)
    # row and column of the first sample in the picture
    top: int
    left: int


def window_about(*, picture: Matrix, edge: FoundEdge) -> Window:
    """The picture about an edge, a margin wide, in a shape that is good to transform."""
    (x1, y1), (x2, y2) = edge.ends
    wide = edge.reach + MARGIN
    first, count = [], []
    for one, other in ((y1, y2), (x1, x2)):
        start = math.floor(min(one, other) - wide)
        first.append(start)
        count.append(scipy.fft.next_fast_len(math.ceil(max(one, other) + wide) + 1 - start, True))
    rows, columns = (
        np.clip(start + np.arange(many), 0, length - 1)
        for start, many, length in zip(first, count, picture.shape, strict=True)
    )
    samples = np.asarray(picture[np.ix_(rows, columns)], np.float64)
    return Window(samples, first[0], first[1])


Vector = NDArray[np.float64]
Indices = NDArray[np.intp]

_NARROW, _WIDTHS = 5.0, 2.5  # samples, and widths of the step: the fit's reach on both sides
_LEAST_REACH = 8.0  # samples
_ENDS, _END_SHARE = 6.0, 0.15  # samples, or of the length: what is left off where corners round it
_OUTER = 0.6  # of the reach, beyond which a side counts as level
_SHADED = 4.0  # standard errors, from which on a slope of a side counts
_LEAST_OUTER = 12  # samples on a level side
_FAINT = 1e-4  # of the contrast: a noise that is less is that of rounding in a file


@dataclass(frozen=True)
class Patch:
    name: str  # for people: where the edge is
    edge: FoundEdge
    # of each sample: distance along the edge's normal, place along the edge, sample
    distance: Vector
    along: Vector
    value: Vector
    # where each sample is in its picture
    column: Indices
    row: Indices
    window: Window  # the picture about the edge
    # of a sample's noise on each side
    low_variance: float
    high_variance: float
    # levels of the sides
    low: float
    high: float
    shaded: bool  # whether the sides are not level
    least_variance: float  # what rounding in the file alone makes

    @property
    def reach(self) -> float:
        return float(np.abs(self.distance).max())

    def thinned(self, most: int) -> "Patch":
        """With no more samples than that, taken evenly over their distances."""
        if len(self.value) <= most:
            return self
        order = np.argsort(self.distance, kind="stable")
        taken = order[np.linspace(0, len(order) - 1, most).astype(np.intp)]
        return replace(
            self,
            distance=self.distance[taken],
            along=self.along[taken],
            value=self.value[taken],
            column=self.column[taken],
            row=self.row[taken],
        )


def patch_of(*, picture: Matrix, edge: FoundEdge, name: str) -> Patch | str:
    """The patch of an edge's samples; or why they are no use.

    The noise is that of the sides far from the edge, about a plane of their own. Of the rest what
    lies near the edge counts, without its ends.
    """
    samples = edge_samples(picture=picture, edge=edge)
    distance, along, value = samples.distance, samples.along, samples.value
    reach = float(np.abs(distance).max(initial=0.0))
    half = float(np.abs(along).max(initial=0.0))
    middle = np.abs(along) <= half - min(_ENDS, 2.0 * half * _END_SHARE)
    sides = [middle & (distance < -_OUTER * reach), middle & (distance > _OUTER * reach)]
    if min(int(np.count_nonzero(side)) for side in sides) < _LEAST_OUTER:
        return "too few samples on one side"
    levels, variances, shaded = [], [], False
    for side in sides:
        d, s, v = distance[side], along[side], value[side]
        plane = np.column_stack([np.ones(len(v)), d - d.mean(), s - s.mean()])
        solution, *_ = np.linalg.lstsq(plane, v, rcond=None)
        rest = v - plane @ solution
        variance = float(rest @ rest) / max(1, len(v) - 3)
        levels.append(float(solution[0]))
        variances.append(variance)
        errors = np.sqrt(variance / np.maximum((plane**2).sum(axis=0), 1e-300))
        shaded = shaded or bool(np.any(np.abs(solution[1:]) > _SHADED * errors[1:] + 1e-300))
    contrast = levels[1] - levels[0]
    if contrast <= 0.0:
        return "no contrast"
    # In a file of whole numbers a level side may have no noise at all, and rounds to one number.
    rounded = np.array_equal(value, np.rint(value))
    least = max((_FAINT * contrast) ** 2, 1.0 / 12.0 if rounded else 0.0)
    width = _width(distance, value, (levels[0], levels[1]))
    near = middle & (np.abs(distance) <= max(_LEAST_REACH, _NARROW + _WIDTHS * width))
    return Patch(
        name, edge, distance[near], along[near], value[near],
        *_places(edge, distance[near], along[near]), window_about(picture=picture, edge=edge),
        max(variances[0], least), max(variances[1], least), levels[0], levels[1],
        shaded and min(variances) > least, least,
    )  # fmt: skip


def curvature(edge: FoundEdge) -> float:
    """Samples by which an edge is off its tangent, over the square of the place along it."""
    return edge.bend / (edge.length / 2.0) ** 2


def _places(edge: FoundEdge, distance: Vector, along: Vector) -> tuple[Indices, Indices]:
    """Columns and rows of the samples, from where they lie about the edge."""
    across, down = edge.normal
    off = distance + curvature(edge) * along**2
    x, y = edge.x + off * across - along * down, edge.y + off * down + along * across
    return np.rint(x).astype(np.intp), np.rint(y).astype(np.intp)


def _width(distance: Vector, value: Vector, levels: tuple[float, float]) -> float:
    """Samples from a tenth to nine tenths of the step, of means over a sample's distance."""
    place = np.floor(distance).astype(np.intp)
    first = int(place.min())
    count = np.bincount(place - first)
    mean = np.bincount(place - first, value) / np.maximum(count, 1)
    share = (mean - levels[0]) / (levels[1] - levels[0])
    inside = np.flatnonzero((share > 0.1) & (share < 0.9) & (count > 0))
    return float(inside[-1] - inside[0] + 1) if len(inside) else 1.0
