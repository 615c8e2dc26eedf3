"""The noises of a network, and the network without one of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from app.run.evaluation import Evaluation
from app.run.output import ancestors
from core.chain.engine import PlannedNode
from core.chain.skipped import is_neutral
from core.network.network import Network

ADDED = ("poisson_noise", "periodic_noise", "noise_file")  # a switched-off node adds nothing
ELECTRONICS = "electronics_noise"
SILENT_D_STAR = 1e25  # cm √Hz/W: noise far below the rounding of any radiance


@dataclass(frozen=True)
class Source:
    """A noise, and how to be without it: parameters to set, or None to switch its node off."""

    node: str
    title: str
    name: str
    silent: Mapping[str, Any] | None

    def silenced(self, network: Network) -> Network:
        """The network without this noise."""
        if self.silent is None:
            return network.with_node(replace(network.node(self.node), disabled=True))
        for name, value in self.silent.items():
            network = network.with_parameter(self.node, name, value)
        return network


def noise_sources(found: Evaluation) -> list[Source]:
    """The noises there are on the way to the final picture, quantization last of its node's."""
    final = found.chain.final
    if final is None:
        return []
    last = final.rpartition(".")[0]
    upstream = ancestors(found.network, last) | {last}
    sources: list[Source] = []
    for name, planned in found.plan.nodes.items():
        if name in upstream and planned.module is not None and not planned.node.disabled:
            sources += _sources(name, planned)
    return sources


def _sources(name: str, planned: PlannedNode) -> Iterator[Source]:
    declared, module = planned.declaration, planned.module
    if declared.key in ADDED and not is_neutral(planned):
        yield Source(name, declared.title, "", None)
    if declared.key != ELECTRONICS:
        return
    assert module is not None
    values = module.values()
    kinds: tuple[tuple[str, bool, dict[str, Any]], ...] = (
        # As eq. 4.59 is printed the gain error is the picture: without it nothing would be left.
        (
            "gain",
            values["gain_percent"] > 0 and values["gain_model"] != "literal",
            {"gain_percent": 0.0},
        ),
        ("bias", values["bias_percent"] > 0, {"bias_percent": 0.0}),
        ("detector", True, {"d_star": SILENT_D_STAR}),
        ("amplifier", values["amplifier_snr"] is not None, {"amplifier_snr": None}),
        ("quantization", values["bits"] > 0, {"bits": 0}),
    )
    for kind, there, silent in kinds:
        if there:
            yield Source(name, declared.title, kind, silent)
