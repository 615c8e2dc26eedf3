"""TDI MTF: charge that is clocked along with a moving image."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from core.chain.wires import Context, Magnitude
from core.modules.declaration import NodeContext, readout, warning
from core.modules.panel_sections import Caution, Section
from core.modules.parameters import Formula, Param
from core.physics.detector.detector_mtf import smear_mrad, tdi_mtf
from core.physics.sampling.detector_sampling import ifov_mrad
from nodes.shared.context_defaults import given
from nodes.shared.factors import separable
from nodes.shared.module_ports import MtfModule, MtfOutputs
from nodes.shared.shared_warnings import ELECTRONICS, apart_caution, apart_from_context, first


class TdiMTF(MtfModule, key="tdi_mtf", title="TDI MTF", group="Detector"):
    """Blur by time delay and integration: charge steps, and a velocity mismatch with the image.

    About the exposure's middle: sinc((1 + m)·s·f)·sin(πNm·s·f)/(N·sin(πm·s·f)). m is the image
    velocity divided by the charge velocity, minus 1. s is the pitch divided by `phases`, and N =
    stages·phases. Use it instead of Alongtrack MTF, whose smear within a stage is the step s here.
    With `phases` = 0 the charge moves without steps. Empty parameters are taken from Init & Trans.
    Source: Wong, Yao and Schlig 1992, IBM J. Res. Develop. 36; Holst and Lomheim 2007, chapter 10.
    """

    formulas = (
        Formula(
            r"H(f)=\mathrm{sinc}\left[(1+m)\,s\,f\right]\;\frac{\sin(\pi N m s f)}{N\,\sin(\pi "
            r"m s f)}",
            where="m: image velocity over charge velocity, minus 1; s: pitch over phases, "
            "mrad; N: stages times phases",
        ),
    )

    stages: Annotated[
        int, Param("stages whose charge is added", low=1, high=10000, slider=(1, 128))
    ] = 64
    phases: Annotated[
        int,
        Param("clock phases per stage, in which the charge moves; 0: smooth motion",
              low=0, high=100,
              slider=(0, 8)),
    ] = 4  # fmt: skip
    velocity_mismatch_percent: Annotated[
        float,
        Param("how much faster the image moves than the charge", unit="%", low=-99, high=1000,
              slider=(-5, 5)),
    ] = 0.0  # fmt: skip
    direction: Annotated[
        Literal["y", "x"], Param("axis of the motion: vertical (y) or horizontal (x)")
    ] = "y"
    detector_um: Annotated[
        float | None,
        Param("pitch of the stages; empty: the detector's pitch along the motion", unit="µm", low=0,
              slider=(1, 100)),
    ] = None  # fmt: skip
    focal_length_mm: Annotated[
        float | None, Param("effective focal length", unit="mm", low=0, slider=(10, 10000))
    ] = None

    panel = (
        Section("", ("apply",)),
        Section("Clock", ("stages", "phases", "velocity_mismatch_percent")),
        Section("Stages", ("direction", "detector_um", "focal_length_mm")),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        if not self.phases and not self.velocity_mismatch_percent:
            return self.mtf_outputs(magnitude)
        how = self._how(context)
        along = how if self.direction == "y" else None
        across = how if self.direction == "x" else None
        factors = separable(tdi_mtf, x=across, y=along, label=self.title, node=here.node)
        return self.mtf_outputs(magnitude, *factors)

    def _how(self, context: Context) -> dict[str, Any]:
        name = f"detector_{self.direction}_um"
        own = {"detector_y_um": self.detector_um, "detector_x_um": self.detector_um}
        return {
            "pitch_mrad": ifov_mrad(
                pitch_um=given(name, own[name], context, unit="µm"),
                focal_length_mm=given("focal_length_mm", self.focal_length_mm, context, unit="mm"),
            ),
            "stages": self.stages,
            "phases": self.phases,
            "velocity_mismatch": self.velocity_mismatch_percent / 100.0,
        }

    @warning
    def geometry(self, context: Context) -> Caution | None:
        """The pitch or focal length differs from the one on Init & Trans."""
        pitch = getattr(context, f"detector_{self.direction}_um")
        return first(
            apart_caution("detector_um", self.detector_um, pitch, unit="µm", where=ELECTRONICS),
            apart_from_context(self, context, "focal_length_mm", where=ELECTRONICS),
        )

    @warning
    def apart(self) -> Caution | None:
        """Image and charge move apart by more than two pixels."""
        pixels = abs(self.stages * self.velocity_mismatch_percent / 100.0)
        if pixels <= 2.0:
            return None
        return Caution(
            f"the MTF at Nyquist is almost zero: over {self.stages} stages a mismatch of "
            f"{self.velocity_mismatch_percent:g} % moves the image {pixels:.3g} pixels away "
            "from its charge",
            "lower velocity_mismatch_percent or stages",
        )

    @readout("mrad")
    def step_mrad(self, context: Context) -> float:
        """Smear of the image during one clock step, while the charge does not move."""
        return smear_mrad(**self._how(context))[0]

    @readout("mrad")
    def drift_mrad(self, context: Context) -> float:
        """Distance between image and charge after all stages."""
        return smear_mrad(**self._how(context))[1]
