"""Focal Plane: a camera's detector in electrons, as data sheets specify it today."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from core.chain.back_transformed import BinMode, combine_pixels
from core.chain.engine import PlannedNode
from core.chain.wires import Context, Image, Table
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, warning
from core.modules.preview import Preview
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM, QuantumEfficiency
from core.physics.noise.noise_equivalent import detector_area_cm2
from core.physics.optics.diffraction_otf import Aperture
from core.records import replace
from core.transfer.factors import Factor
from nodes.detector import focal_plane_steps as steps
from nodes.detector.focal_plane_figures import (
    FIGURES,
    Collection,
    ReadOut,
    budget_preview,
    clipping_level,
    electron_levels,
    figures,
    overflow_caution,
    reference_caution,
)
from nodes.detector.focal_plane_panel import FocalPlanePanel
from nodes.detector.spectral_response import (
    DrawnResponse,
    counted_photons,
    drawn_response,
    radiance_per_photon,
    response_preview,
)
from nodes.shared import context_defaults
from nodes.shared.context_defaults import F_NUMBER_NEAR, NEAR, Band, alike, filled_band
from nodes.shared.module_ports import TableFigures, passed_factors
from nodes.shared.steps import difference, picture_range


class FocalPlaneOutputs(NamedTuple):
    image: Image
    electrons: Image
    noise: Image
    saturated: Image
    table: Table


_CHART_LINES = 9.0  # of text, in the preview


class FocalPlane(FocalPlanePanel, key="focal_plane", title="Focal Plane", group="Detector"):
    """Convert the picture's photons to electrons, add the camera's noise, and digitize the signal.

    The steps, in this order: shot noise of all electrons, drawn for every pixel; PRNU and DSNU,
    which are the same in every frame; nonlinearity, which grows towards the full well; read noise;
    clipping at the full well; gain; offset; rounding to whole numbers. A PRNU of p multiplies all
    electrons, including dark-current electrons, by 1 + p·n, where n is a standard normal deviate;
    EMVA 1288 defines PRNU on the light signal only.

    Give the quantum efficiency as a number, in per cent, in A/W or as a curve over wavelength. On
    Camera, you can give a T-number, which includes the transmission, and choose the sine condition.
    `dark_doubling_K` scales the dark current from `dark_reference_K` to `detector_K`.

    Radiance is converted to photons with the spectrum of a black body at the scene's brightness
    temperature (`scene`) or at `source_K` (`source`), or with the band's middle wavelength
    (`middle`). The table lists the signal for each choice. For a spectral picture, each band is
    converted to photons with the response at its wavelength. A band that begins below 2.5 µm
    is not thermal: there `scene` acts as `source`. NETD, SNR and well fill refer to the picture's
    mean; if the mean is clipped, there is no NETD, SNR or NEI. `snr_at_reference` is the SNR of a
    uniform scene of `reference_radiance`, as specified for Landsat and Sentinel-2.
    `reference_radiance` is the spectral radiance at the aperture, in W/m²/sr/µm, and is constant
    over the band. `frames_averaged` reduces shot and read noise by the square root of the number of
    frames; the average is rounded once. Noise, responsivity and SNR include the nonlinearity;
    signal and well fill count the electrons collected. `saturated` is 1 where the well is full or
    the converter has clipped.

    A charge gain multiplies the electrons after PRNU and DSNU, and adds excess noise. All results
    are in electrons before the charge gain. The values given for read noise, wells and
    gain_e_per_dn refer to electrons after the charge gain; with an EM register, full_well_e refers
    to electrons before the register. Values in amperes include a gain within the pixel, as in a
    QWIP's data sheet; values in e-/s, DSNU and Rule 07 do not. The setting gain_dB is 20·log10 of
    the camera's own gain. The camera's gain divides gain_e_per_dn, so the converter clips at fewer
    electrons.

    Binning sums binning_x × binning_y pixels; all figures then refer to a bin. `charge` sums the
    electrons and reads them once; register_well_e limits the sum. `digital` reads each pixel and
    sums the digital numbers: read noise grows with the square root of the number of pixels, and
    `saturated` is the share of saturated pixels. If `units` is radiance, the value of a bin is the
    mean of its pixels. Binning n pixels multiplies the MTF by sin(πnξΔ)/(n·sin(πξΔ)), where Δ is
    the pixel pitch. Leftover rows and columns are dropped.

    Sources: Dereniak and Boreman 1996; Janesick 2007, Photon Transfer; EMVA 1288 (also doubling of
    the dark current); Tennant et al. 2008 (Rule 07); Levine 1993 (gain of QWIPs); Robbins and
    Hadwen 2003 (EM registers); McIntyre 1966 (avalanches).
    """

    formulas = (
        Formula(
            r"N_s=t\,n\,A\varphi\,\mathrm{QE}\;\Omega\left[\tau L_q+(1-\tau)L_q(T_{opt})\right]",
            where="N_s: electrons from scene and optics; t: integration_time_s; n: tdi_stages; Aφ: "
            "pixel area times both fill factors; L_q: photons per s, m² and sr in the band; "
            "τ: optics_transmission; T_opt: optics_K",
        ),
        Formula(
            r"N=N_s+t\,n\,A\varphi\,\mathrm{QE}\,(\pi-\Omega)(1-\eta)\,L_q(T_{hou})+t\,n\,i",
            where="N: all electrons, including those from the housing (T_hou: housing_K) past a "
            "cold shield of efficiency η, and those from the dark current i",
        ),
        Formula(
            r"i=J\,A_p/q,\quad i(T)=i(T_0)\,2^{(T-T_0)/\Delta T}",
            where="J: dark_current_A_per_cm2; A_p: pitch in x times pitch in y; q: elementary "
            "charge; T: detector_K; T₀: dark_reference_K; ΔT: dark_doubling_K",
        ),
        Formula(
            r"\Omega=\frac{\pi}{4F^2+1}\left(1-\varepsilon^2\right)",
            where="Ω: projected solid angle of the optics at F-number F and obscuration ε, sr; "
            "π/(4F²) instead of the fraction if irradiance on Camera is sine",
        ),
        Formula(
            r"\sigma_t=\sqrt{N+\sigma_{read}^2+K^2/12},\quad\sigma_f=\sqrt{(pN)^2+\sigma_{"
            r"dsnu}^2}",
            where="σ_t, σ_f: temporal noise and fixed pattern of an exposure, in electrons; K: "
            "electrons per digital number; p: PRNU",
        ),
        Formula(
            r"\sigma_t=\sqrt{F\,N+\left(\sigma_{read}/G\right)^2+\left(K/G\right)^2/12}",
            where="G: charge_gain_factor; F: excess noise factor: 2 in a photoconductor, "
            "(2(G−1)/G^(1/S)+1)/G in an EM register of S stages, "
            "kG+(1−k)(2−1/G) in an avalanche with k = ionization_ratio",
            when="a charge gain",
        ),
        Formula(
            r"\mathrm{NETD}=\frac{\sigma_t}{\partial N/\partial T},\quad\mathrm{DN}=\mathrm{"
            r"round}\left(\frac{N}{K}+o\right)",
            where="o: offset_dn; DN is clipped to 0 … 2^bits − 1",
        ),
    )

    counts_bands = True

    preview_lines = 12.5

    def run(self, image: Image, context: Context, here: NodeContext) -> FocalPlaneOutputs:
        """Plan every stage as a value of its own, so that an edit repeats only what follows it."""
        node, reading = here.node, self.read_out()
        collection = self.collection(image, context, here)
        light, known = image.recipe, []
        if image.bands is not None:
            efficiency = collection.weights.efficiency
            light = counted_photons(image, efficiency)
            known = [radiance_per_photon(image, efficiency, node)]
        seen = here.step(picture_range, light)
        levels = here.step(electron_levels, seen, *known, collection=collection)
        whole = collection.of_pixels(self.pixels)
        of_bins = here.step(electron_levels, seen, *known, collection=whole)
        table = here.step(
            figures,
            of_bins,
            reading=self.delivered(),
            area_cm2=detector_area_cm2(**context_defaults.pixel_of(context)) * self.pixels,
            reference_radiance=self.reference_radiance,
        )

        mean: Recipe = here.step(steps.expected_electrons, light, levels)
        sizes = (("prnu", self.prnu_percent), ("dsnu", self.dsnu_e))
        drawn = [self.deviates(here, "shot", image.shape)]
        drawn += [self.deviates(here, of, image.shape, fixed=True) for of, size in sizes if size]
        spread = {"prnu_percent": self.prnu_percent, "dsnu_e": self.dsnu_e}
        collected: Recipe = here.step(
            steps.collected, mean, *drawn, frames=self.frames_averaged, **spread
        )
        if self.sums_charge:
            filled = self._filled(collected, levels, reading, here)
            pixels = self._with_bad_pixels(filled, image, levels, here)
            mean = self._binned(image.with_recipe(mean), here).recipe
            image = self._binned(image.with_recipe(pixels), here)
            collected, levels = image.recipe, of_bins
        if reading.excess_factor > 1.0:
            drawn = [self.deviates(here, "excess", image.shape)]
            how: Any = {"frames": self.frames_averaged, "factor": reading.excess_factor}
            collected = here.step(steps.multiplied, collected, mean, *drawn, **how)
        well = {"full_well_e": reading.full_well_e}
        electrons: Recipe = here.step(
            steps.read_out,
            self._bent(collected, levels, reading, here),
            here.step(clipping_level, levels, reading=reading),
            *([self.deviates(here, "read", image.shape)] if self.read_noise_e else []),
            sigma_e=reading.read_noise_e / self.frames_averaged**0.5,
            **well,
        )
        if not self.sums_charge:
            electrons = self._with_bad_pixels(electrons, image, levels, here)
        numbers = {"gain_e_per_dn": reading.gain_e_per_dn, "offset_dn": self.offset_dn}
        saturated = here.step(steps.saturated_pixels, electrons, bits=self.bits, **numbers, **well)
        clean = self._bent(mean, levels, reading, here)
        noise = here.step(difference, electrons, clean)
        image = replace(
            image, band_um=collection.weights.band_um, exposure_s=self.integration_time_s
        )
        made = self._given_in(image, electrons, levels, numbers, here)
        ports = {"electrons": electrons, "noise": noise}
        given = {name: image.with_recipe(each, unit="e-") for name, each in ports.items()}
        given |= {"image": made, "saturated": image.with_recipe(saturated, unit="")}
        if self.pixels > 1 and not self.sums_charge:
            means = {"saturated", "image"} if self.units == "radiance" else {"saturated"}
            given = {
                name: self._binned(port, here, "mean" if name in means else "sum")
                for name, port in given.items()
            }
        table = here.step(steps.with_saturated, table, given["saturated"].recipe)
        return FocalPlaneOutputs(**given, table=Table(table))

    def _binned(self, image: Image, here: NodeContext, mode: BinMode = "sum") -> Image:
        x, y = self.binning_x, self.binning_y
        binned = combine_pixels(image, factor_x=x, factor_y=y, mode=mode, node=here.node)
        across, along = image.pixel_mrad
        return replace(binned, pixel_mrad=(across and across * x, along and along * y))

    def _filled(
        self, pixels: Recipe, levels: Recipe, reading: ReadOut, here: NodeContext
    ) -> Recipe:
        """No pixel with more electrons than it holds, before their charge is summed."""
        well = self.pixel_well_e
        if well is None:
            return pixels
        alone = replace(reading, full_well_e=well, nonlinearity_percent=0.0, bits=0)
        level = here.step(clipping_level, levels, reading=alone)
        return here.step(steps.read_out, pixels, level, sigma_e=0.0, full_well_e=well)

    def _with_bad_pixels(
        self, pixels: Recipe, image: Image, levels: Recipe, here: NodeContext
    ) -> Recipe:
        if not self.bad_pixel_percent:
            return pixels
        how: Any = {"shape": image.shape, "percent": self.bad_pixel_percent}
        stream = self.stream(here, "bad pixels", fixed=True)
        bad = here.step(steps.bad_pixels, stream=stream, **how)
        # A hot pixel fills the well, or else gives what is just beyond the last number.
        reading = self.read_out()
        hot = self.pixel_well_e if self.sums_charge else reading.full_well_e
        if hot is None and self.bits:
            hot = (reading.top_dn + 1.0 - self.offset_dn) * reading.gain_e_per_dn
        return here.step(steps.with_bad_pixels, pixels, bad, levels, hot_e=hot)

    def _bent(
        self, electrons: Recipe, levels: Recipe, reading: ReadOut, here: NodeContext
    ) -> Recipe:
        if not self.nonlinearity_percent:
            return electrons
        return here.step(steps.bent, electrons, levels, **reading.response)

    def _given_in(
        self, image: Image, electrons: Recipe, levels: Recipe, numbers: Any, here: NodeContext
    ) -> Image:
        if self.bits:
            made = here.step(steps.digitized, electrons, bits=self.bits, **numbers)
            if self.units == "dn":
                return image.with_recipe(made, unit="DN")
            electrons = here.step(steps.electrons_of_counts, made, **numbers)
        elif self.units == "dn":
            return image.with_recipe(here.step(steps.counted, electrons, **numbers), unit="DN")
        if self.units == "electrons":
            return image.with_recipe(electrons, unit="e-")
        back = here.step(steps.radiance_of_electrons, electrons, levels)
        return image.with_recipe(back)

    unit = context_defaults.unit_warning("counting photons")

    @warning
    def band(self, image: Image, context: Context) -> Caution | None:
        """The cold filter passes wavelengths outside the picture's band."""
        known = image.band_um or context.band_um
        if known is None:
            return None
        low, high = filled_band(self.cut_on_um, self.cut_off_um, known)
        if low >= known[0] * (1 - NEAR) and high <= known[1] * (1 + NEAR):
            return None
        lost = "not counted" if image.bands is not None else "extrapolated with a black body"
        return Caution(
            f"the cold filter passes {low:g} to {high:g} µm, but the picture's radiance covers "
            f"{known[0]:g} to {known[1]:g} µm: light outside the picture's band is {lost}",
            "use a picture that covers the filter's whole band, or a narrower filter",
        )

    @warning
    def material(self, image: Image, context: Context) -> Caution | None:
        """Photons are counted beyond the cutoff of the detector material."""
        known, cutoff = image.band_um or context.band_um, self.material_cutoff_um
        if known is None or self.response is not None or not cutoff:
            return None
        low, high = filled_band(self.cut_on_um, self.cut_off_um, known)
        if high <= cutoff * (1 + NEAR):
            return None
        return Caution(
            f"photons are counted from {low:g} to {high:g} µm with a constant quantum efficiency, "
            f"but the detector material cuts off at material_cutoff_um = {cutoff:g} µm",
            "set cut_off_um to the material's cutoff or below, or give the quantum efficiency "
            "over wavelength in response",
        )

    @warning
    def obscuration(self, image: Image, context: Context) -> Caution | None:
        """Diffraction and radiometry use different obscurations."""
        blocks = context.obscuration_ratio
        for factor, bound in _laws(image) if context.t_number is None else ():
            aperture = bound.get("aperture")
            blurs = aperture.obscuration_ratio if isinstance(aperture, Aperture) else blocks
            if abs(blurs - blocks) > NEAR:
                return Caution(
                    "electrons are counted for the wrong aperture: the blur uses "
                    f"obscuration_ratio = {blurs:.4g} on {factor.node}, but the radiometry "
                    f"uses {blocks:.4g} on Camera or Init & Trans",
                    "enter the obscuration on Camera and leave obscuration_ratio empty on "
                    f"{factor.node}",
                )
        return None

    transmission = context_defaults.t_number_warning

    @warning
    def stages(self, image: Image) -> Caution | None:
        """The number of TDI stages differs from the value on TDI MTF."""
        for factor, bound in _laws(image):
            stages = bound.get("stages", self.tdi_stages)
            if stages != self.tdi_stages:
                return Caution(
                    f"tdi_stages = {self.tdi_stages} here but {stages} on {factor.node}: signal "
                    "and blur are computed for different detectors",
                    f"enter the number once and link it: tdi_stages = {factor.node}.stages",
                )
        return None

    @warning
    def exposure(self, image: Image) -> Caution | None:
        """The integration time differs from the value on Frame Transfer Smear."""
        for factor, bound in _laws(image):
            if {"ratio", "sides"} <= bound.keys():
                return context_defaults.apart(
                    self,
                    {"integration_time_s": image.exposure_s},
                    where=f"on {factor.node}",
                    remedy="enter the time once and link it: integration_time_s = "
                    f"{factor.node}.integration_time_s",
                )
        return None

    @warning
    def line_time(self, context: Context) -> Caution | None:
        """The integration time does not match the ground speed."""
        speed, range_m = context.velocity_m_per_s, context.range_m
        if context.platform != "push" or not speed or not range_m:
            return None
        ground_m = context_defaults.pixel_mrad("y", context) * range_m / 1000.0
        line_s = ground_m / abs(speed)
        own, stages = self.integration_time_s, self.tdi_stages
        if own <= line_s * (1 + NEAR) and (stages == 1 or own >= line_s * (1 - NEAR)):
            return None
        return Caution(
            f"integration_time_s = {own:.4g} s does not match the scan: at {abs(speed):g} m/s, the "
            f"image moves by one pixel ({ground_m:.4g} m across the line of sight) in {line_s:.4g} "
            "s" + (" per stage" if stages > 1 else ""),
            f"set integration_time_s to {line_s:.4g}"
            + (" or less" if stages == 1 else "")
            + ", or correct range, velocity or pitch",
        )

    @warning
    def dark_current(self) -> Caution | None:
        """A dark-current parameter has no effect: Rule 07 is off, or replaces the parameter."""
        for name, unit in (
            ("dark_current_e_per_s", "e-/s"), ("dark_current_A_per_cm2", "A/cm²"),
            ("dark_doubling_K", "K"),
        ):  # fmt: skip
            if self.rule_07 and getattr(self, name):
                return Caution(
                    f"{name} = {getattr(self, name):g} {unit} is not used: "
                    "rule_07 is on and sets the dark current",
                    f"switch rule_07 off, or set {name} to 0",
                )
        if self.rule_07 or self.dark_current_e_per_s or self.dark_current_A_per_cm2:
            return None
        if not (self.detector_K and self.material_cutoff_um):
            return None
        return Caution(
            f"the dark current is 0: detector_K = {self.detector_K:g} K and material_cutoff_um "
            f"= {self.material_cutoff_um:g} µm are not used, because rule_07 is off and "
            "dark_current_e_per_s is 0",
            "switch rule_07 on, give dark_current_e_per_s, or leave detector_K empty",
        )

    @warning
    def unused_gain(self) -> Caution | None:
        """The charge gain has no effect, because charge_gain is none."""
        if self.charge_gain != "none" or self.charge_gain_factor == 1.0:
            return None
        return Caution(
            f"charge_gain_factor = {self.charge_gain_factor:g} is not used: charge_gain is none",
            "choose the kind of gain in charge_gain, or set charge_gain_factor to 1",
        )

    @warning
    def optics(self, image: Image, context: Context) -> Caution | None:
        """Diffraction is computed for a band that differs from the cold filter's band."""
        known = image.band_um or context.band_um
        if known is None:
            return None
        low, high = filled_band(self.cut_on_um, self.cut_off_um, known)
        for factor, bound in _laws(image):
            band: Any = bound.get("cut_on_um"), bound.get("cut_off_um")
            # The cutoff of the optics goes as 1 over the wavelength, as it goes as 1 over the
            # F-number: the middles of both bands may differ by as much as a nominal F-number may.
            if None not in band and not alike(band[0] + band[1], low + high, near=F_NUMBER_NEAR):
                return Caution(
                    f"MTF and ranges are for the wrong wavelengths: {factor.label} ({factor.node}) "
                    f"computes the blur for {band[0]:g} to {band[1]:g} µm, but the cold filter "
                    f"passes {low:g} to {high:g} µm",
                    f"set cut_on_um = {low:g} and cut_off_um = {high:g} on "
                    f"{factor.node} too, or use a picture with the filter's band",
                )
        return None

    @warning
    def spectrum(self, image: Image, context: Context) -> Caution | None:
        """The band contains reflected light, which has no brightness temperature."""
        band: Band | None = image.band_um or context.band_um
        ends = (self.cut_on_um, None if band is None else band[0])
        shortest = min((end for end in ends if end is not None), default=None)
        if self.photon_weighting != "scene" or shortest is None:
            return None
        if shortest >= SHORTEST_THERMAL_UM or image.bands is not None:
            return None
        return Caution(
            f"the band begins at {shortest:g} µm, where light is mainly reflected and has no "
            f"brightness temperature: photons are weighted with the spectrum of a source at "
            f"{self.source_K:g} K",
            "set photon_weighting to source to accept this spectrum, or to middle to use the "
            "band's middle wavelength; NETD is then left out",
        )

    @warning
    def response_ends(self, outputs: FocalPlaneOutputs) -> Caution | None:
        """The response curve ends within the band."""
        efficiency = self.efficiency(outputs)
        if not efficiency.points:
            return None
        (first, at_first), (last, at_last) = efficiency.points[0], efficiency.points[-1]
        ends = []
        if at_first > 0.0 and first > efficiency.cut_on_um * (1 + NEAR):
            ends.append(f"begins at {first:g} µm with a value of {at_first:g}")
        if at_last > 0.0 and last < efficiency.cut_off_um * (1 - NEAR):
            ends.append(f"ends at {last:g} µm with a value of {at_last:g}")
        if not ends:
            return None
        return Caution(
            f"photons outside the curve are not counted: the response {' and '.join(ends)}, within "
            f"the band of {efficiency.cut_on_um:g} to {efficiency.cut_off_um:g} µm",
            "give points over the whole band, or let the curve begin and end with 0",
        )

    @staticmethod
    def efficiency(outputs: FocalPlaneOutputs) -> QuantumEfficiency:
        """Electrons per photon over wavelength, within the cold filter, as they were planned."""
        figures_of_mean: Any = outputs.table.recipe.inputs[0]
        collection: Collection = dict(figures_of_mean.inputs[0].parameters)["collection"]
        return collection.weights.efficiency

    def response_over_band(self, planned: PlannedNode, _here: NodeContext) -> DrawnResponse:
        efficiency = self.efficiency(planned.result)
        filter_um = efficiency.cut_on_um, efficiency.cut_off_um
        band = planned.inputs["image"].band_um or filter_um
        knots = [place for place, _ in efficiency.points]
        return drawn_response("quantum efficiency", band, filter_um, knots, efficiency)

    def preview(self, planned: PlannedNode, work: Work, here: NodeContext) -> Preview:
        """How full the well is and of what, the noise by source; of bands, the response too."""
        image: Image = planned.sound().inputs["image"]
        table: Table = planned.outputs["table"]
        budget = budget_preview(work.value(table.recipe).as_dict(), self.delivered().full_well_e)
        if image.bands is None:
            return budget
        over = response_preview(self.response_over_band(planned, here), image, work)
        return Preview(
            f"{budget.words}; {over.words}",
            (*budget.parts, *over.parts),
            more_lines=budget.more_lines + _CHART_LINES,
        )

    @warning
    def overflow(self, outputs: FocalPlaneOutputs) -> Recipe:
        """The mean or the brightest pixel exceeds the full well or the converter's range."""
        table = outputs.table.recipe.inputs[0]
        return Step.of(overflow_caution, table.inputs[0], reading=self.delivered())

    @warning
    def reference(self, outputs: FocalPlaneOutputs) -> Recipe | None:
        """The reference radiance exceeds the full well or the converter's range."""
        if self.reference_radiance is None:
            return None
        return Step.of(reference_caution, outputs.table.recipe.inputs[0])

    figures = FIGURES
    counts = TableFigures(
        ("saturated_pixels", "", "Number of pixels clipped at the full well or at the converter's "
         "highest number."),
    )  # fmt: skip


def _laws(image: Image) -> Iterator[tuple[Factor, dict[str, Any]]]:
    """The factors on the way to a picture, and what is bound in each of their laws."""
    for factor in passed_factors(image):
        for law in factor.laws:
            yield factor, dict(law.parameters)
