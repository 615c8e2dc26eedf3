"""Nodes in line, and with equal gaps."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal, get_args

from core.editing.layout.boxes import Point, Sizes, size_of
from core.network.network import Network

Edge = Literal["left", "right", "top", "bottom"]
Way = Literal["across", "down"]
EDGES: tuple[Edge, ...] = get_args(Edge)
WAYS: tuple[Way, ...] = get_args(Way)


def aligned(network: Network, names: Collection[str], sizes: Sizes, edge: Edge) -> dict[str, Point]:
    """Points with which an edge of all nodes is in line with that of the outermost one.

    Parameters
    ----------
    network : Network
        Where they stand; those without a point stay so.
    names : collection of str
        The nodes; with fewer than two nothing is moved.
    sizes : mapping
        Width and height of the nodes.
    edge : "left", "right", "top" or "bottom"
        The edge.
    """
    points = {name: network.layout[name] for name in names if name in network.layout}
    if len(points) < 2:
        return {}
    axis = 0 if edge in ("left", "right") else 1
    far = edge in ("right", "bottom")
    ends = {
        name: at[axis] + (size_of(name, sizes)[axis] if far else 0.0) for name, at in points.items()
    }
    line = max(ends.values()) if far else min(ends.values())
    return {name: _shifted(at, axis, line - ends[name]) for name, at in points.items()}


def distributed(
    network: Network, names: Collection[str], sizes: Sizes, way: Way
) -> dict[str, Point]:
    """Points with which the gaps between the nodes are equal; the outermost two stay.

    Where there is no room for gaps the nodes overlap equally. For the parameters see `aligned`.
    """
    axis = 0 if way == "across" else 1
    points = {name: network.layout[name] for name in names if name in network.layout}
    if len(points) < 2:
        return {}
    order = sorted(points, key=lambda name: points[name][axis])
    extents = [size_of(name, sizes)[axis] for name in order]
    start = points[order[0]][axis]
    end = points[order[-1]][axis] + extents[-1]
    gap = (end - start - sum(extents)) / (len(order) - 1)
    places = {}
    for name, extent in zip(order, extents, strict=True):
        places[name] = _shifted(points[name], axis, start - points[name][axis])
        start += extent + gap
    return places


def _shifted(at: Point, axis: int, by: float) -> Point:
    return (at[0] + by, at[1]) if axis == 0 else (at[0], at[1] + by)
