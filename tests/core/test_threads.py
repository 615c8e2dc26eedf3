"""Threads that share work: every item once, errors come out, calls may nest."""

import threading
import time

import pytest

from child_process import PATIENCE_S
from core.errors import DataError
from core.machine import Workers


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("count", [0, 1, 2, 97])
def test_every_item_is_done_once(threads, count):
    done = []
    Workers().for_each(done.append, range(count), threads)
    assert sorted(done) == list(range(count))


MANY = 1_000_000  # a millisecond each: a busy machine raises long before they are done


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_comes_out_and_ends_the_work(threads):
    done = []

    def one(item):
        if item == 3:
            raise DataError("three")
        done.append(item)
        time.sleep(0.001)

    with pytest.raises(DataError, match="three"):
        Workers().for_each(one, range(MANY), threads)
    assert len(done) < MANY - 1


def test_an_error_of_the_caller_waits_for_those_at_work():
    left = threading.Event()
    started, begun = threading.Event(), threading.Event()
    caller = threading.current_thread()

    def one(item):
        if threading.current_thread() is caller:
            begun.set()
            started.wait(PATIENCE_S)
            raise DataError("mine")
        started.set()
        begun.wait(PATIENCE_S)  # else it might have done both before the caller takes one
        time.sleep(0.05)
        left.set()

    with pytest.raises(DataError, match="mine"):
        Workers().for_each(one, range(2), 2)
    assert left.is_set()


def test_calls_may_nest_without_end_of_threads():
    workers, done = Workers(), []

    def outer(item):
        workers.for_each(lambda inner: done.append((item, inner)), range(5), 2)

    workers.for_each(outer, range(8), 2)
    assert sorted(done) == [(a, b) for a in range(8) for b in range(5)]
