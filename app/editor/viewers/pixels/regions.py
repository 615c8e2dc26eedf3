"""The rectangle of samples that a module looks at: read from the document, moved, drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from core.editing.operations import ABSENT, Operation, Together, set_parameter
from core.errors import ParameterError
from core.modules.declaration import Declaration
from core.names import thaw
from core.network.network import Node

PARAMETERS = ("region_x", "region_y", "region_width", "region_height")
Grip = tuple[int, int]
"""What of a rectangle is dragged: −1 its first edge, 1 its last, across and along; 0, 0 all."""
ALL: Grip = (0, 0)
Size = tuple[int, int]
"""Columns and rows of a picture."""


@dataclass(frozen=True)
class Region:
    """A rectangle of whole samples."""

    left: int
    top: int
    width: int
    height: int

    @property
    def right(self) -> int:
        """The column behind it."""
        return self.left + self.width

    @property
    def bottom(self) -> int:
        """The row behind it."""
        return self.top + self.height

    def description(self) -> str:
        """For people."""
        return f"{self.width} × {self.height} at column {self.left}, row {self.top}"


def has_region(declared: Declaration | None) -> bool:
    """Whether a module has the parameters of a region."""
    return declared is not None and all(declared.parameter(name) for name in PARAMETERS)


def region_of(declared: Declaration, node: Node, size: Size) -> tuple[Region, bool]:
    """The document's region of a picture of that size, and whether it lies in the picture.

    The rectangle does in any case, and has a sample at least, so that it can be dragged.
    """
    x, y, width, height = (_value(declared, node, name) for name in PARAMETERS)
    left, across, fits_x = _within(x, width, size[0])
    top, along, fits_y = _within(y, height, size[1])
    return Region(left, top, across, along), fits_x and fits_y


def _within(first: int, length: int, whole: int) -> tuple[int, int, bool]:
    start = min(first, whole - 1)
    end = min(first + length, whole) if length else whole
    return start, max(end - start, 1), first < whole and first + length <= whole


def _value(declared: Declaration, node: Node, name: str) -> int:
    """A parameter's value, the default where it is none that is allowed; empty is 0."""
    parameter = declared.parameter(name)
    assert parameter is not None
    value: Any = parameter.default
    if name in node.params:
        try:
            value = parameter.coerce(thaw(node.params[name]))
        except ParameterError:
            value = parameter.default
    return value or 0


def setting(node: str, region: Region) -> Operation:
    """Give a node that region."""
    values = (region.left, region.top, region.width, region.height)
    return _set(node, dict(zip(PARAMETERS, values, strict=True)))


def as_it_was(node: Node) -> Operation:
    """Give the node the region it has, also where it is left at the default."""
    return _set(node.id, {name: thaw(node.params.get(name, ABSENT)) for name in PARAMETERS})


def whole(node: str) -> Operation:
    """Make the region all of the node's picture."""
    return _set(node, dict.fromkeys(PARAMETERS, ABSENT))


def _set(node: str, values: dict[str, Any]) -> Operation:
    operations = [set_parameter(node, name, value) for name, value in values.items()]
    return Together(operations, f"Set {node}'s region")


def dragged(region: Region, grip: Grip, columns: int, rows: int, size: Size) -> Region:
    """The region with what the grip holds moved by so many samples, as far as the picture goes."""
    left, width = _moved(region.left, region.width, grip[0], grip == ALL, columns, size[0])
    top, height = _moved(region.top, region.height, grip[1], grip == ALL, rows, size[1])
    return Region(left, top, width, height)


def _moved(
    first: int, length: int, edge: int, everything: bool, by: int, whole: int
) -> tuple[int, int]:
    last = first + length
    if everything:
        return min(max(first + by, 0), whole - length), length
    if edge < 0:
        first = min(max(first + by, 0), last - 1)
    elif edge > 0:
        last = min(max(last + by, first + 1), whole)
    return first, last - first


def drawn(start: tuple[float, float], end: tuple[float, float], size: Size) -> Region:
    """The region between two corners, counted in samples from the picture's own first corner."""
    left, width = _between(start[0], end[0], size[0])
    top, height = _between(start[1], end[1], size[1])
    return Region(left, top, width, height)


def _between(one: float, other: float, whole: int) -> tuple[int, int]:
    low, high = sorted((one, other))
    first = min(max(round(low), 0), whole - 1)
    return first, max(min(round(high), whole) - first, 1)
