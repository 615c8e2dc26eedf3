"""Where a noise source's deviates come from."""

from __future__ import annotations

from typing import Annotated, Literal

from core.modules.declaration import Module, NodeContext
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from core.noise.random_fields import Stream

SEED_SECTIONS = (
    Section("Seed", ("seed_mode",)),
    Section("", ("seed",), shown_when=("seed_mode", ("typed",))),
)


class SeededModule(Module):
    """Base of noise sources: a seed of the network and node, or one typed in."""

    draws_noise = True

    seed_mode: Annotated[
        Literal["automatic", "typed"],
        Param("seed from the network's seed and this node's name, or the one typed in"),
    ] = "automatic"
    seed: Annotated[int, Param("seed, when typed in", low=0, high=2**63 - 1)] = 0

    def stream(self, here: NodeContext, field: str, *, fixed: bool = False) -> Stream:
        """The stream of one noise field; a typed seed gives the same noise under any name.

        What is `fixed` is the same in every frame of a sequence.
        """
        if self.seed_mode == "typed":
            return Stream(seed=self.seed, node="", field=field, fixed=fixed)
        return Stream(seed=here.seed, node=here.noise or here.node, field=field, fixed=fixed)
