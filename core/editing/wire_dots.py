"""Dots that wires are bent through, kept in the network's file: drawing alone, as backdrops are.

The file's field `wire_dots` lists ``{"link": ["init.magnitude", "back.magnitude"], "points": [[300,
40]]}``, from the output to the input. Nothing that computes reads it. A dot goes with its wire.
"""

import math
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from core.editing.layout import Point, is_in_reach
from core.editing.operations import ABSENT, Operation, move_nodes, set_network_field, together
from core.editing.references import WIRE_DOTS, dots_entry_link
from core.errors import thaw
from core.network.network import Link, Network

Dots = Mapping[Link, tuple[Point, ...]]
_ROUNDED = 1.5


def dots_of(network: Network) -> dict[Link, tuple[Point, ...]]:
    """The dots of the wires there are, within the canvas's reach; what else a file has is none."""
    there = set(network.links)
    read = {}
    for entry in _entries(network):
        link = dots_entry_link(entry)
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
    """Put a dot elsewhere."""
    points = list(dots_of(network).get(link, ()))
    points[index] = at
    return with_dots(network, {link: tuple(points)}, f"Move the dot of {link}")


def remove_dot(network: Network, link: Link, index: int) -> Operation:
    """Take a dot away; without any its wire finds its own way."""
    points = list(dots_of(network).get(link, ()))
    del points[index]
    return with_dots(network, {link: tuple(points)}, f"Delete the dot of {link}")


def straighten(network: Network, links: Iterable[Link], label: str = "") -> Operation:
    """Take all dots of these wires away."""
    return with_dots(network, dict.fromkeys(links, ()), label or "Straighten the wire")


def with_dots(network: Network, dots: Dots, label: str) -> Operation:
    """Give wires these dots in the place of theirs."""
    entries = [entry for entry in _entries(network) if dots_entry_link(entry) not in dots]
    entries += _as_field(dots)
    return set_network_field(WIRE_DOTS, entries or ABSENT, label)


def dots_along(network: Network, places: Mapping[str, Point]) -> dict[Link, tuple[Point, ...]]:
    """Dots of the wires whose two nodes are moved alike to `places`: they go along."""
    shifts = {
        name: (at[0] - network.layout[name][0], at[1] - network.layout[name][1])
        for name, at in places.items()
        if name in network.layout
    }
    return {
        link: shifted(points, shifts[link.source])
        for link, points in dots_of(network).items()
        if link.source in shifts
        and link.target in shifts
        # Points are rounded to whole units when nodes are dropped: they may differ by that.
        and math.dist(shifts[link.source], shifts[link.target]) <= _ROUNDED
    }


def moved_with_dots(network: Network, places: Mapping[str, Point], label: str = "") -> Operation:
    """The move of nodes, with the dots of the wires among them."""
    moving, dots = move_nodes(places, label), dots_along(network, places)
    if not dots:
        return moving
    return together((moving, with_dots(network, dots, moving.text)), moving.text)


def shifted(points: Iterable[Point], by: Point) -> tuple[Point, ...]:
    """The points, so much further right and down."""
    return tuple((x + by[0], y + by[1]) for x, y in points)


def dots_among(network: Network, names: Collection[str]) -> dict[Link, tuple[Point, ...]]:
    """The dots of the wires among these nodes."""
    return {
        link: points
        for link, points in dots_of(network).items()
        if link.source in names and link.target in names
    }


def joined_fields(extra: Mapping[str, Any], dots: Dots) -> dict[str, Any]:
    """The field with these dots beside those of a network's other fields; nothing without any."""
    if not dots:
        return {}
    there = thaw(extra.get(WIRE_DOTS, []))
    return {WIRE_DOTS: [*(there if isinstance(there, list) else []), *_as_field(dots)]}


def _as_field(dots: Dots) -> list[dict[str, Any]]:
    return [
        {
            "link": link.text(),
            "points": [[int(n) if n == int(n) else n for n in at] for at in points],
        }
        for link, points in dots.items()
        if points
    ]


def _entries(network: Network) -> list[Any]:
    entries = thaw(network.extra.get(WIRE_DOTS, []))
    return entries if isinstance(entries, list) else []


def _is_point(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(type(number) in (int, float) for number in value)
        and is_in_reach(*value)
    )
