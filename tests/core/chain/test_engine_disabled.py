"""Disabled nodes pass their main input through."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import NetworkError
from core.network.network import Network
from engine_bench import CHAIN, CHAIN_LINKS, LINE, network


def disabled(document: Network, name: str) -> Network:
    return replace(
        document, nodes={**document.nodes, name: replace(document.nodes[name], disabled=True)}
    )


class TestDisabled:
    def test_passes_its_main_input_through(self, bench):
        document = network(LINE)
        plan = bench.engine.plan(disabled(document, "a"))
        assert plan.output("a.image").key == plan.output("make.image").key
        assert np.array_equal(
            bench.engine.value(plan, "b.image", bench.work())[0], 3.0 * np.arange(6)
        )
        assert (
            "noise" not in plan.nodes["a"].outputs
        )  # a module's noise is no picture to go on with

    def test_a_filter_becomes_the_identity(self, bench):
        document = network(CHAIN, CHAIN_LINKS)
        plan = bench.engine.plan(disabled(document, "blur"))
        assert plan.errors() == []
        assert plan.output("blur.magnitude").key == plan.output("init.magnitude").key
        assert np.all(bench.engine.value(plan, "blur.mtf", bench.work()) == 1)
        picture = bench.engine.value(plan, "back.image", bench.work())
        assert np.allclose(picture, np.arange(24.0).reshape(4, 6), atol=1e-13)

    def test_what_hangs_on_an_output_that_has_gone_says_so(self, bench):
        plan = bench.engine.plan(disabled(network(CHAIN, CHAIN_LINKS), "init"))
        assert plan.errors()
        assert {error.node for error in plan.errors()} <= {"blur", "back"}
        with pytest.raises(NetworkError, match="init"):
            plan.output("bin.image")

    def test_wrong_parameters_of_a_disabled_node_are_still_errors(self, bench):
        document = disabled(network(LINE), "a").with_parameter("a", "factor", "x")
        assert [error.node for error in bench.engine.plan(document).errors()] == ["a"]

    def test_readouts_of_a_disabled_node_do_not_fail(self, bench):
        plan = bench.engine.plan(disabled(network(LINE), "a"))
        found = bench.engine.readouts(plan, "a", bench.work())
        assert found.get("mean") in (None, 11.5)
