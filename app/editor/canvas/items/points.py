"""Where nodes stand: as the document says, or for want of that in columns by their depth."""

from __future__ import annotations

from core.editing.nodes import Point
from core.network.graph import topological
from core.network.network import Network

COLUMN, ROW = 240.0, 160.0
_ASIDE = 24.0


def points_of(network: Network) -> dict[str, Point]:
    """A point for every node; those without one stand below the others, each after its sources."""
    found: dict[str, Point] = {name: network.layout[name] for name in network.layout}
    lost = [name for name in network.nodes if name not in found]
    if not lost:
        return found
    depths = _depths(network)
    top = max((y for _, y in found.values()), default=-ROW) + ROW
    rows: dict[int, int] = {}
    for name in lost:
        depth = depths.get(name, 0)
        row = rows[depth] = rows.get(depth, -1) + 1
        found[name] = (depth * COLUMN, top + row * ROW)
    return found


def free_point(network: Network, at: Point) -> Point:
    """The point in whole units, or one beside it where a node stands there already."""
    taken = set(network.layout.values())
    found = (float(round(at[0])), float(round(at[1])))
    while found in taken:
        found = (found[0] + _ASIDE, found[1] + _ASIDE)
    return found


def _depths(network: Network) -> dict[str, int]:
    depths: dict[str, int] = {}
    for name in topological(network.followers):
        for follower in network.followers[name]:
            depths[follower] = max(depths.get(follower, 0), depths.get(name, 0) + 1)
    return depths
