"""Room on the canvas: free places for new nodes, and neighbours pushed aside by one put in."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping

from core.editing.layout import Box, Point, Sizes, box_of, boxes_of, hull, size_of
from core.network.network import Network

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
