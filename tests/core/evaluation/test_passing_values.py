"""A long row of values read once: store and log end as they began, less what the row shares."""

import numpy as np
import pytest

from core.evaluation.recipes import Region, Step
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work

CALLS: list[tuple[str, int]] = []


def scene(work):
    CALLS.append(("scene", 0))
    return np.zeros((4, 4))


def deviates(work, *, frame):
    CALLS.append(("deviates", frame))
    return np.full((4, 4), float(frame))


def noisy(work, image, noise):
    return image + noise


def row(count):
    source = Step.of(scene)
    return [Step.of(noisy, source, Step.of(deviates, frame=number)) for number in range(count)]


@pytest.fixture
def work():
    CALLS.clear()
    return Work(Policy(), Store(1 << 30))


@pytest.mark.parametrize("region", [None, Region(1, 1, 2, 2)])
def test_any_number_leaves_what_a_few_leave(work, region):
    left = {}
    for count in (5, 50):
        fresh = Work(Policy(), Store(1 << 30))
        values = list(fresh.one_by_one(row(count), region, forgetting=True))
        assert [float(value[0, 0]) for value in values] == list(range(count))
        notes = fresh.log
        left[count] = (
            len(fresh.store), fresh.store.used_bytes, len(notes.requested), len(notes.parts),
            len(notes.computed),
        )  # fmt: skip
        assert fresh.store.pinned == 0
    assert left[5] == left[50]
    assert left[50][0] < 6
