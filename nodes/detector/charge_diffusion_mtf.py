"""Charge Diffusion MTF: carriers diffuse before they are collected."""

from typing import Any

from core.chain.wires import Context, Magnitude
from core.errors import ParameterError
from core.modules.declaration import Formula, NodeContext, Section, param, readout
from core.physics.detector.detector_mtf import Side, band_diffusion_mtf, silicon_absorption_per_um
from core.physics.radiometry.planck import band_nodes
from nodes.shared.context_defaults import given_band, of_context
from nodes.shared.module_ports import CutOff, CutOn, MtfModule, MtfOutputs, radial

_SILICON_UM = (0.25, 1.2)


class ChargeDiffusionMTF(
    MtfModule, key="charge_diffusion_mtf", title="Charge Diffusion MTF", group="Detector"
):
    """Blur by charge diffusion: carriers generated outside the depletion region diffuse into it.

    With front illumination, the MTF is [1 − e^(−αd)/(1 + αL_f)]/[1 − e^(−αd)/(1 + αL₀)], with L_f =
    L₀/√(1 + (2πL₀f)²). Here, α is the absorption coefficient, d is depletion_um, L₀ is
    diffusion_length_um, and f is the frequency on the detector. For back illumination, the detector
    is assumed to be thinned, with a passivated surface. Most carriers in a back-illuminated
    detector are generated near the back and cross the undepleted silicon (thickness_um minus
    depletion_um). If absorption_per_um is empty, the MTF is averaged from cut_on_um to cut_off_um
    (empty: over the picture's band), for silicon at 295 K. The average assumes the same number of
    photons at all wavelengths and weights each wavelength by the carriers generated. With front
    illumination, red and near-infrared light is blurred most, because it is absorbed deep in the
    silicon. With back illumination, blue light is blurred most. Sources: Seib 1974; Crowell and
    Labuda 1969; Holst and Lomheim 2007, chapter 10; Schinke et al. 2015 (silicon).
    """

    formulas = (
        Formula(
            r"H(f)=\frac{1-\dfrac{e^{-\alpha d}}{1+\alpha L_f}}{1-\dfrac{e^{-\alpha d}}{1+\alpha "
            r"L_0}},\quad L_f=\frac{L_0}{\sqrt{1+(2\pi L_0 f)^2}}",
            where="α: absorption coefficient; d: depth of the depletion region; L₀: diffusion "
            "length; f: radial frequency on the detector",
            when="front",
        ),
        Formula(
            r"\eta(k)=\int_0^{b}\alpha e^{-\alpha x}\,\frac{\cosh kx}{\cosh kb}\,dx+e^{-\alpha b}"
            r"\left(1-e^{-\alpha d}\right),\quad H=\frac{\eta(1/L_f)}{\eta(1/L_0)}",
            where="b: thickness minus d; x: depth from the back",
            when="back",
        ),
    )

    depletion_um: float = param(5.0, "depth of the depletion region", (0, 1e4), slider=(0, 50))
    diffusion_length_um: float = param(
        50.0, "diffusion length outside the depletion region", (0, 1e6), above=True, slider=(1, 200)
    )
    absorption_per_um: float | None = param(
        None,
        "absorption coefficient; empty: computed for silicon over the band",
        (0, 1e6),
        slider=(0.005, 1),
    )
    side: Side = param("front", "illuminated side")
    thickness_um: float | None = param(
        None, "thickness of a back-illuminated detector", (0, 1e4), slider=(5, 300)
    )
    cut_on_um: CutOn = None
    cut_off_um: CutOff = None

    panel = (
        Section("", "apply"),
        Section("Detector", "depletion_um diffusion_length_um side"),
        Section("", "thickness_um", shown_when=("side", ("back",))),
        Section("Absorption", "absorption_per_um cut_on_um cut_off_um"),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        factors = radial(band_diffusion_mtf, label=self.title, node=here.node, **self.law(context))
        return self.mtf_outputs(magnitude, *factors)

    def law(self, context: Context) -> dict[str, Any]:
        absorptions, weights = self._absorptions(context)
        law: dict[str, Any] = {
            "focal_length_mm": of_context("focal_length_mm", context),
            "absorptions_per_um": absorptions,
            "weights": weights,
            "depletion_um": self.depletion_um,
            "diffusion_length_um": self.diffusion_length_um,
            "side": self.side,
            "thickness_um": self.thickness_um if self.side == "back" else None,
        }
        band_diffusion_mtf(rho=0.0, **law)  # refuses a thickness at once
        return law

    def _absorptions(self, context: Context) -> tuple[tuple[float, ...], tuple[float, ...]]:
        if self.absorption_per_um is not None:
            return (self.absorption_per_um,), (1.0,)
        low, high = given_band(self.cut_on_um, self.cut_off_um, context.band_um)
        for name, end in (("cut_on_um", low), ("cut_off_um", high)):
            if not _SILICON_UM[0] <= end <= _SILICON_UM[1]:
                allowed = (
                    f"{_SILICON_UM[0]:g} to {_SILICON_UM[1]:g} µm, where silicon absorbs; "
                    "for other wavelengths, give absorption_per_um"
                )
                raise ParameterError(name, end, allowed)
        if low == high:
            return tuple(silicon_absorption_per_um(wavelength_um=[low]).tolist()), (1.0,)
        wavelength, width = band_nodes(low, high, ())
        absorption = silicon_absorption_per_um(wavelength_um=wavelength)
        return tuple(absorption.tolist()), tuple(width.tolist())

    @readout("1/µm")
    def mean_absorption_per_um(self, context: Context) -> float:
        """Mean absorption coefficient over the band."""
        absorptions, weights = self._absorptions(context)
        return sum(a * w for a, w in zip(absorptions, weights, strict=True)) / sum(weights)
