"""Laying out a network with its backdrops: each stays round the nodes that stand on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from core.editing.drawing.backdrops import HEAD, MARGIN, backdrops_of, change, nodes_on
from core.editing.layout.arrange import placed
from core.editing.layout.boxes import Box, Point, Sizes, boxes_of, size_of
from core.editing.nodes import Move
from core.editing.operation import Operation, Together
from core.network.graph import cycles
from core.network.network import Network

_ROWS_IN_STAGE = 2.5
_Members = Mapping[int, tuple[str, ...]]


def laid_out(
    network: Network,
    sizes: Sizes,
    room: tuple[float, float] | None = None,
    drawn: Sizes | None = None,
) -> Operation:
    """Lay all nodes out, those on a backdrop together on it; see `arranged`.

    `drawn` are the sizes with what is drawn below the nodes, which is given room as well. A
    backdrop whose nodes cannot be put together, because a wire leaves it and comes back, is put
    round where its nodes stand then. Empty backdrops stay where they are.
    """
    grounds = backdrops_of(network)
    members = {index: nodes_on(network, index, sizes) for index in range(len(grounds))}
    members = {index: names for index, names in members.items() if names}
    sizes = sizes if drawn is None else drawn
    order = sorted(members, key=lambda index: -grounds[index].width * grounds[index].height)
    places = _places(network, sizes, tuple(network.nodes), order, members, room)
    x, y = _way_back(network, places)
    places = {name: (at[0] + x, at[1] + y) for name, at in places.items()}
    steps: list[Operation] = [Move(dict(places))]
    # The innermost first: an outer one goes round it, too.
    frames: dict[int, Box] = {}
    for index in reversed(order):
        points = {name: places[name] for name in members[index]}
        boxes = list(boxes_of(points, sizes).values())
        boxes += [
            frame for inner, frame in frames.items() if set(members[inner]) <= set(members[index])
        ]
        frames[index] = _round(boxes)
    for index, (left, top, right, bottom) in frames.items():
        ground = replace(grounds[index], x=left, y=top, width=right - left, height=bottom - top)
        if ground != grounds[index]:
            steps.append(change(network, index, ground))
            network = steps[-1].apply(network)
    return Together(steps, "Lay out")


def _places(
    network: Network,
    sizes: Sizes,
    names: Sequence[str],
    order: Sequence[int],
    members: _Members,
    room: tuple[float, float] | None,
) -> dict[str, Point]:
    """Points of these nodes, of which some stand on backdrops: the largest ones first."""
    outer: list[int] = []
    taken: set[str] = set()
    for index in order:
        if not taken & set(members[index]):
            outer.append(index)
            taken |= set(members[index])
    while True:
        unit_of = {name: _key(index) for index in outer for name in members[index]}
        units = list(dict.fromkeys(unit_of.get(name, name) for name in names))
        followers = {unit: tuple(_onward(network, names, unit_of, unit)) for unit in units}
        in_ring = {unit for ring in cycles(followers) for unit in ring}
        broken = [index for index in outer if _key(index) in in_ring]
        if not broken:
            break
        outer = [index for index in outer if index not in broken]
    inside: dict[int, dict[str, Point]] = {}
    unit_sizes = {name: size_of(name, sizes) for name in names}
    for index in outer:
        # Of two that hold the same nodes the larger one holds the other.
        smaller = order[order.index(index) + 1 :]
        within = [inner for inner in smaller if set(members[inner]) <= set(members[index])]
        # A stage is broken up only where it is far too long for a row of its own.
        wide = None if room is None else (_ROWS_IN_STAGE * room[0], room[1])
        points = _places(network, sizes, members[index], within, members, wide)
        depth = 1 + _depth(within, members)
        inside[index] = _set_in(points, depth)
        boxes = boxes_of(inside[index], sizes).values()
        unit_sizes[_key(index)] = (
            max(box[2] for box in boxes) + depth * MARGIN,
            max(box[3] for box in boxes) + depth * MARGIN,
        )
    outside = placed(followers, unit_sizes, room)
    places = {unit: at for unit, at in outside.items() if unit in network.nodes}
    for index, points in inside.items():
        left, top = outside[_key(index)]
        places |= {name: (left + x, top + y) for name, (x, y) in points.items()}
    return places


def _depth(within: Sequence[int], members: _Members) -> int:
    """How many backdrops stand on each other, at most."""
    deepest = 0
    for place, index in enumerate(within):
        inner = [o for o in within[place + 1 :] if set(members[o]) <= set(members[index])]
        deepest = max(deepest, 1 + _depth(inner, members))
    return deepest


def _set_in(points: Mapping[str, Point], depth: int) -> dict[str, Point]:
    """The points with margins and titles at the left and above them."""
    left, top = (min(point[axis] for point in points.values()) for axis in (0, 1))
    x, y = depth * MARGIN - left, depth * (MARGIN + HEAD) - top
    return {name: (at[0] + x, at[1] + y) for name, at in points.items()}


def _onward(
    network: Network, names: Sequence[str], unit_of: Mapping[str, str], unit: str
) -> dict[str, None]:
    chosen = set(names)
    within = [name for name in names if unit_of.get(name, name) == unit]
    return {
        unit_of.get(target, target): None
        for name in within
        for target in network.followers[name]
        if target in chosen and unit_of.get(target, target) != unit
    }


def _round(boxes: list[Box]) -> Box:
    left, top, right, bottom = zip(*boxes, strict=True)
    return min(left) - MARGIN, min(top) - MARGIN - HEAD, max(right) + MARGIN, max(bottom) + MARGIN


def _way_back(network: Network, places: Mapping[str, Point]) -> Point:
    """From the new upper left corner to where it was."""
    old = [network.layout[name] for name in places if name in network.layout]
    if not places:
        return 0.0, 0.0
    was = [min((point[axis] for point in old), default=0.0) for axis in (0, 1)]
    now = [min(point[axis] for point in places.values()) for axis in (0, 1)]
    return was[0] - now[0], was[1] - now[1]


def _key(index: int) -> str:
    return f"\0{index}"  # no node's name: they have no control characters
