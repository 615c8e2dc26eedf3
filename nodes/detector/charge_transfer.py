"""Charge Transfer MTF and Phase: contrast lost and delay by incomplete charge transfer."""

import math
from typing import Any, Literal

from core.chain.wires import Context, Magnitude, Phase
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from nodes.shared.context_defaults import pixel_mrad
from nodes.shared.module_ports import MtfModule, MtfOutputs, PtfModule, PtfOutputs, separable


class ChargeTransfer(Module):
    """Parameters of incomplete charge transfer along the read-out direction (x)."""

    detectors_per_line: int = param(640, "number of transfers", (0, 10**9), slider=(1, 4096))
    efficiency: float = param(
        0.99999,
        "charge transfer efficiency: fraction of the charge that each transfer passes on",
        (0, 1),
    )
    model: Literal["exact", "published", "leading"] = param(
        "exact",
        "exact: product over all transfers; published: eqs. 4.57-4.58 of Tantalo 1996; leading: "
        "leading term only",
    )
    nyquist: Literal["image", "detector"] = param(
        "image", "distance between charge packets: one image sample, or one detector pitch"
    )

    panel = (
        Section("", "apply"),
        Section("Charge transfer", "detectors_per_line efficiency model nyquist"),
    )

    def law(self, context: Context) -> dict[str, Any]:
        """How `separable` takes it: w per cycle/mrad is 2π times the packets' distance in mrad."""
        image = self.nyquist == "image"
        distance = context.grid.interval_x_mrad if image else pixel_mrad("x", context)
        how = {
            "transfers": self.detectors_per_line,
            "efficiency": self.efficiency,
            "model": self.model,
        }
        neutral = self.detectors_per_line == 0 or self.efficiency == 1.0
        return {
            "x": None if neutral else how,
            "argument": "phase_per_transfer",
            "scale_x": 2 * math.pi * distance,
        }


class ChargeEffMTF(
    ChargeTransfer, MtfModule, key="charge_eff_mtf", title="Charge Transfer MTF", group="Detector"
):
    """Blur along the read-out direction (x) from incomplete charge transfer.

    With w = 2π·xi·Δ, the MTF is |ε/(1 − (1−ε)e^{−iw})|^N (`exact`) or exp(−N(1−ε)(1 − cos w))
    (`published` and `leading`). Source: Tantalo 1996, eq. 4.57, after LeBlanc and Contini 1990.
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
        return self.separated(magnitude, here, charge_transfer_mtf, **self.law(context))


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
        how = {"part": "ptf", "label": self.title, "node": here.node, **self.law(context)}
        return self.ptf_outputs(phase, *separable(charge_transfer_ptf, **how))
