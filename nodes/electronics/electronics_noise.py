"""Electronics & Noise: what detectors, amplifier and quantizer do to the picture."""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.chain.engine import PlannedNode
from core.chain.wires import Context, Image, Table, Transfer
from core.errors import ImagechainError, ParameterError, UnconnectedError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.modules import preview as charts
from core.modules.declaration import NodeContext, declaration, warning
from core.modules.parameters import Caution, Formula, Offer, Section, param
from core.physics.detector import detectivity
from core.physics.detector import readout as filters
from core.physics.noise.noise_equivalent import detector_area_cm2
from core.physics.radiometry.spectra import MANUAL, MATERIALS_BY_REGION, Material, find_material
from core.records import replace
from core.transfer.factors import Separable
from nodes.electronics import noise_steps as steps
from nodes.electronics.noise_steps import detector_figures, figures
from nodes.input_output.sample_unit import radiance_caution
from nodes.shared import context_defaults
from nodes.shared.context_defaults import apart_caution, band_warning, is_radiance, unit_warning
from nodes.shared.deviates import SEED_SECTIONS, SeededModule
from nodes.shared.module_ports import CutOff, CutOn, separable, transfers
from nodes.shared.steps import difference, filtered_lines, picture_range, quantized

_MATERIALS = tuple(
    (region, (*(material.name for material in materials), MANUAL))
    for region, materials in MATERIALS_BY_REGION.items()
)
_DECADES = 2.3  # below the highest D* that the preview shows
_PREVIEW_POINTS = 241
_SHORTEST = 0.15  # wavelengths from that share of the cut-off on
_CONVERTER_BITS = (*range(1, 25), 32, 64)


class ElectronicsOutputs(NamedTuple):
    image: Image
    noise: Image
    detector_noise: Image
    quantization_error: Image
    mtf: Transfer
    ptf: Transfer
    table: Table


class ElectronicsNoise(
    SeededModule, key="electronics_noise", title="Electronics & Noise", group="Electronics & Noise"
):
    """Simulate read-out electronics: gain and bias, detector and amplifier noise, quantization.

    The first steps are gain and bias errors of each detector, and detector noise, whose rms is NER.
    Then the pre-amplifier's single pole, 1/(1 + 2πi·τ·v·ξ), filters along the scan. The last steps
    are amplifier noise, whose rms is reference/SNR, a post filter and quantization. NEP and NER
    refer to a detector with mean noise. NETD and SNR use the rms noise over all detectors, which is
    √(1 + v²) times the mean noise for a relative spread v. Sources: Tantalo 1996, sections 4.6,
    4.7, 4.9 and 4.10. Erratum: eq. 4.59 as printed scales the picture by the gain error
    (`literal`).
    """

    formulas = (
        Formula(
            r"\mathrm{NEP}=\frac{\sqrt{A\,\Delta f}}{D^*},\quad\mathrm{NER}=\frac{\mathrm{NEP}"
            r"\;G_\#}{A},\quad G_\#=\frac{1+4F^2}{\pi\,\tau_o\,\tau_f\left(1-\varepsilon^2\right)}",
            where="A: sensitive area of the detector; Δf: bandwidth; D*: specific "
            "detectivity over the band; τ: transmissions of optics and filter",
        ),
        Formula(
            r"\Delta f=\frac{1}{2\,\tau},\quad\mathrm{NETD}=\frac{\sqrt{\mathrm{NER}^2+"
            r"\sigma_a^2}}{\partial L/\partial T},\quad\sigma_a=\frac{\mathrm{reference}}{"
            r"\mathrm{SNR}}",
            where="τ: time constant, by default the dwell time; σ_a: the amplifier's noise",
        ),
        Formula(
            r"L'=L\,(1+g\,n_1)+b\,n_2\,\overline{L}",
            where="g, b: gain_percent and bias_percent over 100; n: a normal deviate for each "
            "detector",
            when="gain_model per_pixel",
        ),
        Formula(
            r"H(\xi)=\frac{1}{1+2\pi i\,\tau\,v\,\xi}",
            where="v: scan velocity, mrad/s",
            when="use_mtf",
        ),
        Formula(
            r"q=\frac{L_{high}-L_{low}}{2^b-1}",
            where="q: step of a b-bit quantizer; L_low, L_high: lowest and highest levels",
        ),
    )

    cut_on_um: CutOn = None
    cut_off_um: CutOff = None
    region: Literal["VIS", "MWIR", "LWIR"] = param("VIS", "wavelength region")
    material: Literal["HgCdTe", "InSb", "PtSi", "Si", "Si:Ga", "Si:As", "manual"] = param(
        "HgCdTe", "detector material, for D*"
    )
    d_star: float | None = param(
        None, "D*, used instead of the material's D*", low=0, unit="cm √Hz/W"
    )
    optics_transmission: float = param(
        1.0, "transmission of the optics, without the obscuration", (0, 1), above=True
    )
    filter_transmission: float = param(
        1.0, "transmission of the optical filter", (0, 1), above=True
    )
    scan_mirror_rate_Hz: float | None = param(
        None, "rotation rate of the scan mirror; empty: scan velocity from Init & Trans", low=0
    )
    time_constant_s: float | None = param(
        None, "detector time constant; empty: the dwell time", low=0
    )
    bandwidth_Hz: float | None = param(None, "noise bandwidth; empty: 1/(2τ)", low=0)
    amplifier_snr: float | None = param(
        None, "SNR of the amplifier; empty: no amplifier noise", low=0
    )
    snr_reference: Literal["mean", "contrast"] = param(
        "mean",
        "signal to which amplifier_snr refers: the picture's mean, or its maximum "
        "minus its minimum",
    )
    gain_percent: float = param(
        0.0,
        "rms spread of the gain between detectors, relative to the mean gain",
        low=0,
        slider=(0, 10),
    )
    bias_percent: float = param(
        0.0,
        "rms spread of the bias between detectors, relative to the picture's mean",
        low=0,
        slider=(0, 10),
    )
    gain_model: Literal["per_pixel", "published", "literal"] = param(
        "per_pixel",
        "gain errors: per_pixel scales each pixel; published adds a fraction of the picture's "
        "mean; literal uses Tantalo's eq. 4.59 as printed",
    )
    noise_variability_percent: float = param(
        0.0,
        "rms spread of the noise level between detectors, relative to its mean",
        low=0,
        slider=(0, 100),
    )
    use_mtf: bool = param(False, "apply the pre-amplifier's MTF and PTF")
    post_filter: Literal["none", "lowpass", "highpass", "boost"] = param(
        "none", "filter after the amplifier"
    )
    post_corner_Hz: float | None = param(
        None,
        "corner frequency of the low-pass or high-pass filter, or frequency at which the boost "
        "reaches post_gain",
        low=0,
    )
    post_poles: int = param(1, "number of poles of the post filter", (1, 100))
    post_gain: float = param(2.0, "gain of the boost at post_corner_Hz and above", (1, 1e6))
    bits: int = param(
        0, "bits per pixel; 0: no quantization", unit="bit", choices=(0, *_CONVERTER_BITS)
    )
    range_low: float | None = param(
        None,
        "lowest level of the quantizer; empty: the picture's minimum",
        unit="W/m²/sr",
        zero_is_empty=False,
    )
    range_high: float | None = param(
        None,
        "highest level of the quantizer; empty: the picture's maximum",
        unit="W/m²/sr",
        zero_is_empty=False,
    )
    background_K: float | None = param(
        None, "background temperature; empty: brightness temperature of the picture's mean", low=0
    )

    preview_lines = 15.5
    panel = (
        Section("Band", "cut_on_um cut_off_um", page="Detector"),
        Section(
            "Wavelength region and material",
            "region material d_star",
            page="Detector",
            offer=Offer("material", "region", _MATERIALS),
        ),
        Section("Optics", "optics_transmission filter_transmission", page="Detector"),
        Section(
            "Scan and bandwidth",
            "scan_mirror_rate_Hz time_constant_s bandwidth_Hz",
            page="Detector",
        ),
        Section("Background", "background_K", page="Detector"),
        Section("Gain and bias", "gain_percent bias_percent gain_model", page="Gain"),
        Section("Noise between detectors", "noise_variability_percent", page="Gain"),
        Section("Pre-amplifier", "use_mtf", page="Amplifier"),
        Section("Amplifier noise", "amplifier_snr snr_reference", page="Amplifier"),
        Section("Post filter", "post_filter", page="Amplifier"),
        Section(
            "",
            "post_corner_Hz",
            page="Amplifier",
            shown_when=("post_filter", ("lowpass", "highpass", "boost")),
        ),
        Section(
            "", "post_poles", page="Amplifier", shown_when=("post_filter", ("lowpass", "highpass"))
        ),
        Section("", "post_gain", page="Amplifier", shown_when=("post_filter", ("boost",))),
        Section("Quantize the picture", "bits", page="Quantizer"),
        Section(
            "Range", "range_low range_high", page="Quantizer", shown_when=("bits", _CONVERTER_BITS)
        ),
        *SEED_SECTIONS,
    )

    counts_bands = True

    def check(self) -> None:
        low, high = self._range()
        if low is not None and high is not None and low >= high:
            raise ParameterError("range_high", high, f"above range_low = {low:g}", unit="W/m²/sr")

    def run(self, image: Image, context: Context, here: NodeContext) -> ElectronicsOutputs:
        image = summed_within(image, self.cut_on_um, self.cut_off_um)
        seen = here.step(picture_range, image.recipe)
        detector = self._detector(context)
        known = here.step(detector_figures, seen, vignetting=image.vignetting, **detector)
        table = here.step(
            figures,
            seen,
            known,
            bandwidth_Hz=detector["bandwidth_Hz"],
            amplifier_snr=self.amplifier_snr,
            snr_reference=self.snr_reference,
            variability_percent=self.noise_variability_percent,
        )
        image = context_defaults.with_interval(image, context)
        pre, post = self._pre_amplifier(image, context), self._post_filter(context)

        def filtered(picture: Recipe, factors: tuple[Separable, ...]) -> Recipe:
            plain = tuple(replace(f, label="", node=None) for f in factors)
            how = {"grid": image.grid(), "edges": context.edges, "label": "Electronics"}
            return here.step(filtered_lines, picture, factors=plain, **how) if plain else picture

        rms = {"variability_percent": self.noise_variability_percent}
        noise = [known, self.deviates(here, "detector", image.shape)]
        if self.noise_variability_percent:
            noise.append(self._pattern("variability", image, context, here))
        if self.gain_percent or self.bias_percent or self.gain_model == "literal":
            detected = here.step(
                steps.read_out,
                image.recipe,
                seen,
                *(self._pattern(name, image, context, here) for name in ("gain", "bias")),
                *noise,
                **rms,
                gain_percent=self.gain_percent,
                bias_percent=self.bias_percent,
                model=self.gain_model,
            )
        else:
            detected = here.step(steps.with_detector_noise, image.recipe, *noise, **rms)
        amplified = filtered(detected, pre)
        if self.amplifier_snr is not None:
            deviates = self.deviates(here, "amplifier", image.shape)
            amplified = here.step(steps.with_amplifier_noise, amplified, table, deviates)
        shaped = filtered(amplified, post)
        clean = filtered(filtered(image.recipe, pre), post)
        final = self._quantized(shaped, here) if self.bits else shaped

        mtf, ptf = transfers((*pre, *post), image, self.title)
        return ElectronicsOutputs(
            image=image.with_recipe(final),
            noise=image.with_recipe(here.step(difference, shaped, clean)),
            detector_noise=image.with_recipe(here.step(steps.detector_noise, *noise, **rms)),
            quantization_error=image.with_recipe(here.step(difference, final, shaped)),
            mtf=mtf,
            ptf=ptf,
            table=Table(here.step(steps.with_quantization, table, final, shaped)),
        )

    def preview(self, planned: PlannedNode, work: Work, _here: NodeContext) -> charts.Preview:
        """D* against wavelength, of the makers' conditions without a picture, and NETDs as bars."""
        figures: dict[str, Any] = {}
        problem = ""
        try:
            figures = work.value(planned.sound().outputs["table"].recipe).as_dict()
        except ImagechainError as error:
            problem = str(error) if error.node != planned.node.id else error.message
            ports = declaration(type(self)).inputs
            missing = [p.name for p in ports if p.required and p.name not in planned.inputs]
            if isinstance(error, UnconnectedError) and missing:
                problem = charts.not_connected(missing)
        context: Context | None = planned.inputs.get("context")
        chart, words = self._detectivity(figures, context)
        if not figures:
            return charts.Preview("; ".join([*words, problem]), (chart, problem))
        bars = [
            charts.Bar(name, figures[key], charts.kelvin(figures[key]), colour)
            for name, key, colour in (
                ("NETD detector", "netd_detector_K", 2),
                ("amplifier", "netd_amplifier_K", 3),
                ("system", "netd_system_K", 0),
            )
        ]
        words.append(", ".join(f"{bar.name} {bar.value}" for bar in bars))
        return charts.Preview("; ".join(words), (chart, charts.Bars(tuple(bars), 3.2)))

    def _detectivity(
        self, figures: Mapping[str, Any], context: Context | None
    ) -> tuple[charts.Plot, list[str]]:
        band = self._known_band(context)
        seen = {"background_K": 300.0, "half_angle_deg": detectivity.STANDARD_HALF_ANGLE_DEG}
        through = f"a cone of {2 * detectivity.STANDARD_HALF_ANGLE_DEG:.0f}°"
        if figures and context is not None and context.f_number is not None:
            half_angle = detectivity.cold_shield_half_angle_deg(f_number=context.f_number)
            seen = {"background_K": figures["background_K"], "half_angle_deg": half_angle}
            through = f"F/{context.f_number:.3g}"
        conditions = f"{seen['background_K']:.0f} K in {through}"
        typed, of_band = self.d_star is not None, figures.get("d_star", self.d_star)
        ends, levels, words = list(band or ()), [of_band] if of_band else [], []
        curves: list[charts.Curve] = []
        marks: list[charts.Mark] = []
        if self.material != MANUAL:
            material = find_material(
                region=self.region, material=self.material, cut_off_um=band and band[1]
            )
            curve, peak = _material_curve(material, band, seen)
            at, highest = f"{charts.brief(peak[0])} µm", charts.brief(peak[1])
            drawn = np.where(curve[1] > 0, curve[1], 1e-3)
            curves.append(
                charts.Curve(curve[0], drawn, 0, "dotted" if typed else "solid", self.material)
            )
            marks.append(charts.Mark(*peak, f"{highest} at {at}", down=-0.8))
            ends.append(float(curve[0][-1]))
            levels.append(peak[1])
            words.append(
                f"D* of {self.material}: peak {highest} cm √Hz/W at {at}, for a background of "
                f"{conditions}"
            )
        end = 1.08 * max(ends, default=14.0)
        if of_band is not None:
            low, high = band or (0.02 * end, end)
            name = "entered" if typed else "band"
            curves.append(charts.Curve((low, high), (of_band,) * 2, 1, "dashed", name, 2.0))
            marks.append(charts.Mark(low, of_band, charts.brief(of_band), down=0.8, dot=False))
            where = "entered" if typed else "over the band"
            words.append(f"D* {where} {charts.brief(of_band)} cm √Hz/W")
        most, least = max(levels, default=1e12), min(levels, default=1e12)
        along = charts.Axis(
            most / max(10**_DECADES, 10 * most / least), most * 6.0, "D* (cm √Hz/W)", log=True
        )
        across = charts.Axis(0.0, end, f"wavelength (µm), {conditions}")
        return charts.Plot(across, along, tuple(curves), tuple(marks), band=band), words

    def _known_band(self, context: Context | None) -> tuple[float, float] | None:
        try:
            if context is not None:
                return context_defaults.given_band(self.cut_on_um, self.cut_off_um, context.band_um)
        except ParameterError:
            return None
        on, off = self.cut_on_um, self.cut_off_um
        return (on, off) if on is not None and off is not None and on <= off else None

    def _pattern(self, name: str, image: Image, context: Context, here: NodeContext) -> Step:
        """Deviates of the detectors, constant along the direction of collection."""
        shapes = {"line": (1, 1), "push": (1, image.columns)}
        if context.platform not in shapes:
            return self.deviates(here, name, image.shape, fixed=True)
        drawn = self.deviates(here, name, shapes[context.platform], fixed=True)
        return here.step(steps.in_double, drawn)

    def _quantized(self, picture: Recipe, here: NodeContext) -> Recipe:
        low, high = self._range()
        if low is not None and high is not None:
            return here.step(quantized, picture, bits=self.bits, limits=(low, high))
        limits = here.step(steps.value_range, picture, low=low, high=high)
        return here.step(quantized, picture, limits, bits=self.bits)

    band = band_warning
    transmission = context_defaults.t_number_warning
    unit = unit_warning("NER, NETD and D*")

    @warning
    def radiance(self, image: Image) -> Step | None:
        """The samples cannot be radiances in the band entered here."""
        low, high = self.cut_on_um, self.cut_off_um
        # A picture with a band of its own has been held against that one by Read Image.
        if image.band_um is not None or not low or not high or low >= high:
            return None
        if not is_radiance(image.unit):
            return None
        return Step.of(radiance_caution, image.recipe, band_um=(low, high), unit_stated=True)

    @warning
    def scan(self, context: Context) -> Caution | None:
        """The scan mirror's rate disagrees with the scan velocity on Init & Trans."""
        if self.scan_mirror_rate_Hz is None:
            return None
        return apart_caution(
            "the scan velocity from scan_mirror_rate_Hz",
            self.scan_velocity(context),
            context.scan_velocity_mrad_per_s,
            unit="mrad/s",
            where="on Init & Trans",
            remedy=(
                "leave scan_mirror_rate_Hz empty, set the scan velocity on Init & Trans to 0, or "
                "make the two velocities equal"
            ),
        )

    def scan_velocity(self, context: Context) -> float:
        """Velocity of the scan, mrad/s; 0 where nothing scans."""
        if self.scan_mirror_rate_Hz is not None:
            return filters.mirror_scan_velocity_mrad_per_s(
                scan_mirror_rate_Hz=self.scan_mirror_rate_Hz
            )
        return context.scan_velocity_mrad_per_s

    def _tau(self, context: Context) -> float | None:
        if self.time_constant_s is not None:
            return self.time_constant_s
        velocity = self.scan_velocity(context)
        if velocity == 0:
            return None
        return filters.dwell_time_s(
            interval_mrad=context.grid.interval_x_mrad, scan_velocity_mrad_per_s=velocity
        )

    def _bandwidth(self, context: Context) -> float:
        if self.bandwidth_Hz is not None:
            return self.bandwidth_Hz
        tau = self._tau(context)
        if tau is None:
            allowed = (
                "give bandwidth_Hz, time_constant_s, scan_mirror_rate_Hz or the scan velocity on "
                "Init & Trans"
            )
            raise ParameterError("bandwidth_Hz", None, allowed, unit="")
        return filters.noise_bandwidth_hz(time_constant_s=tau)

    def _detector(self, context: Context) -> dict[str, Any]:
        band = context_defaults.given_band(self.cut_on_um, self.cut_off_um, context.band_um)
        return {
            "band_um": band,
            "material": (self.region, self.material),
            "d_star": self.d_star,
            "lens": context_defaults.lens(context, optics_transmission=self.optics_transmission),
            "filter_transmission": self.filter_transmission,
            "area_cm2": detector_area_cm2(**context_defaults.pixel_of(context)),
            "bandwidth_Hz": self._bandwidth(context),
            "background_K": self.background_K,
        }

    def _pre_amplifier(self, image: Image, context: Context) -> tuple[Separable, ...]:
        if not self.use_mtf:
            return ()
        tau, velocity = self._tau(context), self.scan_velocity(context)
        if tau is None or velocity == 0:
            allowed = (
                "the pre-amplifier's MTF needs scan_mirror_rate_Hz or a scan velocity on Init & "
                "Trans"
            )
            raise ParameterError("use_mtf", True, allowed)
        law = {"scan_velocity_mrad_per_s": velocity, "time_constant_s": tau}
        return (
            *separable(filters.lowpass_mtf, x=law, label="Pre-amplifier"),
            *separable(filters.lowpass_ptf, x=law, part="ptf", label="Pre-amplifier"),
        )

    def _post_filter(self, context: Context) -> tuple[Separable, ...]:
        if self.post_filter == "none":
            return ()
        velocity = self.scan_velocity(context)
        if self.post_corner_Hz is None or velocity == 0:
            allowed = (
                "the post filter needs a corner frequency and a scan velocity; give the velocity "
                "as scan_mirror_rate_Hz or on Init & Trans"
            )
            raise ParameterError("post_corner_Hz", self.post_corner_Hz, allowed)
        law = {
            "kind": self.post_filter,
            "corner_cyc_per_mrad": filters.corner_in_cyc_per_mrad(
                corner_Hz=self.post_corner_Hz, scan_velocity_mrad_per_s=velocity
            ),
            "poles": self.post_poles,
        }
        gain = {"max_gain": self.post_gain}
        return (
            *separable(filters.post_filter_mtf, x={**law, **gain}, label="Post filter"),
            *separable(filters.post_filter_ptf, x=law, part="ptf", label="Post filter"),
        )

    def _range(self) -> tuple[float | None, float | None]:
        if not self.range_low and not self.range_high:
            return None, None
        return self.range_low, self.range_high

    figures = steps.FIGURES


def summed_within(image: Image, low_um: float | None, high_um: float | None) -> Image:
    """The radiance of bands within a filter; one at its end counts by its part."""
    bands = image.bands
    if bands is None:
        return image
    first, last = bands.band_um
    low, high = low_um or first, high_um or last
    weights = []
    for centre, width, weight in zip(bands.centres_um, bands.widths_um, bands.whole, strict=True):
        part = min(centre + width / 2, high) - max(centre - width / 2, low)
        weights.append(weight * min(max(part / width, 0.0), 1.0))
    if not any(weights):
        allowed = f"the band must overlap the picture's band, {first:g} to {last:g} µm"
        raise ParameterError("cut_on_um", low, allowed)
    band = max(first, low), min(last, high)
    return image.with_recipe(bands.picture(tuple(weights)), band_um=band)


def _material_curve(
    material: Material, band_um: tuple[float, float] | None, seen: dict[str, float]
) -> tuple[tuple[NDArray[np.float64], NDArray[np.float64]], tuple[float, float]]:
    """D* to beyond the cut-off, which is the last but one, and its peak, in the band if any."""
    cut_off = material.cut_off_um
    inside = np.linspace(_SHORTEST * cut_off, cut_off, _PREVIEW_POINTS)
    wavelength = np.append(inside, np.nextafter(cut_off, np.inf))
    curve = wavelength, detectivity.d_star(wavelength, material=material, **seen)
    within, values = curve
    if band_um is not None and 0 < band_um[0] < cut_off:
        end = min(band_um[1], cut_off)
        within = np.append(np.linspace(band_um[0], end, _PREVIEW_POINTS)[:-1], end)
        values = detectivity.d_star(within, material=material, **seen)
    highest = int(np.argmax(values))
    return curve, (float(within[highest]), float(values[highest]))
