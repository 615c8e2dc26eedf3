"""Laying a network out: columns from left to right along its wires."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

from core.editing.layout.boxes import Point, Sizes, size_of
from core.editing.layout.layers import columns_of, components, rows_of
from core.editing.layout.wrapping import Column, wrapped
from core.network.network import Network

COLUMN_GAP, ROW_GAP = 60.0, 40.0

Followers = Mapping[str, tuple[str, ...]]


def arranged(
    network: Network,
    sizes: Sizes,
    only: Collection[str] | None = None,
    room: tuple[float, float] | None = None,
) -> dict[str, Point | None]:
    """Lay nodes out so that every wire leads to the right and no two nodes overlap.

    Parts that no wire joins stand below each other, single nodes in rows under them. The upper left
    corner of what is laid out stays where it was.

    Parameters
    ----------
    network : Network
        What is laid out.
    sizes : mapping
        Width and height of the nodes, in units of the canvas.
    only : collection of str, optional
        Nodes to lay out among themselves; the others stay. All for None.
    room : (width, height), optional
        What the canvas shows. A chain that is longer goes on in the next row, from the left.

    Returns
    -------
    dict of str to point or None
        Where each of them is to stand, for `Move`.
    """
    chosen = {name: None for name in network.nodes if only is None or name in only}
    followers = {
        name: tuple(target for target in network.followers[name] if target in chosen)
        for name in chosen
    }
    return _anchored(network, placed(followers, sizes, room))


def placed(
    followers: Followers, sizes: Sizes, room: tuple[float, float] | None = None
) -> dict[str, Point]:
    """Points for the nodes of a graph; the first part begins at zero."""
    places: dict[str, Point] = {}
    top = 0.0
    parts = components(followers)
    for part in parts:
        if len(part) > 1:
            points = _part({name: followers[name] for name in part}, sizes, room)
            top = _put(places, points, sizes, top)
    singles = [part[0] for part in parts if len(part) == 1]
    if singles:
        _put(places, _grid(singles, sizes), sizes, top)
    return places


def _put(places: dict[str, Point], points: Mapping[str, Point], sizes: Sizes, top: float) -> float:
    """Put a part below the others; where the next one begins."""
    highest = min(y for _, y in points.values())
    places |= {name: (x, y - highest + top) for name, (x, y) in points.items()}
    return max(places[name][1] + size_of(name, sizes)[1] for name in points) + 2 * ROW_GAP


def _part(followers: Followers, sizes: Sizes, room: tuple[float, float] | None) -> dict[str, Point]:
    """The points of nodes that hang together."""
    column = columns_of(followers)
    layers = rows_of(followers, column)
    heights = _heights(followers, column, layers, sizes)
    columns = [
        Column(
            {name: heights[name] for name in layer},
            max((size_of(name, sizes)[0] for name in layer), default=0.0),
            max((heights[name] + size_of(name, sizes)[1] for name in layer), default=0.0),
        )
        for layer in layers
    ]
    return wrapped(columns, room, COLUMN_GAP, 2 * ROW_GAP)


def _heights(
    followers: Followers, column: Mapping[str, int], layers: list[list[str]], sizes: Sizes
) -> dict[str, float]:
    """The upper edge of each node: in one row with what leads to it, as far as there is room.

    A source stands in one row with what it feeds, which the turn before has found a row for.
    """
    leading = _leading(followers, column)
    # Sources come last in their column: they can stand anywhere, a chain cannot.
    layers = [sorted(layer, key=lambda name: name not in leading) for layer in layers]
    heights: dict[str, float] = {}
    for _ in range(2):
        before, heights = heights, {}
        for layer in layers:
            top = -math.inf
            for name in layer:
                wanted = heights.get(leading.get(name, ""))
                if wanted is None and before and followers[name]:
                    wanted = before[min(followers[name], key=column.__getitem__)]
                if wanted is None:
                    wanted = max(top, 0.0)
                heights[name] = max(wanted, top)
                top = heights[name] + size_of(name, sizes)[1] + ROW_GAP
    return heights


def _leading(followers: Followers, column: Mapping[str, int]) -> dict[str, str]:
    """What leads to each node over the shortest way, the first of several."""
    leading: dict[str, str] = {}
    for name, targets in followers.items():
        for target in targets:
            if target not in leading or column[name] > column[leading[target]]:
                leading[target] = name
    return leading


def _grid(names: list[str], sizes: Sizes) -> dict[str, Point]:
    """Rows of about as many nodes as there are rows."""
    across = math.ceil(math.sqrt(len(names)))
    width = max(size_of(name, sizes)[0] for name in names) + COLUMN_GAP
    height = max(size_of(name, sizes)[1] for name in names) + ROW_GAP
    return {
        name: (number % across * width, float(number // across) * height)
        for number, name in enumerate(names)
    }


def _anchored(network: Network, places: Mapping[str, Point]) -> dict[str, Point | None]:
    old = [network.layout[name] for name in places if name in network.layout]
    if not places:
        return {}
    left, top = (min((point[axis] for point in old), default=0.0) for axis in (0, 1))
    x, y = (min(point[axis] for point in places.values()) for axis in (0, 1))
    return {name: (at[0] - x + left, at[1] - y + top) for name, at in places.items()}
