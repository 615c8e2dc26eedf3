"""What an evaluation did not compute is said of the right nodes, and only where it is so."""

import math
import threading

import numpy as np
import pytest

from arithmetic_modules import LIBRARY
from child_process import PATIENCE_S
from core.chain.engine import Engine
from core.chain.skipped import skips
from core.evaluation.work import Policy
from engine_bench import CHAIN, CHAIN_LINKS, Bench, network


def evaluated(document, *ports, bench=None, tolerance=0.0):
    """The account of a new evaluation that looked at the ports."""
    engine = (bench or Bench()).engine
    plan = engine.plan(document)
    work = engine.work(Policy(precision="double", tolerance=tolerance, threads=1))
    for port in ports:
        engine.value(plan, port, work)
    return skips(plan, work)


def of_kind(found, kind):
    return {each.node: each for each in found if each.kind == kind}


def chain(**params):
    document = network(CHAIN, CHAIN_LINKS)
    for name, (parameter, value) in params.items():
        document = document.with_parameter(name, parameter, value)
    return document


class TestStages:
    def test_below_the_budget_with_its_bound(self):
        """1 − H of a Gaussian is largest at the band's corner, (5/12, 3/8) cycles/mrad here."""
        sigma = 1e-3
        true = -math.expm1(-2 * (math.pi * sigma) ** 2 * ((5 / 12) ** 2 + (3 / 8) ** 2))
        found = evaluated(chain(blur=("sigma", sigma)), "bin.image", tolerance=1.001 * true)
        left_out = of_kind(found, "below_budget")
        assert list(left_out) == ["blur"]
        assert true <= left_out["blur"].bound <= true * (1 + 1e-5)
        for tolerance in (0.999 * true, 0.0):
            found = evaluated(chain(blur=("sigma", sigma)), "bin.image", tolerance=tolerance)
            assert of_kind(found, "below_budget") == {}

    @pytest.mark.parametrize("plain_first", [True, False])
    def test_of_two_pictures_the_larger_bound(self, plain_first):
        """Crossed with another phase a frame is periodic: its band ends at (1/2, 1/2)."""
        sigma = 1e-3
        pictures = {"back": ("back", {}), "crossed": ("back", {})}
        if not plain_first:
            pictures = dict(reversed(pictures.items()))
        nodes = {name: CHAIN[name] for name in ("make", "init", "blur")}
        nodes |= {"blur": ("blur", {"sigma": sigma}), "other": ("maker", {"level": 5.0})}
        links = [
            *CHAIN_LINKS[:-1], ("other.image", "init2.image"),
            ("blur.magnitude", "crossed.magnitude"), ("init2.phase", "crossed.phase"),
        ]  # fmt: skip
        document = network({**nodes, "init2": ("init", {}), **pictures}, links)
        found = evaluated(document, "back.image", "crossed.image", tolerance=0.1)
        (left_out,) = [each for each in found if each.kind == "below_budget"]
        true = -math.expm1(-2 * (math.pi * sigma) ** 2 * 0.5)
        assert true <= left_out.bound <= true * (1 + 1e-5)

    def test_a_stage_left_out_of_a_picture_in_the_store_is_still_named(self):
        bench, document = Bench(), chain(blur=("sigma", 1e-9))
        for _ in range(2):
            found = evaluated(document, "bin.image", bench=bench, tolerance=1e-3)
            assert list(of_kind(found, "below_budget")) == ["blur"]


class TestAccount:
    def test_taking_it_asks_for_nothing_and_changes_no_bit(self):
        bench = Bench()
        plan, work = bench.engine.plan(chain()), bench.work()
        before = bench.engine.value(plan, "bin.image", work)
        count, requested = len(bench.computed), set(work.log.requested)
        first = skips(plan, work)
        assert skips(plan, work) == first
        assert (len(bench.computed), set(work.log.requested)) == (count, requested)
        bench.engine.store.clear()
        assert np.array_equal(bench.engine.value(plan, "bin.image", work), before)

    @pytest.mark.parametrize("threads", [2, 8])
    def test_threads_share_one_tally(self, threads):
        names = [f"n{k}" for k in range(60)]
        nodes = {"make": ("maker", {})} | {
            name: ("scale", {"factor": 20.0 + k}) for k, name in enumerate(names)
        }
        document = network(nodes, [("make.image", f"{name}.image") for name in names])
        engine = Engine(LIBRARY)
        plan, work = engine.plan(document), engine.work(Policy(precision="double", threads=1))
        start = threading.Barrier(threads)

        def look(own):
            start.wait(PATIENCE_S)
            for name in own:
                engine.value(plan, f"{name}.image", work)

        running = [threading.Thread(target=look, args=(names[k::threads],)) for k in range(threads)]
        for each in running:
            each.start()
        for each in running:
            each.join(PATIENCE_S)
        assert not any(each.is_alive() for each in running)
        keys = {plan.output(f"{name}.image").key for name in names} | {
            plan.output("make.image").key
        }
        assert set(work.log.requested) == work.log.computed == keys
        assert of_kind(skips(plan, work), "unchanged") == {}
