"""Values that are still needed stay, whatever their size; chains may be of any length."""

import threading
from collections import Counter

import numpy as np
import pytest

from core.chain.random_fields import at_frame
from core.errors import Cancelled, DataError
from core.evaluation.recipes import Region, Step, Store, pointwise
from core.evaluation.work import Claims, Policy, Work

DEEP = 5000
REGION = Region(0, 1, 1, 2)


def made(work, *, value):
    return np.full((2, 3), float(value))


@pointwise
def plus(work, *pictures, more=0.0):
    return np.asarray(sum(pictures) + more)


def whole_mean(work, picture):
    return float(picture.mean())


def refused(work, picture):
    raise DataError("refused")


SOURCE = Step.of(made, value=1, node="source")


def chain(length, start=SOURCE, function=plus):
    recipe = start
    for number in range(length):
        recipe = Step.of(function, recipe, more=1.0, node=f"n{number}")
    return recipe


def diamonds(count):
    """Each recipe is asked for twice by the next one."""
    recipe = SOURCE
    for _ in range(count):
        recipe = Step.of(plus, Step.of(plus, recipe, more=1.0), Step.of(plus, recipe, more=2.0))
    return recipe


class Counting(Work):
    def __init__(self, capacity_bytes=1, **how):
        super().__init__(Policy(precision="double", threads=1), Store(capacity_bytes), **how)
        self.times = Counter()
        self.most = 0

    def _compute(self, recipe, region=None):
        self.times[recipe.key, region] += 1
        value = super()._compute(recipe, region)
        self.most = max(self.most, self.store.used_bytes)
        return value

    def nothing_left(self):
        return self.store.used_bytes <= 1 and not self.store.pinned and not self._claims.waiting


class TestOnce:
    def test_parts_too(self):
        work = Counting()
        picture = work.part(diamonds(10), REGION)
        assert picture.shape == (1, 2)
        assert picture[0, 0] == 2.0**10 + 3 * (2.0**10 - 1)
        assert set(work.times.values()) == {1}
        assert work.nothing_left()

    def test_asks_that_are_announced(self):
        work, ask = Counting(), diamonds(3)
        others = [Step.of(whole_mean, ask), Step.of(plus, ask, more=5.0)]
        with work.hold([ask, *others]) as release:
            for recipe in (ask, *others):
                work.value(recipe)
                release([recipe])
        assert set(work.times.values()) == {1}
        assert work.nothing_left()

    def test_frames_share_what_leads_to_the_noise(self):
        from core.chain.random_fields import Stream

        def frames():
            noisy = Step.of(noise, chain(3), stream=Stream(1, "n", "x"))
            return [at_frame(noisy, number) for number in range(4)]

        work = Counting()
        assert len(list(work.one_by_one(frames()))) == 4
        assert set(work.times.values()) == {1}
        assert work.nothing_left()


def noise(work, picture, *, stream):
    return picture + stream.frame


class TestLetGo:
    def test_a_chain_holds_two_pictures_at_a_time(self):
        work = Counting()
        work.value(chain(100))
        assert work.most <= 2 * 48

    def test_after_an_error(self):
        work = Counting()
        recipe = Step.of(plus, chain(3), Step.of(refused, chain(2), node="bad"), node="last")
        with pytest.raises(DataError, match=r"^bad: refused"):
            work.value(recipe)
        assert work.nothing_left()

    def test_after_it_was_stopped(self):
        stop = threading.Event()

        def progress(node):
            if node == "n3":
                stop.set()

        work = Counting(cancel=stop, progress=progress)
        with pytest.raises(Cancelled):
            work.value(chain(9))
        assert work.nothing_left()


class Unclaimable(Step):
    """A recipe that fails when it is asked what it needs."""

    @property
    def needs(self):
        raise MemoryError("no room for a list")


class TestFailedClaims:
    """A claim that fails leaves the counts as they were."""

    def test_claims_of_others_stay(self):
        store = Store(1)
        claims = Claims(store, "/x")
        good, bad = chain(3), Unclaimable.of(made, value=2, node="bad")
        claims.take([good])
        pinned, waiting = store.pinned, dict(claims.waiting)
        with pytest.raises(MemoryError):
            claims.take([bad, good])
        with pytest.raises(MemoryError):
            claims.begin(Step.of(plus, good, bad))
        assert (store.pinned, claims.waiting) == (pinned, waiting)
        claims.give_up([good])
        assert (store.pinned, claims.waiting) == (0, {})


class TestDeep:
    def test_value(self):
        work = Counting()
        assert work.value(chain(DEEP))[0, 0] == DEEP + 1
        assert set(work.times.values()) == {1}
        assert work.nothing_left()

    def test_keys_and_frames(self):
        recipe = chain(DEEP)
        assert at_frame(recipe, 3) is recipe
        assert recipe.key == chain(DEEP).key != chain(DEEP - 1).key


# A long row of values read once: store and log end as they began, less what the row shares.

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
