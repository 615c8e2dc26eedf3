"""Veiling Glare: stray light that spreads over the picture and lowers its contrast."""

from __future__ import annotations

from typing import Annotated

from core.chain.wires import Context, Magnitude
from core.modules.declaration import NodeContext
from core.modules.panel_sections import Section
from core.modules.parameters import Formula, Param
from core.physics.optics.veiling_glare import veiling_glare_mtf
from nodes.shared.factors import radial
from nodes.shared.module_ports import MtfModule, MtfOutputs


class VeilingGlare(MtfModule, key="veiling_glare", title="Veiling Glare", group="Optics"):
    """Spread a share of the light widely, as scatter and ghosts in the lens do.

    The point spread function has two parts: 1 − g of the light stays where the other modules put
    it, and g falls off around it as ℓ/(2π(r² + ℓ²)^(3/2)), half of it within √3·ℓ. The MTF drops to
    1 − g over a few cycles per ℓ: dark areas near bright ones become brighter, and fine detail
    loses g of its contrast. Enter the veiling glare index of the lens, if no other is known; ISO
    9358 measures it in a small black area within an evenly bright field. Light that leaves the
    frame is mirrored or repeated, as for all filters. Sources: ISO 9358:1994; the MTF is the Hankel
    transform of the spread, Bracewell 2000, The Fourier Transform and Its Applications, table 13.
    """

    formulas = (
        Formula(
            r"H(\rho)=1-g+g\,e^{-2\pi\ell\rho}",
            where="g: share of the light that is spread; ℓ: its length, mrad; ρ: radial frequency",
        ),
    )

    share_percent: Annotated[
        float, Param("share of the light that is spread", unit="%", low=0, high=100, slider=(0, 20))
    ] = 0.0
    length_mrad: Annotated[
        float,
        Param("length of the spread: half of it falls within 1.73 lengths", unit="mrad", low=0,
              high=1e6, above=True, slider=(0.1, 100)),
    ] = 10.0  # fmt: skip

    panel = (
        Section("", ("apply",)),
        Section("Stray light", ("share_percent", "length_mrad")),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        if not self.share_percent:
            return self.mtf_outputs(magnitude)
        factors = radial(
            veiling_glare_mtf,
            label=self.title,
            node=here.node,
            share=self.share_percent / 100.0,
            length_mrad=self.length_mrad,
        )
        return self.mtf_outputs(magnitude, *factors)
