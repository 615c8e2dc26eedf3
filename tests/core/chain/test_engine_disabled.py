"""Disabled nodes pass their main input through."""

from dataclasses import replace

import pytest

from core.errors import NetworkError
from core.network.network import Network
from engine_bench import CHAIN, CHAIN_LINKS, LINE, network


def disabled(document: Network, name: str) -> Network:
    return replace(
        document, nodes={**document.nodes, name: replace(document.nodes[name], disabled=True)}
    )


class TestDisabled:
    def test_what_hangs_on_an_output_that_has_gone_says_so(self, bench):
        plan = bench.engine.plan(disabled(network(CHAIN, CHAIN_LINKS), "init"))
        assert plan.errors()
        assert {error.node for error in plan.errors()} <= {"blur", "back"}
        with pytest.raises(NetworkError, match="init"):
            plan.output("bin.image")

    def test_wrong_parameters_of_a_disabled_node_are_still_errors(self, bench):
        document = disabled(network(LINE), "a").with_parameter("a", "factor", "x")
        assert [error.node for error in bench.engine.plan(document).errors()] == ["a"]
