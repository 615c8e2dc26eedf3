"""The columns and rows of a graph that is drawn from left to right; no recursion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from core.network.graph import topological

Followers = Mapping[str, Sequence[str]]

SWEEPS = 6  # more hardly uncross anything


def components(followers: Followers) -> list[list[str]]:
    """The parts that no link joins, each in the order of the mapping."""
    joined: dict[str, list[str]] = {name: [] for name in followers}
    for name, targets in followers.items():
        for target in targets:
            joined[name].append(target)
            joined[target].append(name)
    part: dict[str, int] = {}
    count = 0
    for start in followers:
        if start in part:
            continue
        part[start] = count
        rest = [start]
        while rest:
            fresh = [name for name in joined[rest.pop()] if name not in part]
            part.update(dict.fromkeys(fresh, count))
            rest += fresh
        count += 1
    parts: list[list[str]] = [[] for _ in range(count)]
    for name in followers:
        parts[part[name]].append(name)
    return parts


def columns_of(followers: Followers) -> dict[str, int]:
    """The column of each node: behind all that lead to it, sources right before what they feed.

    Nodes on a cycle, which no sound network has, stand in the first.
    """
    order = topological(followers)
    column = dict.fromkeys(followers, 0)
    fed = set()
    for name in order:
        for target in followers[name]:
            column[target] = max(column[target], column[name] + 1)
            fed.add(target)
    for name in order:
        if name not in fed and followers[name]:
            column[name] = max(min(column[target] for target in followers[name]) - 1, 0)
    return column


def rows_of(followers: Followers, column: Mapping[str, int]) -> list[list[str]]:
    """The nodes of each column from top to bottom, with few crossings.

    Each sweep puts the nodes of a column in the order of the mean height of what they are joined
    to, near wires counting most (the barycentre method of Sugiyama, Tagawa and Toda 1981).
    """
    layers: list[list[str]] = [[] for _ in range(max(column.values(), default=-1) + 1)]
    for name in followers:
        layers[column[name]].append(name)
    joined = neighbours(followers, column)
    height = {name: float(row) for layer in layers for row, name in enumerate(layer)}
    best, fewest = layers, crossings(followers, column, height)
    for sweep in range(SWEEPS):
        if not fewest:
            break
        layers = [list(layer) for layer in layers]
        for layer in layers if sweep % 2 == 0 else reversed(layers):
            wanted = {name: _mean(joined[name], height, height[name]) for name in layer}
            layer.sort(key=wanted.__getitem__)  # stable: equal ones keep their order
            height.update({name: float(row) for row, name in enumerate(layer)})
        count = crossings(followers, column, height)
        if count < fewest:
            best, fewest = layers, count
    return best


def neighbours(
    followers: Followers, column: Mapping[str, int]
) -> dict[str, list[tuple[str, float]]]:
    """What each node is joined to, and how much that counts: less the longer the wire."""
    weighted: dict[str, list[tuple[str, float]]] = {name: [] for name in followers}
    for name, targets in followers.items():
        for target in targets:
            weight = 1.0 / max(abs(column[target] - column[name]), 1) ** 2
            weighted[name].append((target, weight))
            weighted[target].append((name, weight))
    return weighted


def crossings(followers: Followers, column: Mapping[str, int], height: Mapping[str, float]) -> int:
    """How many pairs of wires between neighbouring columns cross."""
    wires: dict[int, list[tuple[float, float]]] = {}
    for name, targets in followers.items():
        for target in targets:
            if column[target] == column[name] + 1:
                wires.setdefault(column[name], []).append((height[name], height[target]))
    return sum(_inversions([end for _, end in sorted(pairs)]) for pairs in wires.values())


def _inversions(values: list[float]) -> int:
    """Pairs in the wrong order, counted while merging ever longer sorted runs."""
    count, size = 0, 1
    while size < len(values):
        merged: list[float] = []
        for start in range(0, len(values), 2 * size):
            left = values[start : start + size]
            right = values[start + size : start + 2 * size]
            place = 0
            for value in right:
                while place < len(left) and left[place] <= value:
                    merged.append(left[place])
                    place += 1
                count += len(left) - place
                merged.append(value)
            merged += left[place:]
        values, size = merged, 2 * size
    return count


def _mean(
    joined: Sequence[tuple[str, float]], height: Mapping[str, float], default: float
) -> float:
    total = sum(weight for _, weight in joined)
    if not total:
        return default
    return sum(height[name] * weight for name, weight in joined) / total
