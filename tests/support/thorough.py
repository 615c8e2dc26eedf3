"""Which variations of one check run in every run, and which only with `--thorough`.

`@pytest.mark.thorough(but=12, always=("lwir", "cube"))` on a test with parameters: of its cases
twelve run, spread evenly from the first to the last, and besides them the extremes: those that are
called as one of `always` or, where none is, whose names contain it. The bare mark is for a test
none of whose cases run. With `--thorough`, and where a test is named on the command line
(`FILE::TEST`), all of them do.

Only for cases that go the same way through the code.
"""

from collections.abc import Iterable, Sequence
from typing import TypeVar

import pytest
from hypothesis import settings

Case = TypeVar("Case")


def some_of(cases: Sequence[Case], count: int) -> list[Case]:
    """At most so many of the cases, always the same, evenly spread with the first and the last."""
    if count >= len(cases):
        return list(cases)
    if count < 2:
        return list(cases[:count])
    last = len(cases) - 1
    return [cases[round(at * last / (count - 1))] for at in range(count)]


def examples(count: int) -> int:
    """How many examples hypothesis draws where a thorough run draws so many: a quarter."""
    return max(1, count * settings.default.max_examples // 100)


def parted(items: Iterable[pytest.Item]) -> tuple[list[pytest.Item], list[pytest.Item]]:
    """The tests to run in every run, and those that are left out of it."""
    tests: dict[str, list[pytest.Item]] = {}
    everything = list(items)
    for item in everything:
        if item.get_closest_marker("thorough"):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    left_out = {id(item) for cases in tests.values() for item in _left_out(cases)}
    runs = [item for item in everything if id(item) not in left_out]
    return runs, [item for item in everything if id(item) in left_out]


def _left_out(cases: list[pytest.Item]) -> list[pytest.Item]:
    mark = cases[0].get_closest_marker("thorough")
    names = {_case(item) for item in cases}
    chosen = {id(item) for item in some_of(cases, mark.kwargs.get("but", 0))}
    for always in mark.kwargs.get("always", ()):
        extremes = {always} & names or {name for name in names if always in name}
        if not extremes:
            where = cases[0].nodeid.partition("[")[0]
            raise pytest.UsageError(f"{where}: no case is called {always!r}, as `thorough` has it")
        chosen |= {id(item) for item in cases if _case(item) in extremes}
    return [item for item in cases if id(item) not in chosen]


def _case(item: pytest.Item) -> str:
    """What stands between the brackets."""
    return item.nodeid.partition("[")[2].removesuffix("]")
