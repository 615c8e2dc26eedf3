"""Backdrops: titled grounds behind nodes that belong together, kept in the network's file."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from core.editing.fields import set_network_field
from core.editing.layout.boxes import Box, Point, Sizes, boxes_of
from core.editing.layout.reach import is_in_reach
from core.editing.operation import ABSENT, Operation
from core.errors import NetworkError
from core.names import thaw
from core.network.network import Network

FIELD = "backdrops"
NOTE = "note"  # of the field `kind`; a program that does not know it shows a backdrop
MARGIN, HEAD = 24.0, 30.0  # kept free round the nodes, and for the title


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

    Raises
    ------
    NetworkError
        If there is no such backdrop.
    """
    entries = _entries(network)
    place = _place(network, index)
    entries[place] = _entry(entries[place], backdrop)
    return set_network_field(FIELD, entries, "Change backdrop")


def remove(network: Network, index: int) -> Operation:
    """Take a backdrop away; the nodes on it stay.

    Raises
    ------
    NetworkError
        If there is no such backdrop.
    """
    entries = _entries(network)
    del entries[_place(network, index)]
    return set_network_field(FIELD, entries or ABSENT, "Delete backdrop")


def around(
    network: Network, names: Iterable[str], sizes: Sizes, title: str = "Backdrop"
) -> Operation:
    """Put a backdrop behind nodes.

    Parameters
    ----------
    network : Network
        Where they stand.
    names : iterable of str
        The nodes; at least one must have a point on the canvas.
    sizes : mapping
        Width and height of the nodes.
    title : str
        What stands on it.

    Raises
    ------
    NetworkError
        If none of them has a point.
    """
    boxes = _boxes(network, names, sizes).values()
    if not boxes:
        raise NetworkError("there are no nodes to put a backdrop behind")
    left, top = min(box[0] for box in boxes), min(box[1] for box in boxes)
    right, bottom = max(box[2] for box in boxes), max(box[3] for box in boxes)
    return add(
        network,
        Backdrop(
            title,
            left - MARGIN,
            top - MARGIN - HEAD,
            right - left + 2 * MARGIN,
            bottom - top + 2 * MARGIN + HEAD,
        ),
    )


def nodes_on(network: Network, index: int, sizes: Sizes) -> tuple[str, ...]:
    """The nodes that lie wholly on a backdrop, and move with it.

    Raises
    ------
    NetworkError
        If there is no such backdrop.
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

    One whose nodes all go the same way goes with them. Any other grows: it reaches
    from its first node to its last.

    Parameters
    ----------
    network : Network
        Before the nodes are moved.
    places : mapping
        Where nodes are pushed to.
    sizes : mapping
        Width and height of the nodes.

    Returns
    -------
    Operation or None
        None where no backdrop has to change.
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
            kept = replace(ground, x=ground.x + ways[names[0]])
        else:
            boxes = _boxes(network, names, sizes)
            rights = {name: box[2] for name, box in boxes.items()}
            lefts = {name: box[0] for name, box in boxes.items()}
            # Its left edge follows its first node: it would lie over the backdrop before it.
            x = ground.x + min(lefts[n] + way for n, way in ways.items()) - min(lefts.values())
            margin = min(MARGIN, ground.x + ground.width - max(rights.values()))
            right = max(rights[name] + way for name, way in ways.items()) + margin
            right = max(right, ground.x + ground.width)
            kept = replace(ground, x=x, width=right - x)
        if kept != ground:
            entries[place] = _entry(entries[place], kept)
            changed = True
    return set_network_field(FIELD, entries, "Move backdrops") if changed else None


def _boxes(network: Network, names: Iterable[str], sizes: Sizes) -> dict[str, Box]:
    """What those of the nodes take up that have a point."""
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
    return Backdrop(
        title,
        x,
        y,
        width,
        height,
        entry.get("kind") == NOTE,
        colour if isinstance(colour, str) else "",
    )


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
