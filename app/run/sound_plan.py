"""The part of a plan without errors, for what concerns the network as a whole."""

from __future__ import annotations

from dataclasses import replace

from core.chain.engine import Plan


def sound_part(plan: Plan) -> Plan:
    """The plan without its failed nodes and what would name them; itself where none has failed."""
    failed = {name for name, node in plan.nodes.items() if node.error is not None}
    if not failed:
        return plan
    network = plan.network
    final = network.extra.get("final")
    lost = isinstance(final, str) and final.rpartition(".")[0] in failed
    sound = replace(
        network,
        nodes={name: node for name, node in network.nodes.items() if name not in failed},
        links=tuple(link for link in network.links if not {link.source, link.target} & failed),
        layout={},
        extra={} if lost else network.extra,
    )
    nodes = {name: node for name, node in plan.nodes.items() if name not in failed}
    return Plan(sound, nodes, plan.folder)
