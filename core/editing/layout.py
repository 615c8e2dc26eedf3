"""Where nodes stand: columns from left to right along the wires, rows, nodes in line."""

from __future__ import annotations

import math
from bisect import bisect_right, insort
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from core.network.network import Network, reached, topological

Point = tuple[float, float]
Size = tuple[float, float]
Sizes = Mapping[str, Size]
Box = tuple[float, float, float, float]  # left, top, right, bottom

_NODE_SIZE = (180.0, 100.0)  # of a node whose size is not given


def size_of(name: str, sizes: Sizes) -> Size:
    """Width and height of a node, by its id."""
    return sizes.get(name, _NODE_SIZE)


def box_of(at: Point, size: Size) -> Box:
    """What a node of that size takes up at a point."""
    return at[0], at[1], at[0] + size[0], at[1] + size[1]


def boxes_of(points: Mapping[str, Point], sizes: Sizes) -> dict[str, Box]:
    """What every node with a point takes up."""
    return {name: box_of(at, size_of(name, sizes)) for name, at in points.items()}


def hull(boxes: Iterable[Box]) -> Box:
    """The smallest box that holds all of these, of which there is one."""
    left, top, right, bottom = zip(*boxes, strict=True)
    return min(left), min(top), max(right), max(bottom)


FARTHEST = 1e7
"""In units of the canvas; drawn at the largest zoom, it still counts in Qt's 32-bit pixels."""


def is_in_reach(*numbers: float) -> bool:
    """Whether places and sizes lie on the canvas; NaN and infinity do not."""
    return all(-FARTHEST <= number <= FARTHEST for number in numbers)


Followers = Mapping[str, Sequence[str]]

_SWEEPS = 6  # more hardly uncross anything


def components(followers: Followers) -> list[list[str]]:
    """The parts that no link joins, each in the order of the mapping."""
    joined: dict[str, list[str]] = {name: [] for name in followers}
    for name, targets in followers.items():
        for target in targets:
            joined[name].append(target)
            joined[target].append(name)
    place = {name: number for number, name in enumerate(followers)}
    parts: list[list[str]] = []
    seen: set[str] = set()
    for start in followers:
        if start not in seen:
            part = reached(joined, {start})
            seen |= part
            parts.append(sorted(part, key=place.__getitem__))
    return parts


def columns_of(followers: Followers) -> dict[str, int]:
    """The column of each node: behind all that lead to it, sources right before what they feed.

    Nodes on a cycle, which no sound network has, stand in the first.
    """
    order = topological(followers)
    column = dict.fromkeys(followers, 0)
    fed = set()
    for name in order:
        for target in followers[name]:
            column[target] = max(column[target], column[name] + 1)
            fed.add(target)
    for name in order:
        if name not in fed and followers[name]:
            column[name] = max(min(column[target] for target in followers[name]) - 1, 0)
    return column


def rows_of(followers: Followers, column: Mapping[str, int]) -> list[list[str]]:
    """The nodes of each column from top to bottom, with few crossings.

    Each sweep puts the nodes of a column in the order of the mean height of what they are joined
    to, near wires counting most (the barycentre method of Sugiyama, Tagawa and Toda 1981).
    """
    layers: list[list[str]] = [[] for _ in range(max(column.values(), default=-1) + 1)]
    for name in followers:
        layers[column[name]].append(name)
    joined = neighbours(followers, column)
    height = {name: float(row) for layer in layers for row, name in enumerate(layer)}
    best, fewest = layers, crossings(followers, column, height)
    for sweep in range(_SWEEPS):
        if not fewest:
            break
        layers = [list(layer) for layer in layers]
        for layer in layers if sweep % 2 == 0 else reversed(layers):
            wanted = {name: _mean(joined[name], height, height[name]) for name in layer}
            layer.sort(key=wanted.__getitem__)  # stable: equal ones keep their order
            height.update({name: float(row) for row, name in enumerate(layer)})
        count = crossings(followers, column, height)
        if count < fewest:
            best, fewest = layers, count
    return best


def neighbours(
    followers: Followers, column: Mapping[str, int]
) -> dict[str, list[tuple[str, float]]]:
    """What each node is joined to, and how much that counts: less the longer the wire."""
    weighted: dict[str, list[tuple[str, float]]] = {name: [] for name in followers}
    for name, targets in followers.items():
        for target in targets:
            weight = 1.0 / max(abs(column[target] - column[name]), 1) ** 2
            weighted[name].append((target, weight))
            weighted[target].append((name, weight))
    return weighted


def crossings(followers: Followers, column: Mapping[str, int], height: Mapping[str, float]) -> int:
    """How many pairs of wires between neighbouring columns cross."""
    wires: dict[int, list[tuple[float, float]]] = {}
    for name, targets in followers.items():
        for target in targets:
            if column[target] == column[name] + 1:
                wires.setdefault(column[name], []).append((height[name], height[target]))
    return sum(_inversions([end for _, end in sorted(pairs)]) for pairs in wires.values())


def _inversions(values: list[float]) -> int:
    """Pairs in the wrong order."""
    count, before = 0, list[float]()
    for value in values:
        count += len(before) - bisect_right(before, value)
        insort(before, value)
    return count


def _mean(
    joined: Sequence[tuple[str, float]], height: Mapping[str, float], default: float
) -> float:
    total = sum(weight for _, weight in joined)
    if not total:
        return default
    return sum(height[name] * weight for name, weight in joined) / total


_MOST_ROWS = 64
COLUMN_GAP, ROW_GAP = 60.0, 40.0
_GAIN = 1.1  # how much larger all must become for another row


@dataclass(frozen=True)
class _Column:
    """Nodes above each other: their upper edges by name, the width, the lowest edge of all."""

    tops: Mapping[str, float]
    width: float
    bottom: float

    @property
    def top(self) -> float:
        return min(self.tops.values(), default=0.0)


def _wrapped(columns: Sequence[_Column], room: tuple[float, float] | None) -> dict[str, Point]:
    """Points of the nodes, the columns in as many rows as show them largest.

    What fits the room stays in one row. In several rows all columns are equally wide, so that the
    gaps between them stand below each other: a wire to another row goes down in one.
    """
    rows = [list(columns)]
    best = _extent(rows, None)
    pitch: float | None = None
    if room is not None and not (best[0] <= room[0] and best[1] <= room[1]):
        even = max(column.width for column in columns) + COLUMN_GAP
        for number in range(2, min(len(columns), _MOST_ROWS) + 1):
            # In rows of as equal numbers of columns as can be, the first ones the longest.
            length = -(-len(columns) // number)
            tried = [list(columns[at : at + length]) for at in range(0, len(columns), length)]
            extent = _extent(tried, even)
            if _zoom(extent, room) > _GAIN * _zoom(best, room):
                rows, best, pitch = tried, extent, even
    points: dict[str, Point] = {}
    top = 0.0
    for row in rows:
        highest = min(column.top for column in row) if pitch is not None else 0.0
        left = 0.0
        for column in row:
            points |= {name: (left, y - highest + top) for name, y in column.tops.items()}
            left += column.width + COLUMN_GAP if pitch is None else pitch
        top += _height(row) + 2 * ROW_GAP
    return points


def _extent(rows: Sequence[Sequence[_Column]], pitch: float | None) -> tuple[float, float]:
    """Width and height; `pitch` is that of the columns where they are equally wide."""
    widths = [sum(pitch or column.width + COLUMN_GAP for column in row) for row in rows]
    return max(widths), sum(_height(row) + 2 * ROW_GAP for row in rows) - 2 * ROW_GAP


def _height(row: Sequence[_Column]) -> float:
    return max(column.bottom for column in row) - min(column.top for column in row)


def _zoom(extent: tuple[float, float], room: tuple[float, float]) -> float:
    """How large all can be drawn."""
    return min(room[0] / max(extent[0], 1.0), room[1] / max(extent[1], 1.0))


def arranged(
    network: Network,
    sizes: Sizes,
    only: Collection[str] | None = None,
    room: tuple[float, float] | None = None,
) -> dict[str, Point]:
    """Lay nodes out so that every wire leads to the right and no two nodes overlap.

    Parts that no wire joins stand below each other, single nodes in rows under them. The upper left
    corner of what is laid out stays where it was. Only those of `only`, if given, are laid out. A
    chain that is longer than the `room` that the canvas shows goes on in the next row, from the
    left.
    """
    chosen = {name: None for name in network.nodes if only is None or name in only}
    followers = {
        name: tuple(target for target in network.followers[name] if target in chosen)
        for name in chosen
    }
    places = placed(followers, sizes, room)
    x, y = way_back(network, places)
    return {name: (at[0] + x, at[1] + y) for name, at in places.items()}


def way_back(network: Network, places: Mapping[str, Point]) -> Point:
    """From the upper left corner of these places to where it was."""
    if not places:
        return 0.0, 0.0
    old = [network.layout[name] for name in places if name in network.layout]
    was = [min((point[axis] for point in old), default=0.0) for axis in (0, 1)]
    now = [min(point[axis] for point in places.values()) for axis in (0, 1)]
    return was[0] - now[0], was[1] - now[1]


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
        _Column(
            {name: heights[name] for name in layer},
            max((size_of(name, sizes)[0] for name in layer), default=0.0),
            max((heights[name] + size_of(name, sizes)[1] for name in layer), default=0.0),
        )
        for layer in layers
    ]
    return _wrapped(columns, room)


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


Edge = Literal["left", "right", "top", "bottom"]
Way = Literal["across", "down"]
EDGES: tuple[Edge, ...] = get_args(Edge)
WAYS: tuple[Way, ...] = get_args(Way)


def aligned(network: Network, names: Collection[str], sizes: Sizes, edge: Edge) -> dict[str, Point]:
    """Points with which an edge of the nodes is in line with that of the outermost one.

    Nodes without a point stay so; with fewer than two nothing is moved.
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


# Free places for new nodes, and neighbours pushed aside by one put in.


GAP_X, GAP_Y = 40.0, 24.0  # left free between a new node and the others
_MOST_NEAR = 60  # of ranges whose edges are combined
_MOST_APART = 6  # of new nodes that are looked at one by one, more as one


def free_places(
    points: Mapping[str, Point], sizes: Sizes, network: Network, network_sizes: Sizes
) -> dict[str, Point]:
    """The points, moved together by as little as is needed to stand on no node of the network.

    `sizes` are those of the new nodes. Nodes of the network without a point take up no room.
    """
    there = boxes_of(network.layout, network_sizes)
    new = list(boxes_of(points, sizes).values())
    if len(new) > _MOST_APART:
        new = [hull(new)]
    x, y = _least_way([_shift_range(a, b) for a in new for b in there.values()])
    return {name: (at[0] + x, at[1] + y) for name, at in points.items()}


def made_way(
    network: Network, sizes: Sizes, node: str, at: Point, behind: Collection[str]
) -> dict[str, Point]:
    """The points of a node put in, and of the neighbours that make way for it.

    Nodes that it leads to, `behind`, and those to the right of its middle, go to the right; it goes
    to the right itself of what stands to its left. What goes pushes on what it comes upon:
    afterwards it stands on nothing, and nothing that was pushed does. Those that stand there
    already are left out.
    """
    others = boxes_of({name: p for name, p in network.layout.items() if name != node}, sizes)
    box = box_of(at, size_of(node, sizes))
    x = box[0]
    while left := [
        other
        for name, other in others.items()
        if name not in behind
        and other[0] + other[2] < 2 * x + box[2] - box[0]
        and _meet(_moved(box, x), other)
    ]:
        x = max(other[2] for other in left) + GAP_X
    pushed = {node: _moved(box, x)}
    rest = [node]
    while rest:
        pushing = rest.pop()
        by = pushed[pushing]
        for name, other in others.items():
            now = pushed.get(name, other)
            if (
                name != pushing
                and _meet(by, now)
                and (name in pushed or name in behind or now[2] > by[0])
            ):
                aside = by[2] + GAP_X
                if aside > now[0]:
                    pushed[name] = _moved(now, aside)
                    rest.append(name)
    return {name: (b[0], b[1]) for name, b in pushed.items() if network.layout.get(name) != b[:2]}


def _moved(box: Box, left: float) -> Box:
    return left, box[1], left + box[2] - box[0], box[3]


def _meet(one: Box, other: Box) -> bool:
    """Whether less than half a gap is between them."""
    return (
        one[0] < other[2] + GAP_X / 2
        and other[0] < one[2] + GAP_X / 2
        and one[1] < other[3] + GAP_Y / 2
        and other[1] < one[3] + GAP_Y / 2
    )


def _shift_range(new: Box, there: Box) -> Box:
    """The shifts of the new box with which the two would be nearer than the gap."""
    return (
        there[0] - GAP_X - new[2],
        there[1] - GAP_Y - new[3],
        there[2] + GAP_X - new[0],
        there[3] + GAP_Y - new[1],
    )


def _least_way(closed: list[Box]) -> Point:
    """The least shift that lies in none of these boxes.

    It is on the edges of two of them, or straight across from where the new nodes are wanted; where
    very many are near, only the latter are looked at.
    """
    if not _inside((0.0, 0.0), closed):
        return 0.0, 0.0
    straight = [
        (0.0, _first_free([(b[1], b[3]) for b in closed if b[0] < 0 < b[2]])),
        (_first_free([(b[0], b[2]) for b in closed if b[1] < 0 < b[3]]), 0.0),
        (0.0, -_first_free([(-b[3], -b[1]) for b in closed if b[0] < 0 < b[2]])),
        (-_first_free([(-b[2], -b[0]) for b in closed if b[1] < 0 < b[3]]), 0.0),
    ]
    best = min(straight, key=_length)
    reach = _length(best)
    near = [b for b in closed if max(b[0], b[1], -b[2], -b[3]) < reach]
    if len(near) > _MOST_NEAR:
        return best
    for x in (x for b in near for x in (b[0], b[2])):
        for y in (y for b in near for y in (b[1], b[3])):
            if _length((x, y)) < _length(best) and not _inside((x, y), near):
                best = (x, y)
    return best


def _first_free(closed: list[tuple[float, float]]) -> float:
    """The first number from zero up that is within none of the ranges."""
    free = 0.0
    for low, high in sorted(closed):
        if low >= free and low >= 0:
            break
        free = max(free, high)
    return free


def _length(way: Point) -> float:
    return math.hypot(*way)


def _inside(point: Point, boxes: Iterable[Box]) -> bool:
    x, y = point
    return any(b[0] < x < b[2] and b[1] < y < b[3] for b in boxes)
