"""Where nodes stand: columns from left to right along the wires, rows, nodes in line."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import combinations
from typing import Literal, get_args

from core.network.network import Network, reached, topological

Point = tuple[float, float]
Size = tuple[float, float]
Sizes = Mapping[str, Size]
Box = tuple[float, float, float, float]  # left, top, right, bottom
Followers = Mapping[str, Sequence[str]]

FARTHEST = 1e7
"""In units of the canvas; drawn at the largest zoom, it still counts in Qt's 32-bit pixels."""
COLUMN_GAP, ROW_GAP = 60.0, 40.0
GAP_X, GAP_Y = 40.0, 24.0  # left free between a new node and the others
_NODE_SIZE = (180.0, 100.0)  # of a node whose size is not given
_SWEEPS = 6  # more hardly uncross anything
_MOST_ROWS = 64
_GAIN = 1.1  # how much larger all must become for another row


def size_of(name: str, sizes: Sizes) -> Size:
    return sizes.get(name, _NODE_SIZE)


def box_of(at: Point, size: Size) -> Box:
    return at[0], at[1], at[0] + size[0], at[1] + size[1]


def boxes_of(points: Mapping[str, Point], sizes: Sizes) -> dict[str, Box]:
    return {name: box_of(at, size_of(name, sizes)) for name, at in points.items()}


def hull(boxes: Iterable[Box]) -> Box:
    """The smallest box that holds all of these, of which there is one."""
    left, top, right, bottom = zip(*boxes, strict=True)
    return min(left), min(top), max(right), max(bottom)


def shifted(at: Point, by: Point) -> Point:
    return at[0] + by[0], at[1] + by[1]


def shifted_box(box: Box, by: Point) -> Box:
    return (*shifted(box[:2], by), *shifted(box[2:], by))


def is_in_reach(*numbers: float) -> bool:
    """Whether places and sizes lie on the canvas; NaN and infinity do not."""
    return all(-FARTHEST <= number <= FARTHEST for number in numbers)


def arranged(
    network: Network, sizes: Sizes, only: Collection[str] | None = None, room: Size | None = None
) -> dict[str, Point]:
    """Points of all nodes, or those of `only`; their upper left corner stays where it was."""
    chosen = {name: None for name in network.nodes if only is None or name in only}
    followers = {
        name: tuple(target for target in network.followers[name] if target in chosen)
        for name in chosen
    }
    places = placed(followers, sizes, room)
    back = way_back(network, places)
    return {name: shifted(at, back) for name, at in places.items()}


def way_back(network: Network, places: Mapping[str, Point]) -> Point:
    """From the upper left corner of these places to where it was."""
    if not places:
        return 0.0, 0.0
    old = [network.layout[name] for name in places if name in network.layout]
    was = [min((point[axis] for point in old), default=0.0) for axis in (0, 1)]
    now = [min(point[axis] for point in places.values()) for axis in (0, 1)]
    return was[0] - now[0], was[1] - now[1]


def placed(followers: Followers, sizes: Sizes, room: Size | None = None) -> dict[str, Point]:
    """Points for the nodes of a graph: every wire leads to the right, and nothing overlaps.

    Parts that no wire joins stand below each other, single nodes in rows under them. A chain that
    is longer than the `room` that the canvas shows goes on in the next row, from the left.
    """
    parts = _components(followers)
    made = [
        _part({name: followers[name] for name in part}, sizes, room)
        for part in parts
        if len(part) > 1
    ]
    if singles := [part for part in parts if len(part) == 1]:
        heights = dict.fromkeys((name for (name,) in singles), 0.0)
        made.append(_in_rows(singles, heights, sizes, round(math.sqrt(len(singles)))))
    places: dict[str, Point] = {}
    top = 0.0
    for points in made:
        _, highest, _, lowest = hull(boxes_of(points, sizes).values())
        places |= {name: shifted(at, (0.0, top - highest)) for name, at in points.items()}
        top += lowest - highest + 2 * ROW_GAP
    return places


def _components(followers: Followers) -> list[list[str]]:
    """The parts that no link joins, each in the order of the mapping."""
    joined = _neighbours(followers)
    place = {name: number for number, name in enumerate(followers)}
    parts: list[list[str]] = []
    seen: set[str] = set()
    for start in followers:
        if start not in seen:
            part = reached(joined, {start})
            seen |= part
            parts.append(sorted(part, key=place.__getitem__))
    return parts


def _neighbours(followers: Followers) -> dict[str, list[str]]:
    joined: dict[str, list[str]] = {name: [] for name in followers}
    for name, targets in followers.items():
        for target in targets:
            joined[name].append(target)
            joined[target].append(name)
    return joined


def _part(followers: Followers, sizes: Sizes, room: Size | None) -> dict[str, Point]:
    """The points of nodes that hang together, in as many rows as show them largest."""
    column = _columns_of(followers)
    layers = _rows_of(followers, column)
    heights = _heights(followers, column, layers, sizes)
    best = _in_rows(layers, heights, sizes, 1)
    if room is None or (zoom := _zoom(best, sizes, room)) >= 1.0:
        return best
    for number in range(2, min(len(layers), _MOST_ROWS) + 1):
        tried = _in_rows(layers, heights, sizes, number)
        if (larger := _zoom(tried, sizes, room)) > _GAIN * zoom:
            best, zoom = tried, larger
    return best


def _in_rows(
    layers: Sequence[Sequence[str]], heights: Mapping[str, float], sizes: Sizes, number: int
) -> dict[str, Point]:
    """Points of the nodes of columns in so many rows of equally many.

    In several rows all columns are equally wide: a wire to another row goes down in a gap.
    """
    widths = [max(size_of(name, sizes)[0] for name in layer) for layer in layers]
    length = -(-len(layers) // number)
    points: dict[str, Point] = {}
    top = 0.0
    for start in range(0, len(layers), length):
        row = layers[start : start + length]
        highest = min(heights[name] for layer in row for name in layer)
        left, lowest = 0.0, top
        for layer, width in zip(row, widths[start:], strict=False):
            for name in layer:
                points[name] = left, heights[name] - highest + top
                lowest = max(lowest, points[name][1] + size_of(name, sizes)[1])
            left += (width if number == 1 else max(widths)) + COLUMN_GAP
        top = lowest + 2 * ROW_GAP
    return points


def _zoom(points: Mapping[str, Point], sizes: Sizes, room: Size) -> float:
    left, top, right, bottom = hull(boxes_of(points, sizes).values())
    return min(room[0] / max(right - left, 1.0), room[1] / max(bottom - top, 1.0))


def _columns_of(followers: Followers) -> dict[str, int]:
    """The column of each node: behind all that lead to it, sources right before what they feed."""
    order = topological(followers)  # without nodes on a cycle, which stand in the first
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


def _rows_of(followers: Followers, column: Mapping[str, int]) -> list[list[str]]:
    """The nodes of each column from top to bottom, with few crossings.

    Each sweep puts the nodes of a column in the order of the mean height of what they are joined
    to, near wires counting most (the barycentre method of Sugiyama, Tagawa and Toda 1981).
    """
    layers: list[list[str]] = [[] for _ in range(max(column.values()) + 1)]
    for name in followers:
        layers[column[name]].append(name)
    joined = _neighbours(followers)
    height = {name: float(row) for layer in layers for row, name in enumerate(layer)}
    best, fewest = layers, _crossings(followers, column, height)
    for sweep in range(_SWEEPS):
        if not fewest:
            break
        layers = [list(layer) for layer in layers]
        for layer in layers if sweep % 2 == 0 else reversed(layers):
            wanted = {}
            for name in layer:
                ways = {other: max(abs(column[other] - column[name]), 1) for other in joined[name]}
                total = sum(height[other] / way**2 for other, way in ways.items())
                wanted[name] = total / sum(1 / way**2 for way in ways.values())
            layer.sort(key=wanted.__getitem__)  # stable: equal ones keep their order
            height.update({name: float(row) for row, name in enumerate(layer)})
        if (count := _crossings(followers, column, height)) < fewest:
            best, fewest = layers, count
    return best


def _crossings(followers: Followers, column: Mapping[str, int], height: Mapping[str, float]) -> int:
    wires: dict[int, list[tuple[float, float]]] = {}
    for name, targets in followers.items():
        for target in targets:
            if column[target] == column[name] + 1:
                wires.setdefault(column[name], []).append((height[name], height[target]))
    pairs = (pair for ends in wires.values() for pair in combinations(ends, 2))
    return sum((a[0] - b[0]) * (a[1] - b[1]) < 0 for a, b in pairs)


def _heights(
    followers: Followers, column: Mapping[str, int], layers: list[list[str]], sizes: Sizes
) -> dict[str, float]:
    """The upper edge of each node: in one row with what leads to it, as far as there is room."""
    leading: dict[str, str] = {}  # over the shortest way, the first of several
    for name, targets in followers.items():
        for target in targets:
            if target not in leading or column[name] > column[leading[target]]:
                leading[target] = name
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
                    # A source: in one row with what it feeds, as the turn before found it.
                    wanted = before[min(followers[name], key=column.__getitem__)]
                if wanted is None:
                    wanted = max(top, 0.0)
                heights[name] = max(wanted, top)
                top = heights[name] + size_of(name, sizes)[1] + ROW_GAP
    return heights


Edge = Literal["left", "right", "top", "bottom"]
Way = Literal["across", "down"]
EDGES: tuple[Edge, ...] = get_args(Edge)
WAYS: tuple[Way, ...] = get_args(Way)


def aligned(network: Network, names: Collection[str], sizes: Sizes, edge: Edge) -> dict[str, Point]:
    points = {name: network.layout[name] for name in names if name in network.layout}
    if len(points) < 2:
        return {}
    axis = 0 if edge in ("left", "right") else 1
    far = edge in ("right", "bottom")
    ends = {
        name: at[axis] + (size_of(name, sizes)[axis] if far else 0.0) for name, at in points.items()
    }
    line = max(ends.values()) if far else min(ends.values())
    return {name: shifted(at, _way(axis, line - ends[name])) for name, at in points.items()}


def distributed(
    network: Network, names: Collection[str], sizes: Sizes, way: Way
) -> dict[str, Point]:
    """Points with which the gaps between the nodes are equal; the outermost two stay."""
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
        places[name] = shifted(points[name], _way(axis, start - points[name][axis]))
        start += extent + gap
    return places


def _way(axis: int, by: float) -> Point:
    return (by, 0.0) if axis == 0 else (0.0, by)


# Free places for new nodes, and neighbours pushed aside by one put in.


def free_places(
    points: Mapping[str, Point], sizes: Sizes, network: Network, network_sizes: Sizes
) -> dict[str, Point]:
    """The points, moved straight together until they stand on no node of the network."""
    if not points:
        return {}
    there = boxes_of(network.layout, network_sizes).values()
    new = hull(boxes_of(points, sizes).values())
    ways = []
    for axis, gap in enumerate((GAP_X, GAP_Y)):
        for far in (True, False):
            way = 0.0
            for _ in there:  # each time past one of them
                # Of a gap only nearly all counts: rounding would have it end nowhere.
                here = shifted_box(new, _way(axis, way))
                met = [box for box in there if _meet(here, box, 0.999)]
                if far and met:
                    way = min(box[axis + 2] for box in met) + gap - new[axis]
                elif met:
                    way = max(box[axis] for box in met) - gap - new[axis + 2]
            ways.append((abs(way), axis, way))
    _, axis, way = min(ways)
    return {name: shifted(at, _way(axis, way)) for name, at in points.items()}


def made_way(
    network: Network, sizes: Sizes, node: str, at: Point, behind: Collection[str]
) -> dict[str, Point]:
    """The points of a node put in, and of the neighbours that make way for it.

    Nodes that it leads to, `behind`, and those to the right of its middle, go to the right; it goes
    to the right itself of what stands to its left. What goes pushes on what it comes upon.
    """
    others = boxes_of({name: p for name, p in network.layout.items() if name != node}, sizes)
    box = box_of(at, size_of(node, sizes))
    while left := [
        other[2]
        for name, other in others.items()
        if name not in behind and other[0] + other[2] < box[0] + box[2] and _meet(box, other)
    ]:
        box = shifted_box(box, (max(left) + GAP_X - box[0], 0.0))
    pushed = {node: box}
    rest = [node]
    while rest:
        pushing = rest.pop()
        by = pushed[pushing]
        for name, other in others.items():
            now = pushed.get(name, other)
            goes = name in pushed or name in behind or now[2] > by[0]
            way = by[2] + GAP_X - now[0]
            if name != pushing and goes and way > 0 and _meet(by, now):
                pushed[name] = shifted_box(now, (way, 0.0))
                rest.append(name)
    return {name: (b[0], b[1]) for name, b in pushed.items() if network.layout.get(name) != b[:2]}


def _meet(one: Box, other: Box, share: float = 0.5) -> bool:
    """Whether less than that share of a gap is between them."""
    return (
        one[0] < other[2] + GAP_X * share
        and other[0] < one[2] + GAP_X * share
        and one[1] < other[3] + GAP_Y * share
        and other[1] < one[3] + GAP_Y * share
    )
