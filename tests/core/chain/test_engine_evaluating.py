"""What is handed out, what is told on the way, and cancelling."""

from __future__ import annotations

import pickle
import threading
import time

import pytest

from child_process import PATIENCE_S
from core.errors import Cancelled, DataError
from core.evaluation.policy import Policy
from core.evaluation.store import Store
from core.evaluation.work import Work
from engine_bench import CHAIN, CHAIN_LINKS, LINE, network


class TestHandedOut:
    @pytest.mark.parametrize("port", ["make.image", "back.image", "bin.image", "a.image"])
    def test_pictures_are_read_only(self, bench, port):
        nodes = {**CHAIN, "a": ("scale", {})}
        array = bench.get(network(nodes, [*CHAIN_LINKS, ("bin.image", "a.image")]), port)
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1

    def test_the_same_array_is_handed_out(self, bench):
        document = network(LINE)
        assert bench.get(document, "b.image") is bench.get(document, "b.image")

    def test_plans_pickle(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        again = pickle.loads(pickle.dumps(plan.output("bin.image")))
        assert again.key == plan.output("bin.image").key


class TestProgress:
    def test_is_told_each_node_before_it_is_computed(self, bench):
        bench.get(network(LINE), "b.image")
        assert bench.computed == ["make", "a", "b"]

    def test_chain_tells_its_nodes(self, bench):
        bench.get(network(CHAIN, CHAIN_LINKS), "bin.image")
        assert {"make", "back"} <= set(bench.computed)


class TestCancel:
    def test_before_anything(self, bench):
        stop = threading.Event()
        stop.set()
        with pytest.raises(Cancelled):
            bench.get(network(LINE), "b.image", bench.work(cancel=stop))
        assert bench.computed == []

    @pytest.mark.parametrize("at", ["b", "a", "make"])
    def test_midway(self, bench, at):
        stop = threading.Event()
        seen: list[str | None] = []

        def progress(node: str | None) -> None:
            seen.append(node)
            if node == at:
                stop.set()

        work = bench.engine.work(Policy(precision="double"), cancel=stop, progress=progress)
        with pytest.raises(Cancelled) as caught:
            bench.get(network(LINE), "b.image", work)
        assert caught.value.exit_code == 1
        assert seen[-1] in (at, "make")
        # Nothing is left behind that keeps it from going on.
        assert bench.get(network(LINE), "b.image")[0, 1] == 6

    @pytest.mark.parametrize("threads", [1, 2])
    def test_within_a_long_step(self, threads):
        """Blocks of rows are the unit in which a filter can be stopped."""
        calls = []
        stop = threading.Event()
        work = Work(Policy(threads=threads), Store(), stop)

        def one(item: int) -> None:
            calls.append(item)
            if len(calls) == 3:
                stop.set()

        with pytest.raises(Cancelled):
            work.for_each(one, range(1000))
        assert len(calls) < 1000

    def test_from_another_thread(self):
        stop = threading.Event()
        work = Work(Policy(), Store(), stop)
        threading.Timer(0.05, stop.set).start()

        def wait() -> None:
            begin = time.monotonic()
            while time.monotonic() - begin < PATIENCE_S:
                work.check()
                time.sleep(0.001)

        with pytest.raises(Cancelled):
            wait()

    def test_errors_in_threads_come_out(self):
        work = Work(Policy(threads=2), Store())

        def one(item: int) -> None:
            if item == 7:
                raise DataError("seven")

        with pytest.raises(DataError, match="seven"):
            work.for_each(one, range(20))
