"""Threads that share work: every item once, errors come out, calls may nest."""

from __future__ import annotations

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


def test_several_threads_do_work_at_the_same_time():
    both = threading.Barrier(2, timeout=PATIENCE_S)
    Workers().for_each(lambda _: both.wait(), range(2), 2)  # one thread alone would wait for ever


def test_never_more_threads_than_asked_for():
    workers, names = Workers(), set()

    def one(item):
        names.add(threading.current_thread().name)
        time.sleep(0.001)

    workers.for_each(one, range(50), 4)
    names.clear()
    workers.for_each(one, range(50), 2)
    assert len(names) <= 2


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


def test_two_callers_share_the_threads():
    workers = Workers()
    sums = [0, 0]

    def caller(which):
        def one(item):
            sums[which] += item

        for _ in range(200):
            workers.for_each(one, range(1, 2), 2)
            workers.for_each(lambda _: None, range(3), 3)

    both = [threading.Thread(target=caller, args=(n,)) for n in range(2)]
    for each in both:
        each.start()
    for each in both:
        each.join(PATIENCE_S)
    assert sums == [200, 200]
