"""Backdrops, titled grounds behind nodes that belong together, and the dots of bent wires.

Both are drawing alone. Laying out keeps nodes on their backdrop.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from core.editing import layout, operations
from core.editing.layout import Box, Point, Sizes
from core.editing.operations import Operation
from core.errors import NetworkError, thaw
from core.network.network import Link, Network, cycles
from core.records import dataclass, replace

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
    """Those in the canvas's reach, the hindmost first; elsewhere `index` is a place in this."""
    return tuple(backdrop for _, backdrop in _indexed(network))


def add(network: Network, backdrop: Backdrop) -> Operation:
    entries = [*_entries(network), _entry({}, backdrop)]
    return operations.set_network_field(FIELD, entries, "Add backdrop")


def change(network: Network, index: int, backdrop: Backdrop) -> Operation:
    """Give a backdrop another title, place, size or colour; what else the file has of it stays."""
    entries = _entries(network)
    place = _place(network, index)
    entries[place] = _entry(entries[place], backdrop)
    return operations.set_network_field(FIELD, entries, "Change backdrop")


def remove(network: Network, index: int) -> Operation:
    entries = _entries(network)
    del entries[_place(network, index)]
    return operations.set_network_field(FIELD, entries or operations.ABSENT, "Delete backdrop")


def around(
    network: Network, names: Iterable[str], sizes: Sizes, title: str = "Backdrop"
) -> Operation:
    """Put a backdrop behind nodes; a `NetworkError` if none of them has a point."""
    boxes = _boxes(network, names, sizes).values()
    if not boxes:
        raise NetworkError("select the nodes for the backdrop first")
    left, top, right, bottom = _round(boxes)
    return add(network, Backdrop(title, left, top, right - left, bottom - top))


def nodes_on(network: Network, index: int, sizes: Sizes) -> tuple[str, ...]:
    """The nodes that lie wholly on a backdrop, and move with it."""
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
    """Let backdrops keep the nodes that lie on them where some are pushed to the right."""
    entries, changed = _entries(network), False
    for index, (place, ground) in enumerate(_indexed(network)):
        ways = [
            places[name][0] - network.layout[name][0] if name in places else 0.0
            for name in nodes_on(network, index, sizes)
        ]
        if any(ways):
            # From its first node to its last: else it would lie over the backdrop before it.
            x, width = ground.x + min(ways), ground.width + max(ways) - min(ways)
            entries[place] = _entry(entries[place], replace(ground, x=x, width=width))
            changed = True
    return operations.set_network_field(FIELD, entries, "Move backdrops") if changed else None


def _boxes(network: Network, names: Iterable[str], sizes: Sizes) -> dict[str, Box]:
    points = {name: network.layout[name] for name in names if name in network.layout}
    return layout.boxes_of(points, sizes)


def _entries(network: Network, field: str = FIELD) -> list[Any]:
    entries = thaw(network.extra.get(field, []))
    return entries if isinstance(entries, list) else []


def _indexed(network: Network) -> list[tuple[int, Backdrop]]:
    read = ((place, _backdrop(entry)) for place, entry in enumerate(_entries(network)))
    return [(place, backdrop) for place, backdrop in read if backdrop is not None]


def _place(network: Network, index: int) -> int:
    return _indexed(network)[index][0]


def _backdrop(entry: Any) -> Backdrop | None:
    if not isinstance(entry, dict):
        return None
    title = entry.get("title", "")
    numbers = [entry.get(name) for name in ("x", "y", "width", "height")]
    if not isinstance(title, str) or not all(_is_number(number) for number in numbers):
        return None
    x, y, width, height = (float(number) for number in numbers if number is not None)
    if not (width > 0 and height > 0 and layout.is_in_reach(x, y, width, height)):
        return None
    colour = entry.get("colour")
    tint = colour if isinstance(colour, str) else ""
    return Backdrop(title, x, y, width, height, entry.get("kind") == NOTE, tint)


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _entry(old: Mapping[str, Any], backdrop: Backdrop) -> dict[str, Any]:
    values = {name: getattr(backdrop, name) for name in ("x", "y", "width", "height")}
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
    network: Network, sizes: Sizes, room: layout.Size | None = None, drawn: Sizes | None = None
) -> Operation:
    """Lay all nodes out, those on a backdrop together on it; see `arranged`.

    `drawn` are the sizes with what is drawn below the nodes. A backdrop whose nodes cannot be put
    together, because a wire leaves it and comes back, is put round where its nodes stand then.
    """
    grounds = backdrops_of(network)
    members = {index: nodes_on(network, index, sizes) for index in range(len(grounds))}
    sizes = sizes if drawn is None else drawn
    order = sorted(
        (index for index, names in members.items() if names),
        key=lambda index: -grounds[index].width * grounds[index].height,
    )
    places, frames = _places(network, sizes, tuple(network.nodes), order, members, room)
    back = layout.way_back(network, places)
    places = {name: layout.shifted(at, back) for name, at in places.items()}
    frames = {index: layout.shifted_box(box, back) for index, box in frames.items()}
    steps: list[Operation] = [operations.move_nodes(places)]
    for index in reversed(order):
        points = {name: places[name] for name in members[index]}
        left, top, right, bottom = frames.get(index) or _round(
            layout.boxes_of(points, sizes).values()
        )
        ground = replace(grounds[index], x=left, y=top, width=right - left, height=bottom - top)
        if ground != grounds[index]:
            steps.append(change(network, index, ground))
            network = steps[-1].apply(network)
    return operations.together(steps, "Lay out")


def _places(
    network: Network,
    sizes: Sizes,
    names: Sequence[str],
    order: Sequence[int],
    members: _Members,
    room: layout.Size | None,
) -> tuple[dict[str, Point], dict[int, Box]]:
    """Points of these nodes, and boxes of the backdrops that some stand on, largest ones first."""
    outer: list[int] = []
    for index in order:
        if not any(set(members[index]) & set(members[other]) for other in outer):
            outer.append(index)
    while True:
        unit_of = {name: _key(index) for index in outer for name in members[index]}
        followers = _followers(network, {name: unit_of.get(name, name) for name in names})
        in_ring = {unit for ring in cycles(followers) for unit in ring}
        if not in_ring.intersection(map(_key, outer)):
            break
        outer = [index for index in outer if _key(index) not in in_ring]
    # A stage is broken up only where it is far too long for a row of its own.
    wide = None if room is None else (_ROWS_IN_STAGE * room[0], room[1])
    inside: dict[int, tuple[dict[str, Point], dict[int, Box]]] = {}
    unit_sizes = {name: layout.size_of(name, sizes) for name in names}
    for index in outer:
        # Of two that hold the same nodes the larger one holds the other.
        smaller = order[order.index(index) + 1 :]
        within = [other for other in smaller if set(members[other]) <= set(members[index])]
        points, frames = _places(network, sizes, members[index], within, members, wide)
        frames[index] = _round([*layout.boxes_of(points, sizes).values(), *frames.values()])
        inside[index] = points, frames
        left, top, right, bottom = frames[index]
        unit_sizes[_key(index)] = right - left, bottom - top
    outside = layout.placed(followers, unit_sizes, room)
    places = {unit: at for unit, at in outside.items() if unit in network.nodes}
    boxes: dict[int, Box] = {}
    for index, (points, frames) in inside.items():
        x, y = outside[_key(index)]
        way = x - frames[index][0], y - frames[index][1]
        places |= {name: layout.shifted(at, way) for name, at in points.items()}
        boxes |= {other: layout.shifted_box(box, way) for other, box in frames.items()}
    return places, boxes


def _followers(network: Network, unit_of: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    """What the links of nodes lead to, where some count as one."""
    targets: dict[str, dict[str, None]] = {unit: {} for unit in unit_of.values()}
    for name, unit in unit_of.items():
        onward = (unit_of[target] for target in network.followers[name] if target in unit_of)
        targets[unit] |= {target: None for target in onward if target != unit}
    return {unit: tuple(onward) for unit, onward in targets.items()}


def _round(boxes: Iterable[Box]) -> Box:
    left, top, right, bottom = layout.hull(boxes)
    return left - MARGIN, top - MARGIN - HEAD, right + MARGIN, bottom + MARGIN


def _key(index: int) -> str:
    return f"\0{index}"  # no node's name: they have no control characters


# Dots that wires are bent through, kept in the network's file: drawing alone, as backdrops are.
#
# The file's field `wire_dots` lists ``{"link": ["init.magnitude", "back.magnitude"], "points":
# [[300, 40]]}``, from the output to the input. Nothing that computes reads it. A dot goes with its
# wire.

Dots = Mapping[Link, tuple[Point, ...]]
_ROUNDED = 1.5


def dots_of(network: Network) -> dict[Link, tuple[Point, ...]]:
    """The dots of the wires there are, within the canvas's reach; what else a file has is none."""
    there = set(network.links)
    read = {}
    for entry in _entries(network, operations.WIRE_DOTS):
        link = operations.dots_entry_link(entry)
        points = entry.get("points") if link in there else None
        if link is not None and isinstance(points, list) and points and all(map(_is_point, points)):
            read[link] = tuple((float(x), float(y)) for x, y in points)
    return read


def add_dot(network: Network, link: Link, index: int, at: Point) -> Operation:
    """Bend a wire through a point, which comes before those from `index` on."""
    points = list(dots_of(network).get(link, ()))
    points.insert(index, at)
    return with_dots(network, {link: tuple(points)}, f"Bend {link}")


def move_dot(network: Network, link: Link, index: int, at: Point) -> Operation:
    points = list(dots_of(network).get(link, ()))
    points[index] = at
    return with_dots(network, {link: tuple(points)}, f"Move a dot on the wire {link}")


def remove_dot(network: Network, link: Link, index: int) -> Operation:
    """Take a dot away; without any its wire finds its own way."""
    points = list(dots_of(network).get(link, ()))
    del points[index]
    return with_dots(network, {link: tuple(points)}, f"Delete a dot on the wire {link}")


def straighten(network: Network, links: Iterable[Link], label: str = "") -> Operation:
    return with_dots(network, dict.fromkeys(links, ()), label or "Straighten the wire")


def with_dots(network: Network, dots: Dots, label: str) -> Operation:
    there = _entries(network, operations.WIRE_DOTS)
    entries = [entry for entry in there if operations.dots_entry_link(entry) not in dots]
    entries += _as_field(dots)
    return operations.set_network_field(operations.WIRE_DOTS, entries or operations.ABSENT, label)


def dots_along(network: Network, places: Mapping[str, Point]) -> dict[Link, tuple[Point, ...]]:
    """Dots of the wires whose two nodes are moved alike to `places`: they go along."""
    shifts = {
        name: (at[0] - network.layout[name][0], at[1] - network.layout[name][1])
        for name, at in places.items()
        if name in network.layout
    }
    return {
        link: tuple(layout.shifted(at, shifts[link.source]) for at in points)
        for link, points in dots_of(network).items()
        if link.source in shifts
        and link.target in shifts
        # Points are rounded to whole units when nodes are dropped: they may differ by that.
        and math.dist(shifts[link.source], shifts[link.target]) <= _ROUNDED
    }


def moved_with_dots(network: Network, places: Mapping[str, Point], label: str = "") -> Operation:
    """The move of nodes, with the dots of the wires among them."""
    moving, dots = operations.move_nodes(places, label), dots_along(network, places)
    if not dots:
        return moving
    return operations.together((moving, with_dots(network, dots, moving.text)), moving.text)


def dots_among(network: Network, names: Collection[str]) -> dict[Link, tuple[Point, ...]]:
    return {
        link: points
        for link, points in dots_of(network).items()
        if link.source in names and link.target in names
    }


def joined_fields(extra: Mapping[str, Any], dots: Dots) -> dict[str, Any]:
    """The field with these dots beside those of a network's other fields; nothing without any."""
    if not dots:
        return {}
    there = thaw(extra.get(operations.WIRE_DOTS, []))
    return {operations.WIRE_DOTS: [*(there if isinstance(there, list) else []), *_as_field(dots)]}


def _as_field(dots: Dots) -> list[dict[str, Any]]:
    return [
        {
            "link": link.text(),
            "points": [[int(n) if n == int(n) else n for n in at] for at in points],
        }
        for link, points in dots.items()
        if points
    ]


def _is_point(value: Any) -> bool:
    numbers = value if isinstance(value, list) and len(value) == 2 else [None]
    return all(map(_is_number, numbers)) and layout.is_in_reach(*numbers)
