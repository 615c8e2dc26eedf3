"""TDI MTF: charge that is clocked along with a moving image."""

import math
from typing import Any, Literal

from core.chain.wires import Context, Magnitude
from core.errors import several
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.detector.detector_mtf import image_motion, smear_mrad, tdi_askew_mtf, tdi_mtf
from core.physics.numerics import positive
from core.physics.sampling.detector_sampling import ifov_mrad
from core.transfer.factors import Law, Planar
from nodes.shared.context_defaults import (
    ELECTRONICS,
    apart_caution,
    apart_from_context,
    first,
    given,
    of_context,
)
from nodes.shared.module_ports import MtfModule, MtfOutputs


class TdiMTF(MtfModule, key="tdi_mtf", title="TDI MTF", group="Detector"):
    """Blur by time delay and integration: stepwise charge motion and a velocity mismatch.

    With phase measured from the middle of the exposure, the transfer function is sinc((1 +
    m)·s·f)·sin(πNm·s·f)/(N·sin(πm·s·f)). Here, m is the image velocity divided by the charge
    velocity, minus 1; s is the pitch divided by `phases`, and N = stages·phases. With
    `line_rate_Hz`, m follows from the scene's velocity and range (Init & Trans, or Camera's orbit).
    At a yaw ψ, the image velocity over the charge velocity is (1 + m)·cos ψ along and (1 + m)·sin ψ
    across the stages. Use this module instead of Alongtrack MTF: the step s already includes the
    smear within a stage. With `phases` = 0, the charge moves without steps. Empty parameters are
    taken from Init & Trans. Source: Wong, Yao and Schlig 1992, IBM J. Res. Develop. 36; Holst and
    Lomheim 2007, chapter 10.
    """

    formulas = (
        Formula(
            r"H(f)=\mathrm{sinc}\left[(1+m)\,s\,f\right]\;\frac{\sin(\pi N m s f)}{N\,\sin(\pi "
            r"m s f)}",
            where="m: velocity mismatch, image velocity over charge velocity minus 1; s: pitch "
            "over phases, mrad; N: stages times phases",
        ),
    )

    stages: int = param(64, "number of stages whose charge is summed", (1, 10000), slider=(1, 128))
    phases: int = param(
        4,
        "clock phases per stage: the charge moves once per phase; 0: smooth motion",
        (0, 100),
        slider=(0, 8),
    )
    velocity_mismatch_percent: float = param(
        0.0, "how much faster the image moves than the charge", (-99, 1000), slider=(-5, 5)
    )
    line_rate_Hz: float | None = param(
        None,
        "line rate at which the charge moves; empty: velocity_mismatch_percent is used",
        low=0,
        slider=(1000, 50000),
    )
    yaw_deg: float = param(
        0.0, "angle from the stages to the image motion", (-89, 89), slider=(-5, 5)
    )
    direction: Literal["y", "x"] = param("y", "axis of the motion: vertical (y) or horizontal (x)")
    detector_um: float | None = param(
        None,
        "pitch of the stages; empty: the detector's pitch along the motion",
        low=0,
        slider=(1, 100),
    )
    focal_length_mm: float | None = param(None, "effective focal length", low=0, slider=(10, 10000))

    panel = (
        Section("", "apply"),
        Section("Clock", "stages phases velocity_mismatch_percent line_rate_Hz"),
        Section("Stages", "direction yaw_deg detector_um focal_length_mm"),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        if not (self.phases or self.velocity_mismatch_percent or self.line_rate_Hz or self.yaw_deg):
            return self.mtf_outputs(magnitude)
        how, drift = self._how(context), self.drift_across_px(context)
        if drift:
            law = Law.of(tdi_askew_mtf, drift=drift, direction=self.direction, **how)
            askew = Planar(law, symmetric=False, label=self.title, node=here.node)
            return self.mtf_outputs(magnitude, askew)
        along = how if self.direction == "y" else None
        across = how if self.direction == "x" else None
        return self.separated(magnitude, here, tdi_mtf, x=across, y=along)

    def _how(self, context: Context) -> dict[str, Any]:
        name = f"detector_{self.direction}_um"
        own = {"detector_y_um": self.detector_um, "detector_x_um": self.detector_um}
        pitch_mrad = ifov_mrad(
            pitch_um=given(name, own[name], context),
            focal_length_mm=given("focal_length_mm", self.focal_length_mm, context),
        )
        return {
            "pitch_mrad": pitch_mrad,
            "stages": self.stages,
            "phases": self.phases,
            "velocity_mismatch": self._motion(pitch_mrad, context)[0],
        }

    def _motion(self, pitch_mrad: float, context: Context) -> tuple[float, float]:
        mismatch = self.velocity_mismatch_percent / 100.0
        if self.line_rate_Hz:
            speed = positive("velocity_m_per_s", abs(context.velocity_m_per_s), unit="m/s")
            range_m = of_context("range_m", context)
            mismatch = 1000.0 * speed / range_m / self.line_rate_Hz / pitch_mrad - 1.0
        return image_motion(velocity_mismatch=mismatch, yaw_deg=self.yaw_deg)

    @warning
    def geometry(self, context: Context) -> Caution | None:
        """The pitch or focal length differs from the value on Init & Trans."""
        pitch = getattr(context, f"detector_{self.direction}_um")
        return first(
            apart_caution("detector_um", self.detector_um, pitch, where=ELECTRONICS),
            apart_from_context(self, context, "focal_length_mm", where=ELECTRONICS),
        )

    @warning
    def apart(self, context: Context) -> Caution | None:
        """Image and charge drift more than two pixels apart, or two parameters set the mismatch."""
        typed = self.velocity_mismatch_percent
        if self.line_rate_Hz and typed:
            return Caution(
                f"velocity_mismatch_percent = {typed:g} % is not used: line_rate_Hz determines the "
                "mismatch",
                "leave line_rate_Hz empty, or set velocity_mismatch_percent to 0",
            )
        if not (typed or self.line_rate_Hz or self.yaw_deg):
            return None
        along, across = self.mismatch_percent(context), self.drift_across_px(context)
        pixels = math.hypot(self.stages * along / 100.0, self.stages * across)
        if pixels <= 2.0:
            return None
        askew = f" and a yaw of {self.yaw_deg:g}°" if self.yaw_deg else ""
        return Caution(
            f"the MTF at Nyquist is almost zero: over {several(self.stages, 'stage')}, the image "
            f"moves {pixels:.3g} pixels away from its charge at a mismatch of {along:.4g} %{askew}",
            "lower the mismatch, yaw_deg or stages",
        )

    @readout("mrad")
    def step_mrad(self, context: Context) -> float:
        """Smear of the image during one clock step, while the charge does not move."""
        return smear_mrad(**self._how(context))[0]

    @readout("mrad")
    def drift_mrad(self, context: Context) -> float:
        """Distance between image and charge, along the stages, after the last stage."""
        return smear_mrad(**self._how(context))[1]

    @readout("%")
    def mismatch_percent(self, context: Context) -> float:
        """How much faster the image moves along the stages than the charge."""
        return 100.0 * float(self._how(context)["velocity_mismatch"])

    @readout("px")
    def drift_across_px(self, context: Context) -> float:
        """Drift of the image across the stages, per stage."""
        return self._motion(float(self._how(context)["pitch_mrad"]), context)[1]
