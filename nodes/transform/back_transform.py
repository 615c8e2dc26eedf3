"""Back Transform: one inverse transform for the whole cascade."""

from core.chain.back_transformed import back_transform
from core.chain.wires import Magnitude, Phase
from core.modules.declaration import Formula, Module, NodeContext
from nodes.shared.module_ports import ImageOutput


class BackTransform(Module, key="back_transform", title="Back Transform", group="Transform"):
    """Compute the image from a magnitude and a phase.

    Magnitude and phase may come from different images A and B of the same size. The result then has
    the spectrum |A|·exp(i·∠B) and periodic edges. Source: Tantalo 1996, section 4.1.
    """

    formulas = (
        Formula(
            r"L'=\mathcal{F}^{-1}\left\{A\,e^{i\phi}\prod_k M_k\,e^{i\theta_k}\right\}",
            where="A, φ: magnitude and phase of the image; M_k, θ_k: MTF and PTF of every "
            "stage in the chain",
        ),
    )

    def run(self, magnitude: Magnitude, phase: Phase, here: NodeContext) -> ImageOutput:
        return ImageOutput(back_transform(magnitude, phase, node=here.node))
