"""Charge Eff MTF: contrast lost by incomplete charge transfer."""

from __future__ import annotations

from core.chain.wires import Context, Magnitude
from core.modules.declaration import NodeContext
from core.physics.detector.charge_transfer import charge_transfer_mtf
from nodes.detector.charge_transfer_base import ChargeTransfer
from nodes.shared.factor_helpers import separable
from nodes.shared.module_ports import MtfModule, MtfOutputs


class ChargeEffMTF(
    ChargeTransfer, MtfModule, key="charge_eff_mtf", title="Charge Eff MTF", group="Detector"
):
    """Lose contrast across by incomplete charge transfer.

    With w = 2π·xi·Δ: exact |ε/(1 − (1−ε)e^{−iw})|^N; published and leading
    exp(−N(1−ε)(1 − cos w)). Source: Tantalo 1996, eq. 4.57, after LeBlanc and Contini 1990.
    """

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        """Plan the loss."""
        factors = separable(
            charge_transfer_mtf,
            x=None if self.neutral() else self.law(),
            argument="phase_per_transfer",
            scale_x=self.phase_per_frequency(context),
            label=self.title,
            node=here.node,
        )
        return self.mtf_outputs(magnitude, *factors)
