"""Detector MTF: the detector averages over its sensitive area."""

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.detector.detector_mtf import aperture_mtf, first_zero_cyc_per_mrad
from core.physics.sampling.detector_sampling import ifov_mrad
from nodes.shared.context_defaults import ELECTRONICS, apart_from_context, check_given, given
from nodes.shared.module_ports import MtfModule, MtfOutputs


class DetectorMTF(MtfModule, key="detector_mtf", title="Detector MTF", group="Detector"):
    """Blur by averaging over the sensitive area of a detector element.

    The MTF is sinc(IFOVx·fill_x·ξ)·sinc(IFOVy·fill_y·η), including its negative lobes. Empty
    parameters are taken from Init & Trans. Source: Tantalo 1996, eqs. 4.41 to 4.50.
    """

    formulas = (
        Formula(
            r"H(\xi,\eta)=\mathrm{sinc}\left(\frac{p_x\varphi_x}{f}\,\xi\right)\mathrm{sinc}"
            r"\left(\frac{p_y\varphi_y}{f}\,\eta\right)",
            where="p: pitch, µm; φ: fill factor; f: focal length, mm; negative lobes are kept",
        ),
    )

    detector_x_um: float | None = param(
        None, "horizontal detector pitch; empty: from Init & Trans", low=0, slider=(1, 1000)
    )
    detector_y_um: float | None = param(
        None, "vertical detector pitch; empty: from Init & Trans", low=0, slider=(1, 1000)
    )
    focal_length_mm: float | None = param(
        None, "effective focal length; empty: from Init & Trans", low=0, slider=(10, 1000)
    )
    fill_x: float | None = param(None, "horizontal fill factor; empty: from Init & Trans", (0, 1))
    fill_y: float | None = param(None, "vertical fill factor; empty: from Init & Trans", (0, 1))

    panel = (
        Section("", "apply"),
        Section("Detector", "detector_x_um detector_y_um focal_length_mm"),
        Section("Fill factors", "fill_x fill_y"),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        check_given(self, context, "detector_x_um", "detector_y_um", "focal_length_mm")
        x, y = ({"effective_ifov_mrad": self.ifov_x_mrad(axis, context)} for axis in "xy")
        return self.separated(magnitude, here, aperture_mtf, x=x, y=y)

    @warning
    def geometry(self, context: Context) -> Caution | None:
        """The pitch, fill factor or focal length differs from the value on Init & Trans."""
        names = ("detector_x_um", "detector_y_um", "focal_length_mm", "fill_x", "fill_y")
        return apart_from_context(self, context, *names, where=ELECTRONICS)

    @readout("mrad")
    def ifov_x_mrad(self, axis: str, context: Context) -> float:
        """Horizontal instantaneous field of view times the fill factor."""
        pitch, fill = f"detector_{axis}_um", f"fill_{axis}"
        return ifov_mrad(
            pitch_um=given(pitch, getattr(self, pitch), context),
            focal_length_mm=given("focal_length_mm", self.focal_length_mm, context),
            fill=given(fill, getattr(self, fill), context),
        )

    @readout("cyc/mrad")
    def first_zero_x(self, axis: str, context: Context) -> float:
        """First zero of the horizontal MTF."""
        return first_zero_cyc_per_mrad(effective_ifov_mrad=self.ifov_x_mrad(axis, context))
