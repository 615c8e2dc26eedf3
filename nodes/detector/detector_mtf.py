"""MTFs of a detector: aperture, diffusion, crosstalk, charge transfer and TDI."""

import math
from typing import Any, Literal

from core.chain.wires import Context, Magnitude, Phase
from core.errors import ParameterError, several
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.physics.detector import detector_mtf as physics
from core.physics.numerics import positive
from core.physics.radiometry.planck import band_nodes
from core.physics.sampling.detector_sampling import ifov_mrad
from core.transfer.factors import Law, Planar
from nodes.shared.context_defaults import (
    ELECTRONICS,
    apart_caution,
    apart_from_context,
    check_given,
    context_warning,
    first,
    given,
    given_band,
    of_context,
    phase_warning,
    pixel_mrad,
)
from nodes.shared.module_ports import (
    Apply,
    CutOff,
    CutOn,
    MtfModule,
    MtfOutputs,
    NyquistReadouts,
    OtfOutputs,
    PtfModule,
    PtfOutputs,
    otf_outputs,
    radial,
    separable,
)


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
        return self.separated(magnitude, here, physics.aperture_mtf, x=x, y=y)

    geometry = context_warning(
        "The pitch, fill factor or focal length differs from the value on Init & Trans.",
        "detector_x_um detector_y_um focal_length_mm fill_x fill_y",
        where=ELECTRONICS,
    )

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
        return physics.first_zero_cyc_per_mrad(effective_ifov_mrad=self.ifov_x_mrad(axis, context))


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
    side: physics.Side = param("front", "illuminated side")
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
        factors = radial(
            physics.band_diffusion_mtf, label=self.title, node=here.node, **self.law(context)
        )
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
        physics.band_diffusion_mtf(rho=0.0, **law)  # refuses a thickness at once
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
            return tuple(physics.silicon_absorption_per_um(wavelength_um=[low]).tolist()), (1.0,)
        wavelength, width = band_nodes(low, high, ())
        absorption = physics.silicon_absorption_per_um(wavelength_um=wavelength)
        return tuple(absorption.tolist()), tuple(width.tolist())

    @readout("1/µm")
    def mean_absorption_per_um(self, context: Context) -> float:
        """Mean absorption coefficient over the band."""
        absorptions, weights = self._absorptions(context)
        return sum(a * w for a, w in zip(absorptions, weights, strict=True)) / sum(weights)


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
        physics.crosstalk_kernel(self.kernel)

    def run(
        self, context: Context, magnitude: Magnitude, here: NodeContext, phase: Phase | None = None
    ) -> OtfOutputs:
        kernel = physics.crosstalk_kernel(self.kernel)
        if self.lost() == 0.0:
            return otf_outputs(self.apply, magnitude, phase, blur=(), label=self.title)
        focal = of_context("focal_length_mm", context)
        pitch_x, pitch_y = (
            ifov_mrad(pitch_um=of_context(name, context), focal_length_mm=focal)
            for name in ("detector_x_um", "detector_y_um")
        )
        law = Law.of(
            physics.crosstalk_otf, kernel=kernel, pitch_x_mrad=pitch_x, pitch_y_mrad=pitch_y
        )
        how: dict[str, Any] = {"symmetric": False, "label": self.title, "node": here.node}
        blur = (Planar(law, take="modulus", **how),)
        shift = (Planar(law, take="phase", **how),)
        return otf_outputs(self.apply, magnitude, phase, blur=blur, shift=shift, label=self.title)

    def lost(self) -> float:
        kernel = physics.crosstalk_kernel(self.kernel)
        return 1.0 - kernel[len(kernel) // 2][len(kernel) // 2]

    @warning
    def no_phase(self, outputs: OtfOutputs) -> Any:
        """The PTF is not applied to the picture."""
        kernel = physics.crosstalk_kernel(self.kernel)
        if kernel == tuple(row[::-1] for row in kernel[::-1]):
            return None
        return phase_warning(self, outputs)

    @readout("%")
    def crosstalk_percent(self) -> float:
        """Share of a pixel's signal that leaks into its neighbours."""
        return 100.0 * self.lost()


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
        return self.separated(magnitude, here, physics.charge_transfer_mtf, **self.law(context))


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
        return self.ptf_outputs(phase, *separable(physics.charge_transfer_ptf, **how))


class TdiMTF(MtfModule, key="tdi_mtf", title="TDI MTF", group="Detector"):
    """Blur by time delay and integration: stepwise charge motion and a velocity mismatch.

    With phase measured from the middle of the exposure, the transfer function is sinc((1 +
    m)·s·f)·sin(πNm·s·f)/(N·sin(πm·s·f)). Here, m is the image velocity divided by the charge
    velocity, minus 1; s is the pitch divided by `phases`, and N = stages·phases. With
    `line_rate_Hz`, m follows from the scene's velocity and range (Init & Trans, or Camera's orbit).
    At a yaw ψ, the ratio of image velocity to charge velocity is (1 + m)·cos ψ along the stages and
    (1 + m)·sin ψ across them. Use this module instead of Alongtrack MTF: the step s already
    includes the smear within a stage. With `phases` = 0, the charge moves without steps. Empty
    parameters are taken from Init & Trans. Source: Wong, Yao and Schlig 1992, IBM J. Res. Develop.
    36; Holst and Lomheim 2007, chapter 10.
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
            law = Law.of(physics.tdi_askew_mtf, drift=drift, direction=self.direction, **how)
            askew = Planar(law, symmetric=False, label=self.title, node=here.node)
            return self.mtf_outputs(magnitude, askew)
        return self.separated(magnitude, here, physics.tdi_mtf, **{self.direction: how})

    def _how(self, context: Context) -> dict[str, Any]:
        pitch_mrad = ifov_mrad(
            pitch_um=given(f"detector_{self.direction}_um", self.detector_um, context),
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
        return physics.image_motion(velocity_mismatch=mismatch, yaw_deg=self.yaw_deg)

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
        return physics.smear_mrad(**self._how(context))[0]

    @readout("mrad")
    def drift_mrad(self, context: Context) -> float:
        """Distance between image and charge, along the stages, after the last stage."""
        return physics.smear_mrad(**self._how(context))[1]

    @readout("%")
    def mismatch_percent(self, context: Context) -> float:
        """How much faster the image moves along the stages than the charge."""
        return 100.0 * float(self._how(context)["velocity_mismatch"])

    @readout("px")
    def drift_across_px(self, context: Context) -> float:
        """Drift of the image across the stages, per stage."""
        return self._motion(float(self._how(context)["pitch_mrad"]), context)[1]
