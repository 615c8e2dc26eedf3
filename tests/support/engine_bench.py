"""Small networks, and an engine that counts what it computes."""

import itertools
from typing import Any

from arithmetic_modules import LIBRARY
from core.chain.engine import Engine
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from core.network.network import Network
from linked_network import linked_network


def network(nodes: dict[str, Any], links: list[tuple[str, str]] | None = None) -> Network:
    """As `linked_network`; without links each node follows the one before."""
    if links is None:
        links = [(f"{a}.image", f"{b}.image") for a, b in itertools.pairwise(nodes)]
    return linked_network(nodes, links)


LINE = {"make": ("maker", {}), "a": ("scale", {}), "b": ("scale", {"factor": 3})}
CHAIN = {
    "make": ("maker", {}), "init": ("init", {}), "blur": ("blur", {}), "back": ("back", {}),
    "bin": ("bin", {}),
}  # fmt: skip
CHAIN_LINKS = [
    ("make.image", "init.image"), ("init.context", "blur.context"),
    ("init.magnitude", "blur.magnitude"), ("blur.magnitude", "back.magnitude"),
    ("init.phase", "back.phase"), ("back.image", "bin.image"),
]  # fmt: skip


class Bench:
    """An engine that counts what it computes."""

    def __init__(self, store: Store | None = None) -> None:
        self.engine = Engine(LIBRARY, store)
        self.computed: list[str | None] = []

    def work(self, **how: Any) -> Work:
        policy = Policy(precision="double", threads=1)
        return self.engine.work(policy, progress=self.computed.append, **how)

    def get(self, document: Network, port: str, work: Work | None = None) -> Any:
        return self.engine.value(self.engine.plan(document), port, work or self.work())
