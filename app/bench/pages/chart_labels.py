"""Words beside the points they name, where they hide the least."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Place = tuple[float, float, str, str]
MARK_PX = 9.0  # half a mark's width, with some room
# Where a word may stand about its point: direction, and which of its edges is nearest.
PLACES: tuple[Place, ...] = (
    (1, 0, "left", "center"),
    (-1, 0, "right", "center"),
    (0, 1, "center", "bottom"),
    (0, -1, "center", "top"),
    (0.75, 0.75, "left", "bottom"),
    (0.75, -0.75, "left", "top"),
    (-0.75, 0.75, "right", "bottom"),
    (-0.75, -0.75, "right", "top"),
)
DISTANCES = (8.0, 16.0, 26.0)  # points
OUTSIDE, ON_LINE, FARTHER = 50.0, 0.15, 0.02  # costs beside one for a word wholly hidden


@dataclass(frozen=True)
class Label:
    """A word and the points, in data coordinates, that it may stand beside."""

    text: str
    anchors: tuple[tuple[float, float], ...]
    colour: str
    bold: bool = False


def place_labels(
    axis: Any,
    labels: Sequence[Label],
    points: Sequence[tuple[float, float]],
    lines: Sequence[Array],
    texts: Sequence[Any],
    size: float,
) -> None:
    """Write each word at the free place nearest to its point; limits and scales must be final.

    Parameters
    ----------
    axis : matplotlib axes
        Drawn upon.
    labels : sequence of Label
        In the order in which they choose.
    points : sequence of (x, y)
        Marks to keep clear.
    lines : sequence of ndarray, shape (places, 2)
        Polygons of curves to keep clear where possible.
    texts : sequence of matplotlib artists
        Written before, to keep clear.
    size : float
        Of the letters, points.
    """
    canvas = axis.figure.canvas
    axis.figure.draw_without_rendering()  # settles the layout
    renderer = canvas.get_renderer()
    marks = axis.transData.transform(np.asarray(points, float).reshape(-1, 2))
    taken = [np.array([x - MARK_PX, y - MARK_PX, x + MARK_PX, y + MARK_PX]) for x, y in marks]
    taken += [np.array(text.get_window_extent(renderer).extents) for text in texts]
    along = [_dense(axis.transData.transform(line)) for line in lines if len(line) > 1]
    curve = np.concatenate(along) if along else np.empty((0, 2))
    frame = axis.get_window_extent(renderer).extents
    for label in labels:
        word = _word(axis, label, label.anchors[0], PLACES[0], 0.0, size)
        extent = word.get_window_extent(renderer)
        word.remove()
        tried: list[tuple[Any, ...]] = []
        for anchor, distance, place in product(label.anchors, DISTANCES, PLACES):
            start = axis.transData.transform(anchor)
            box = _box(start, place, distance * axis.figure.dpi / 72, extent.width, extent.height)
            cost = _cost(box, taken, curve, frame) + FARTHER * DISTANCES.index(distance)
            tried.append((cost, len(tried), anchor, place, distance, box))
        *_, anchor, place, distance, box = min(tried, key=lambda candidate: candidate[:2])
        _word(axis, label, anchor, place, distance, size)
        taken.append(box)


def most_apart(
    axis: Any, own: Sequence[tuple[float, float]], others: Sequence[tuple[float, float]]
) -> tuple[tuple[float, float], ...]:
    """The two of a curve's points that are farthest from those of other curves, as drawn."""
    if not others:
        return (own[-1], own[0])
    here = axis.transData.transform(np.asarray(own, float))
    there = axis.transData.transform(np.asarray(others, float))
    nearest = np.hypot(*(here[:, np.newaxis] - there[np.newaxis]).T).min(axis=0)
    return tuple(own[index] for index in np.argsort(-nearest, kind="stable")[:2])


def _word(
    axis: Any,
    label: Label,
    anchor: tuple[float, float],
    place: Place,
    distance: float,
    size: float,
) -> Any:
    right, up, horizontal, vertical = place
    word = axis.annotate(
        label.text,
        anchor,
        xytext=(right * distance, up * distance),
        textcoords="offset points",
        ha=horizontal,
        va=vertical,
        color=label.colour,
        fontsize=size,
        fontweight="bold" if label.bold else "normal",
    )
    word.set_in_layout(False)
    return word


def _box(start: Array, place: Place, distance: float, width: float, height: float) -> Array:
    """Left, bottom, right and top of a word of that size, all in pixels."""
    right, up, horizontal, vertical = place
    before = {"left": 0.0, "center": 0.5, "right": 1.0}[horizontal] * width
    below = {"bottom": 0.0, "center": 0.5, "top": 1.0}[vertical] * height
    left, bottom = start[0] + right * distance - before, start[1] + up * distance - below
    return np.array([left, bottom, left + width, bottom + height])


def _cost(box: Array, taken: Sequence[Array], curve: Array, frame: Array) -> float:
    area = (box[2] - box[0]) * (box[3] - box[1])
    hidden = sum(_overlap(box, other) for other in taken) / area
    outside = 1.0 - _overlap(box, frame) / area
    inside = np.all((curve >= box[:2] - 2) & (curve <= box[2:] + 2), axis=1)
    return float(hidden + OUTSIDE * outside + ON_LINE * bool(inside.any()))


def _overlap(one: Array, other: Array) -> float:
    low, high = np.maximum(one[:2], other[:2]), np.minimum(one[2:], other[2:])
    return float(np.prod(np.maximum(high - low, 0.0)))


def _dense(line: Array) -> Array:
    """Places along a polygon, close enough that no word fits between two of them."""
    steps = np.linspace(0.0, 1.0, 120)[:, np.newaxis]
    return np.concatenate([start + steps * (end - start) for start, end in pairwise(line)])
