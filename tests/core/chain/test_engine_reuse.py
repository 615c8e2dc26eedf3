"""What is computed, how often, and a store that engines share."""

import threading
from dataclasses import replace

import numpy as np

from core.evaluation.store import Store
from core.evaluation.work import Policy
from engine_bench import CHAIN, CHAIN_LINKS, LINE, Bench, network


class TestOnce:
    def test_a_change_computes_what_follows_it_and_no_more(self, bench):
        document = network(LINE)
        bench.get(document, "b.image")
        assert bench.computed == ["make", "a", "b"]
        bench.computed.clear()
        bench.get(document.with_parameter("b", "factor", 4), "b.image")
        assert bench.computed == ["b"]
        bench.computed.clear()
        bench.get(document.with_parameter("a", "factor", 7), "b.image")
        assert bench.computed == ["a", "b"]

    def test_what_is_no_part_of_the_key_computes_nothing(self, bench):
        document = network(LINE)
        bench.get(document, "b.image")
        bench.computed.clear()
        renamed = network({"m2": LINE["make"], "x": LINE["a"], "y": LINE["b"]})
        whole = document.with_parameter("a", "factor", 2).with_parameter("make", "level", -0.0)
        for other in (renamed, whole, replace(document, name="x", layout={"a": (1.0, 2.0)})):
            bench.get(other, "y.image" if other is renamed else "b.image")
        bench.get(document.with_parameter("a", "mode", "shown"), "b.image")
        assert bench.computed == []

    def test_precisions_are_kept_apart(self, bench):
        plan = bench.engine.plan(network(LINE))
        for precision, dtype in (("single", np.float32), ("double", np.float64)) * 2:
            work = bench.engine.work(Policy(precision=precision), progress=bench.computed.append)
            assert bench.engine.value(plan, "b.image", work).dtype == dtype
        assert len(bench.computed) == 6

    def test_threads_are_no_part_of_the_key(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        for threads in (1, 2, 0):
            policy = Policy(precision="double", threads=threads)
            work = bench.engine.work(policy, progress=bench.computed.append)
            bench.engine.value(plan, "bin.image", work)
        assert len(bench.computed) == len(set(bench.computed)) + bench.computed.count("back") - 1

    def test_readouts_are_kept_too(self, bench):
        plan = bench.engine.plan(network(LINE))
        assert bench.engine.readouts(plan, "a", bench.work()) == {"mean": 23.0, "mean_in": 11.5}
        count = len(bench.computed)
        bench.engine.readouts(plan, "a", bench.work())
        assert len(bench.computed) == count

    def test_the_bits_do_not_depend_on_what_was_looked_at_before(self):
        ports = ["bin.image", "back.image", "make.image", "blur.magnitude", "init.phase"]
        document = network(CHAIN, CHAIN_LINKS)
        alone = {port: Bench().get(document, port) for port in ports}
        for order in (ports, ports[::-1], ports[2:] + ports[:2]):
            bench = Bench()
            for port in order:
                assert np.array_equal(bench.get(document, port), alone[port])


class TestSharedStore:
    def test_many_threads_many_ports(self):
        document = network(CHAIN, CHAIN_LINKS)
        expected = {p: Bench().get(document, p) for p in ("bin.image", "back.image", "make.image")}
        bench, faults = Bench(Store(capacity_bytes=700)), []

        def ask(port: str) -> None:
            try:
                for _ in range(10):
                    assert np.array_equal(bench.get(document, port), expected[port])
            except BaseException as fault:
                faults.append(fault)

        threads = [
            threading.Thread(target=ask, args=(port,)) for port in expected for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(20)
        assert not any(thread.is_alive() for thread in threads)
        assert faults == []
