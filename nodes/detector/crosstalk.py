"""Crosstalk: a pixel's neighbours get a share of its signal."""

from typing import Any

from core.chain.wires import Context, Magnitude, Phase
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.detector.detector_mtf import crosstalk_kernel, crosstalk_otf
from core.physics.sampling.detector_sampling import ifov_mrad
from core.transfer.factors import Law, Planar
from nodes.shared.context_defaults import of_context, unlinked_phase_caution
from nodes.shared.module_ports import Apply, NyquistReadouts, OtfOutputs, otf_outputs

_NONE = "0 0 0; 0 1 0; 0 0 0"


class Crosstalk(NyquistReadouts, key="crosstalk", title="Crosstalk", group="Detector"):
    """Blur by crosstalk: each pixel passes a share of its signal to its neighbours.

    The kernel gives the shares of a pixel's signal that stay in the pixel and that leak into each
    neighbour. Enter 3 × 3 or 5 × 5 numbers that add up to 1, with semicolons between the rows. The
    kernel covers optical crosstalk, electrical crosstalk and interpixel capacitance. An asymmetric
    kernel also shifts the picture. To include this shift, connect `phase`. Sources: Holst and
    Lomheim 2007, chapter 10; Moore, Ninkov and Forrest 2006, Optical Engineering 45, 076402
    (interpixel capacitance).
    """

    formulas = (
        Formula(
            r"H(\xi,\eta)=\sum_{m,n}k_{mn}\,e^{-2\pi i(\xi n p_x+\eta m p_y)}",
            where="k: kernel; p: pixel pitch, mrad; m, n: rows down and columns to the right",
        ),
    )

    kernel: str = param(
        _NONE,
        "shares of a pixel's signal that stay or leak, as 3 × 3 or 5 × 5 numbers "
        "with semicolons between the rows",
    )
    apply: Apply = "multiply"

    panel = (Section("Crosstalk", "kernel"), Section("Output", "apply"))

    def check(self) -> None:
        crosstalk_kernel(self.kernel)

    def run(
        self, context: Context, magnitude: Magnitude, here: NodeContext, phase: Phase | None = None
    ) -> OtfOutputs:
        kernel = crosstalk_kernel(self.kernel)
        if self.lost() == 0.0:
            return otf_outputs(self.apply, magnitude, phase, blur=(), label=self.title)
        focal = of_context("focal_length_mm", context)
        pitch_x, pitch_y = (
            ifov_mrad(pitch_um=of_context(name, context), focal_length_mm=focal)
            for name in ("detector_x_um", "detector_y_um")
        )
        law = Law.of(crosstalk_otf, kernel=kernel, pitch_x_mrad=pitch_x, pitch_y_mrad=pitch_y)
        how: dict[str, Any] = {"symmetric": False, "label": self.title, "node": here.node}
        blur = (Planar(law, take="modulus", **how),)
        shift = (Planar(law, take="phase", **how),)
        return otf_outputs(self.apply, magnitude, phase, blur=blur, shift=shift, label=self.title)

    def lost(self) -> float:
        kernel = crosstalk_kernel(self.kernel)
        return 1.0 - kernel[len(kernel) // 2][len(kernel) // 2]

    @warning
    def no_phase(self, outputs: OtfOutputs) -> Caution | None:
        """The PTF is not applied to the picture."""
        kernel = crosstalk_kernel(self.kernel)
        if kernel == tuple(row[::-1] for row in kernel[::-1]):
            return None
        return unlinked_phase_caution(self.apply, outputs.phase, outputs.ptf)

    @readout("%")
    def crosstalk_percent(self) -> float:
        """Share of a pixel's signal that leaks into its neighbours."""
        return 100.0 * self.lost()
