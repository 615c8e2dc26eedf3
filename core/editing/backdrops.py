"""Backdrops: titled grounds behind nodes that belong together, moved in the network's file.

Laying a network out keeps each round the nodes that stand on it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from core.editing.layout import (
    Box,
    Point,
    Sizes,
    boxes_of,
    hull,
    is_in_reach,
    placed,
    size_of,
    way_back,
)
from core.editing.operations import ABSENT, Move, Operation, Together, set_network_field
from core.errors import NetworkError
from core.names import thaw
from core.network.network import Network, cycles

FIELD = "backdrops"
NOTE = "note"  # of the field `kind`; a program that does not know it shows a backdrop
MARGIN, HEAD = 24.0, 30.0  # moved free round the nodes, and for the title


@dataclass(frozen=True)
class Backdrop:
    """A ground with a title: its upper left corner and size, in units of the canvas.

    A note is one whose title is a text that fills it, and on which nothing stands. `colour` is a
    name that the editor knows.
    """

    title: str
    x: float
    y: float
    width: float
    height: float
    note: bool = False
    colour: str = ""


def backdrops_of(network: Network) -> tuple[Backdrop, ...]:
    """The network's backdrops, the hindmost first. What a file has in their place is no backdrop.

    Neither is one out of the canvas's reach. Their places in this tuple are what `change`,
    `remove` and `nodes_on` call `index`.
    """
    return tuple(backdrop for _, backdrop in _indexed(network))


def add(network: Network, backdrop: Backdrop) -> Operation:
    """Put a backdrop before the others."""
    entries = [*_entries(network), _entry({}, backdrop)]
    return set_network_field(FIELD, entries, "Add backdrop")


def change(network: Network, index: int, backdrop: Backdrop) -> Operation:
    """Give a backdrop another title, place, size or colour; what else the file has of it stays.

    Raises `NetworkError` if there is no such backdrop.
    """
    entries = _entries(network)
    place = _place(network, index)
    entries[place] = _entry(entries[place], backdrop)
    return set_network_field(FIELD, entries, "Change backdrop")


def remove(network: Network, index: int) -> Operation:
    """Take a backdrop away; the nodes on it stay.

    Raises `NetworkError` if there is no such backdrop.
    """
    entries = _entries(network)
    del entries[_place(network, index)]
    return set_network_field(FIELD, entries or ABSENT, "Delete backdrop")


def around(
    network: Network, names: Iterable[str], sizes: Sizes, title: str = "Backdrop"
) -> Operation:
    """Put a backdrop behind nodes; a `NetworkError` if none of them has a point."""
    boxes = _boxes(network, names, sizes).values()
    if not boxes:
        raise NetworkError("select the nodes for the backdrop first")
    left, top, right, bottom = hull(boxes)
    width, height = right - left + 2 * MARGIN, bottom - top + 2 * MARGIN + HEAD
    return add(network, Backdrop(title, left - MARGIN, top - MARGIN - HEAD, width, height))


def nodes_on(network: Network, index: int, sizes: Sizes) -> tuple[str, ...]:
    """The nodes that lie wholly on a backdrop, and move with it.

    Raises `NetworkError` if there is no such backdrop.
    """
    _place(network, index)
    ground = backdrops_of(network)[index]
    if ground.note:
        return ()
    right, bottom = ground.x + ground.width, ground.y + ground.height
    return tuple(
        name
        for name, box in _boxes(network, network.nodes, sizes).items()
        if ground.x <= box[0] and ground.y <= box[1] and box[2] <= right and box[3] <= bottom
    )


def following(network: Network, places: Mapping[str, Point], sizes: Sizes) -> Operation | None:
    """Let backdrops keep the nodes that lie on them where some are pushed to the right.

    `places` are where. A backdrop whose nodes all go the same way goes with them. Any other grows:
    it reaches from its first node to its last. None where none has to change.
    """
    entries, changed = _entries(network), False
    for index, (place, ground) in enumerate(_indexed(network)):
        names = nodes_on(network, index, sizes)
        ways = {
            name: places[name][0] - network.layout[name][0] if name in places else 0.0
            for name in names
        }
        if not any(ways.values()):
            continue
        if len(set(ways.values())) == 1:
            moved = replace(ground, x=ground.x + ways[names[0]])
        else:
            boxes = _boxes(network, names, sizes)
            rights = {name: box[2] for name, box in boxes.items()}
            lefts = {name: box[0] for name, box in boxes.items()}
            # Its left edge follows its first node: it would lie over the backdrop before it.
            x = ground.x + min(lefts[n] + way for n, way in ways.items()) - min(lefts.values())
            margin = min(MARGIN, ground.x + ground.width - max(rights.values()))
            right = max(rights[name] + way for name, way in ways.items()) + margin
            right = max(right, ground.x + ground.width)
            moved = replace(ground, x=x, width=right - x)
        if moved != ground:
            entries[place] = _entry(entries[place], moved)
            changed = True
    return set_network_field(FIELD, entries, "Move backdrops") if changed else None


def _boxes(network: Network, names: Iterable[str], sizes: Sizes) -> dict[str, Box]:
    points = {name: network.layout[name] for name in names if name in network.layout}
    return boxes_of(points, sizes)


def _entries(network: Network) -> list[Any]:
    entries = thaw(network.extra.get(FIELD, []))
    return entries if isinstance(entries, list) else []


def _indexed(network: Network) -> list[tuple[int, Backdrop]]:
    """Backdrops, with their places in the file's list."""
    read = ((place, _backdrop(entry)) for place, entry in enumerate(_entries(network)))
    return [(place, backdrop) for place, backdrop in read if backdrop is not None]


def _place(network: Network, index: int) -> int:
    backdrops = _indexed(network)
    if not 0 <= index < len(backdrops):
        raise NetworkError(f"there is no backdrop {index + 1}; there are {len(backdrops)}")
    return backdrops[index][0]


def _backdrop(entry: Any) -> Backdrop | None:
    if not isinstance(entry, dict):
        return None
    title = entry.get("title", "")
    numbers = [entry.get(name) for name in ("x", "y", "width", "height")]
    if not isinstance(title, str) or not all(_is_number(number) for number in numbers):
        return None
    x, y, width, height = (float(number) for number in numbers if number is not None)
    if not (width > 0 and height > 0 and is_in_reach(x, y, width, height)):
        return None
    colour = entry.get("colour")
    tint = colour if isinstance(colour, str) else ""
    return Backdrop(title, x, y, width, height, entry.get("kind") == NOTE, tint)


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _entry(old: Mapping[str, Any], backdrop: Backdrop) -> dict[str, Any]:
    values = {name: getattr(backdrop, name) for name in ("x", "y", "width", "height")}
    for name, value in values.items():
        if not _is_number(value) or (name in ("width", "height") and value <= 0):
            raise NetworkError(f"a backdrop cannot have {name} = {value!r:.80}")
    whole = {name: int(v) if v == int(v) else v for name, v in values.items()}
    made = {**old, "title": backdrop.title, **whole}
    for name, value in (("kind", NOTE if backdrop.note else ""), ("colour", backdrop.colour)):
        if value:
            made[name] = value
        elif name == "colour" or made.get(name) == NOTE:  # another kind is another program's
            made.pop(name, None)
    return made


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
    x, y = way_back(network, places)
    places = {name: (at[0] + x, at[1] + y) for name, at in places.items()}
    steps: list[Operation] = [Move(dict(places))]
    # The innermost first: an outer one goes round it, too.
    frames: dict[int, Box] = {}
    for index in reversed(order):
        points = {name: places[name] for name in members[index]}
        boxes = list(boxes_of(points, sizes).values())
        boxes += [frames[inner] for inner in _on(index, list(frames), members)]
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
        within = _on(index, order[order.index(index) + 1 :], members)
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


def _on(index: int, others: Sequence[int], members: _Members) -> list[int]:
    """Those of the other backdrops whose nodes stand on this one."""
    return [other for other in others if set(members[other]) <= set(members[index])]


def _depth(within: Sequence[int], members: _Members) -> int:
    """How many backdrops stand on each other, at most."""
    depths = (
        1 + _depth(_on(index, within[place + 1 :], members), members)
        for place, index in enumerate(within)
    )
    return max(depths, default=0)


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


def _round(boxes: Iterable[Box]) -> Box:
    left, top, right, bottom = hull(boxes)
    return left - MARGIN, top - MARGIN - HEAD, right + MARGIN, bottom + MARGIN


def _key(index: int) -> str:
    return f"\0{index}"  # no node's name: they have no control characters
