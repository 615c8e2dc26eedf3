"""What is handed out, what is told on the way, and cancelling."""

import pickle
import threading

import pytest

from core.errors import Cancelled
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work
from engine_bench import CHAIN, CHAIN_LINKS, LINE, network


class TestHandedOut:
    @pytest.mark.parametrize("port", ["make.image", "back.image", "bin.image", "a.image"])
    def test_pictures_are_read_only(self, bench, port):
        nodes = {**CHAIN, "a": ("scale", {})}
        array = bench.get(network(nodes, [*CHAIN_LINKS, ("bin.image", "a.image")]), port)
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1

    def test_plans_pickle(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        again = pickle.loads(pickle.dumps(plan.output("bin.image")))
        assert again.key == plan.output("bin.image").key


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
