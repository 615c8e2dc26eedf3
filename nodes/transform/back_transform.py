"""Back Transform: one inverse transform for the whole cascade."""

from __future__ import annotations

from core.chain.back_transformed import back_transform
from core.chain.wires import Magnitude, Phase
from core.modules.declaration import Module, NodeContext
from nodes.shared.module_ports import ImageOutput


class BackTransform(Module, key="back_transform", title="Back Transform", group="Transform"):
    """Make the image of a magnitude and a phase.

    The two may stem from different images of one size: then |A|·exp(i·∠B) is taken, periodically.
    Source: Tantalo 1996, section 4.1.
    """

    def run(self, magnitude: Magnitude, phase: Phase, here: NodeContext) -> ImageOutput:
        """Plan the inverse transform."""
        return ImageOutput(back_transform(magnitude, phase, node=here.node))
