"""Charge Transfer Phase: delay by incomplete charge transfer."""

from core.chain.wires import Context, Phase
from core.modules.declaration import Formula, NodeContext
from core.physics.detector.detector_mtf import charge_transfer_ptf
from nodes.detector.charge_eff_mtf import ChargeTransfer
from nodes.shared.module_ports import PtfModule, PtfOutputs, separable


class ChargeEffPhase(
    ChargeTransfer,
    PtfModule,
    key="charge_eff_phase",
    title="Charge Transfer Phase",
    group="Detector",
):
    """Phase shift along the read-out direction (x) from incomplete charge transfer.

    With w = 2π·xi·Δ and k = N(1−ε), the phase is the argument of [ε/(1 − (1−ε)e^{−iw})]^N
    (`exact`), −k(w − sin w) (`published`) or −k·sin w (`leading`). Source: Tantalo 1996, eq. 4.58.
    Erratum: expanded in w, the published phase starts with a w³ term; for N transfers, it must
    start with −k·w.
    """

    formulas = (
        Formula(
            r"\theta=-N\,\arctan\frac{(1-\varepsilon)\,\sin w}{1-(1-\varepsilon)\,\cos w},\quad "
            r"w=2\pi\,\xi\,\Delta",
            where="ε: charge transfer efficiency; N: transfers; Δ: sampling interval of the "
            "image, or detector pitch",
            when="exact",
        ),
        Formula(r"\theta=-N(1-\varepsilon)(w-\sin w)", when="published"),
        Formula(r"\theta=-N(1-\varepsilon)\,\sin w", when="leading"),
    )

    def run(self, context: Context, phase: Phase, here: NodeContext) -> PtfOutputs:
        factors = separable(
            charge_transfer_ptf,
            x=None if self.neutral() else self.law(),
            part="ptf",
            argument="phase_per_transfer",
            scale_x=self.phase_per_frequency(context),
            label=self.title,
            node=here.node,
        )
        return self.ptf_outputs(phase, *factors)
