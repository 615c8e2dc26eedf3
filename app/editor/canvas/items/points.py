"""Where nodes stand: as in the document, else in columns by their depth."""

from __future__ import annotations

from core.editing.layout import Point, is_in_reach
from core.network.graph import topological
from core.network.network import Network

COLUMN, ROW = 240.0, 160.0


def points_of(network: Network) -> dict[str, Point]:
    """A point for every node; those without one stand below the others, each after its sources.

    A point that the canvas does not reach is none.
    """
    points: dict[str, Point] = {name: at for name, at in network.layout.items() if is_in_reach(*at)}
    lost = [name for name in network.nodes if name not in points]
    if not lost:
        return points
    depths = _depths(network)
    top = max((y for _, y in points.values()), default=-ROW) + ROW
    rows: dict[int, int] = {}
    for name in lost:
        depth = depths.get(name, 0)
        row = rows[depth] = rows.get(depth, -1) + 1
        points[name] = (depth * COLUMN, top + row * ROW)
    return points


def _depths(network: Network) -> dict[str, int]:
    depths: dict[str, int] = {}
    for name in topological(network.followers):
        for follower in network.followers[name]:
            depths[follower] = max(depths.get(follower, 0), depths.get(name, 0) + 1)
    return depths
