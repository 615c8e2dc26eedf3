"""Planning: nothing is computed, and errors go to their nodes."""

import pytest

from core.errors import DataError, NetworkError, ParameterError
from engine_bench import CHAIN, CHAIN_LINKS, LINE, network

FITTING = [("make.image", "a.image")]


class TestPlan:
    def test_an_error_stays_on_its_node_and_the_rest_runs(self, bench):
        document = network(
            {**LINE, "bad": ("maker", {"level": -13}), "c": ("scale", {}), "d": ("sum", {}),
             "e": ("scale", {})},
            [("make.image", "a.image"), ("bad.image", "c.image"), ("c.image", "d.image"),
             ("make.image", "d.other"), ("a.image", "b.image"), ("make.image", "e.image")],
        )  # fmt: skip
        plan = bench.engine.plan(document)
        assert [(error.node, type(error)) for error in plan.errors()] == [("bad", ParameterError)]
        for hung in ("bad", "c", "d"):
            with pytest.raises(ParameterError, match="-13") as caught:
                plan.output(f"{hung}.image")
            assert caught.value.node == "bad"
        assert bench.engine.value(plan, "b.image", bench.work())[0, 1] == 6
        assert bench.engine.value(plan, "e.image", bench.work())[0, 1] == 2

    @pytest.mark.parametrize(
        ("key", "params", "links", "node"),
        [
            ("nothing_like_it", {}, FITTING, "a"),
            ("scale", {"facto": 1}, FITTING, "a"),
            ("scale", {"factor": "x"}, FITTING, "a"),
            ("scale", {}, [], "a"),
            ("scale", {}, [("make.picture", "a.image")], "a"),
            ("scale", {}, [*FITTING, ("make.image", "a.no")], "a"),
            ("scale", {}, [("ghost.image", "a.image")], "a"),
            ("blur", {}, [("make.image", "a.context"), ("make.image", "a.magnitude")], "a"),
            ("scale", {}, [*FITTING, ("make.image", "ghost.image")], None),
        ],
        ids=["unknown module", "unknown parameter", "wrong kind", "missing input", "unknown output",
             "unknown input", "unknown source", "wrong port type", "unknown target"],
    )  # fmt: skip
    def test_a_network_that_does_not_fit_is_an_error_of_its_node(
        self, bench, key, params, links, node
    ):
        """The editor plans what is on the canvas, fitting or not: no other exception may escape."""
        nodes = {"make": ("maker", {}), "a": (key, params), "own": ("maker", {})}
        document = network(nodes, links)
        plan = bench.engine.plan(document)
        found = [error.node for error in plan.errors()]
        assert found == ([node] if node else [])
        assert bench.engine.value(plan, "own.image", bench.work()).shape == (4, 6)

    @pytest.mark.parametrize("port", ["ghost.image", "make.ghost", "make", "", "make.image.x"])
    def test_asking_for_what_is_not_there(self, bench, port):
        plan = bench.engine.plan(network(LINE))
        with pytest.raises(NetworkError):
            bench.engine.value(plan, port, bench.work())

    def test_errors_in_computing_carry_their_node(self, bench):
        document = network({**LINE, "a": ("scale", {"factor": 13})})
        plan = bench.engine.plan(document)
        assert plan.errors() == []
        for port in ("a.image", "b.image", "b.noise"):
            with pytest.raises(DataError, match="thirteen") as caught:
                bench.engine.value(plan, port, bench.work())
            assert caught.value.node == "a"
        with pytest.raises(DataError) as caught:
            bench.engine.readouts(plan, "b", bench.work())
        assert caught.value.node == "a"
        assert bench.engine.value(plan, "make.image", bench.work()).shape == (4, 6)

    def test_errors_of_factors_carry_the_factor_s_node(self, bench):
        document = network(CHAIN, CHAIN_LINKS).with_parameter("blur", "sigma", 101)
        plan = bench.engine.plan(document)
        for port in ("back.image", "bin.image", "blur.mtf", "blur.magnitude"):
            with pytest.raises(ParameterError, match="101") as caught:
                bench.engine.value(plan, port, bench.work())
            assert caught.value.node == "blur"

    def test_an_error_is_not_kept(self, bench):
        document = network({**LINE, "a": ("scale", {"factor": 13})})
        for _ in range(2):
            with pytest.raises(DataError):
                bench.get(document, "a.image")
        assert bench.get(document.with_parameter("a", "factor", 14), "a.image")[0, 1] == 14
