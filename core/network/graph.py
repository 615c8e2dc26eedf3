"""Order and cycles of a directed graph given as each node's followers; no recursion."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence

Followers = Mapping[str, Sequence[str]]


def topological(followers: Followers) -> tuple[str, ...]:
    """Nodes after all they follow; among those that are free, in the order of the mapping.

    Nodes on a cycle, or behind one, are left out.
    """
    names = list(followers)
    place = {name: number for number, name in enumerate(names)}
    waiting = dict.fromkeys(names, 0)
    for targets in followers.values():
        for target in targets:
            waiting[target] += 1
    free = [place[name] for name in names if not waiting[name]]
    ordered = []
    while free:
        name = names[heapq.heappop(free)]
        ordered.append(name)
        for target in followers[name]:
            waiting[target] -= 1
            if not waiting[target]:
                heapq.heappush(free, place[target])
    return tuple(ordered)


def cycles(followers: Followers) -> list[tuple[str, ...]]:
    """One cycle of every set of nodes that reach each other, each once round, in order."""
    place = {name: number for number, name in enumerate(followers)}
    loops = []
    for members in _components(followers):
        first = min(members, key=place.__getitem__)
        if len(members) > 1 or first in followers[first]:
            loops.append(_loop(followers, members, place))
    return sorted(loops, key=lambda loop: place[loop[0]])


def _loop(followers: Followers, members: set[str], place: Mapping[str, int]) -> tuple[str, ...]:
    """Walk inside a strongly connected set until a node comes again."""
    step: dict[str, int] = {}
    name = min(members, key=place.__getitem__)
    while name not in step:
        step[name] = len(step)
        name = next(target for target in followers[name] if target in members)
    loop = list(step)[step[name] :]
    start = loop.index(min(loop, key=place.__getitem__))
    return tuple(loop[start:] + loop[:start])


def _components(followers: Followers) -> list[set[str]]:
    """Kosaraju's strongly connected sets."""
    leaders: dict[str, list[str]] = {name: [] for name in followers}
    for name, targets in followers.items():
        for target in targets:
            leaders[target].append(name)
    finished = [name for tree in _trees(followers, followers) for name in tree]
    return [set(tree) for tree in _trees(leaders, reversed(finished))]


def _trees(graph: Followers, starts: Iterable[str]) -> Iterable[list[str]]:
    """Depth-first trees from `starts`, each with its nodes in the order they were finished."""
    seen: set[str] = set()
    for start in starts:
        if start in seen:
            continue
        seen.add(start)
        finished = []
        path = [(start, iter(graph[start]))]
        while path:
            name, targets = path[-1]
            fresh = next((target for target in targets if target not in seen), None)
            if fresh is None:
                finished.append(name)
                path.pop()
            else:
                seen.add(fresh)
                path.append((fresh, iter(graph[fresh])))
        yield finished
