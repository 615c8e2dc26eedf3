"""The store of computed values, and the content keys it keeps them under."""

import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from child_process import PATIENCE_S
from core import machine
from core.errors import DataError
from core.evaluation.recipes import Store, content_key, size_in_bytes
from core.transfer.factors import Grid


def block(kilobytes):
    return np.zeros(kilobytes * 128)


class TestStore:
    def test_is_bounded_in_bytes(self):
        store = Store(capacity_bytes=100 * 1024)
        for number in range(50):
            store.get(f"k{number}", lambda: block(10))
            assert store.used_bytes <= 100 * 1024
        assert len(store) == 10

    def test_the_least_recently_used_goes_first(self):
        store = Store(capacity_bytes=35 * 1024)
        for key in "abc":
            store.get(key, lambda: block(10))
        store.get("a", lambda: pytest.fail("it was there"))
        store.peek("b")
        store.get("d", lambda: block(10))
        assert [key for key in "abcd" if store.peek(key) is not None] == ["a", "b", "d"]

    def test_a_value_too_large_leaves_the_others_alone(self):
        """What can never be kept must not drive out everything that is."""
        store = Store(capacity_bytes=35 * 1024)
        small = store.get("small", lambda: block(10))
        large = store.get("large", lambda: block(100))
        assert large.size == 100 * 128
        assert store.used_bytes <= 35 * 1024
        assert store.peek("small") is small

    def test_what_is_pinned_stays_whatever_its_size(self):
        store = Store(capacity_bytes=35 * 1024)
        assert not store.pin("large")
        large = store.get("large", lambda: block(100))
        store.get("small", lambda: block(10))
        assert store.peek("large") is large
        assert store.pin("large")
        store.unpin("large")
        assert store.peek("large") is large
        store.unpin("large")
        assert store.peek("large") is None
        assert (store.used_bytes, store.pinned) == (0, 0)

    def test_takes_what_the_memory_allows(self, monkeypatch):
        assert 1 << 27 <= Store().capacity_bytes <= 1 << 50
        for name, whole, limits, free, left, expected in (
            ("a large machine", 64 << 30, [], 60 << 30, [], 16 << 30),
            ("a busy one", 64 << 30, [], 8 << 30, [], 4 << 30),
            ("a container", 64 << 30, [2 << 30], 60 << 30, [2 << 30], 1 << 29),
            ("a full container", 64 << 30, [2 << 30], 60 << 30, [1 << 20], 1 << 27),
            ("nothing known", None, [], None, [], machine.WITHOUT_KNOWLEDGE),
        ):
            monkeypatch.setattr(machine, "physical_bytes", lambda whole=whole: whole)
            monkeypatch.setattr(machine, "_limits", lambda limits=limits: limits)
            monkeypatch.setattr(machine, "_available", lambda free=free: free)
            monkeypatch.setattr(machine, "_left_in_groups", lambda left=left: left)
            assert Store().capacity_bytes == expected, name

    def test_counts_arrays_within_values(self):
        store = Store()
        store.get("a", lambda: (block(3), {"x": [block(4)]}))
        assert 7 * 1024 <= store.used_bytes <= 8 * 1024
        assert size_in_bytes(block(2)) == 2048

    def test_clear(self):
        store = Store()
        store.get("a", lambda: block(3))
        store.clear()
        assert store.used_bytes == len(store) == 0

    def test_makes_what_it_hands_out_read_only(self):
        value = Store().get("a", lambda: (block(1), {"x": [block(1)]}))
        for array in (value[0], value[1]["x"][0]):
            assert not array.flags.writeable

    def test_one_computation_per_key_at_a_time(self):
        store, running, most, made = Store(), [0], [0], []
        lock = threading.Lock()

        def compute(key):
            with lock:
                running[0] += 1
                most[0] = max(most[0], running[0])
            time.sleep(0.02)
            with lock:
                running[0] -= 1
                made.append(key)
            return block(1)

        def ask(key, found):
            found.append(store.get(key, lambda: compute(key)))

        found: list[Any] = []
        threads = [threading.Thread(target=ask, args=("k", found)) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(PATIENCE_S)
        assert made == ["k"]
        assert most[0] == 1
        assert all(value is found[0] for value in found)

    def test_after_an_error_one_at_a_time_still_holds(self):
        """The first fails while a second waits and a third arrives: the two must not overlap."""
        store, lock = Store(), threading.Lock()
        running, most, attempts = [0], [0], [0]
        failing, waiting = threading.Event(), threading.Event()

        def compute():
            with lock:
                attempts[0] += 1
                first = attempts[0] == 1
                running[0] += 1
                most[0] = max(most[0], running[0])
            try:
                if first:
                    failing.set()
                    waiting.wait(PATIENCE_S)
                    raise DataError("the first fails")
                time.sleep(0.1)
                return block(1)
            finally:
                with lock:
                    running[0] -= 1

        def ask():
            try:
                store.get("k", compute)
            except DataError:
                # The one who failed asks again at once, while the second is at work.
                store.get("k", compute)

        threads = [threading.Thread(target=ask)]
        threads[0].start()
        failing.wait(PATIENCE_S)
        threads.append(threading.Thread(target=ask))
        threads[1].start()
        time.sleep(0.05)  # the second stands in the queue
        waiting.set()
        for thread in threads:
            thread.join(PATIENCE_S)
        assert most[0] == 1
        assert store.used_bytes == size_in_bytes(block(1))


# ---------------------------------------------------------------- keys


class TestKeys:
    @pytest.mark.parametrize(
        ("one", "other"),
        [
            (("a", "b"), ("b", "a")),
            (("ab", ""), ("a", "b")),
            ((1,), (1.0,)),
            ((True,), (1,)),
            ((None,), ("None",)),
            (("1",), (1,)),
            (((1, 2), 3), (1, (2, 3))),
            ((0.1,), (0.1 + 2**-55,)),
            (({"a": 1},), ({"a": 2},)),
            ((np.zeros(2),), (np.zeros((2, 1)),)),
            ((np.zeros(2),), (np.zeros(2, np.float32),)),
            ((np.zeros(2),), (np.zeros(2, np.int64),)),  # equal bytes
            ((np.ones(2, ">f4"),), (np.ones(2, ">f4").view("<f4"),)),
            ((Path("a"),), ("a",)),
            ((Grid(1, 2, 3.0, 4.0),), (Grid(2, 1, 3.0, 4.0),)),
            (("a;str:b", "c"), ("a", "b;str:c")),
            (("x)",), ("x",)),
        ],
    )
    def test_different_content_has_different_keys(self, one, other):
        assert content_key(*one) != content_key(*other)

    def test_what_has_no_content_is_refused(self):
        for thing in (object(), lambda x: x, {1, 2}, 1j):
            with pytest.raises(TypeError):
                content_key(thing)
