"""What nodes take up on the canvas: points, sizes and boxes, in its units."""

from __future__ import annotations

from collections.abc import Mapping

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
