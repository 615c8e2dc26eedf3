"""Charge Transfer MTF: contrast lost by incomplete charge transfer."""

from __future__ import annotations

from core.chain.wires import Context, Magnitude
from core.modules.declaration import NodeContext
from core.modules.parameters import Formula
from core.physics.detector.detector_mtf import charge_transfer_mtf
from nodes.detector.charge_transfer_base import ChargeTransfer
from nodes.shared.factors import separable
from nodes.shared.module_ports import MtfModule, MtfOutputs


class ChargeEffMTF(
    ChargeTransfer, MtfModule, key="charge_eff_mtf", title="Charge Transfer MTF", group="Detector"
):
    """Blur along the read-out direction (x) by incomplete charge transfer.

    With w = 2π·xi·Δ: exact |ε/(1 − (1−ε)e^{−iw})|^N; published and leading exp(−N(1−ε)(1 − cos w)).
    Source: Tantalo 1996, eq. 4.57, after LeBlanc and Contini 1990.
    """

    formulas = (
        Formula(
            r"H=\left|\frac{\varepsilon}{1-(1-\varepsilon)\,e^{-iw}}\right|^N,\quad w=2\pi\,\xi"
            r"\,\Delta",
            where="ε: charge transfer efficiency; N: transfers; Δ: sampling interval of the "
            "image, or detector pitch",
            when="exact",
        ),
        Formula(r"H=e^{-N(1-\varepsilon)(1-\cos w)}", when="published, leading"),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        factors = separable(
            charge_transfer_mtf,
            x=None if self.neutral() else self.law(),
            argument="phase_per_transfer",
            scale_x=self.phase_per_frequency(context),
            label=self.title,
            node=here.node,
        )
        return self.mtf_outputs(magnitude, *factors)
