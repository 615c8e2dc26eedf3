"""Diffraction MTF: a circular or annular aperture by its data sheet, without a pupil array."""

from typing import Any, Literal

from core.chain.band_stack import BandStack
from core.chain.wires import Context, Magnitude, Phase
from core.errors import ParameterError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.optics import diffraction_otf as physics
from core.records import replace
from core.transfer.factors import AtWavelength, Law, Planar
from nodes.optics import band_spectrum
from nodes.shared import context_defaults, module_ports
from nodes.shared.steps import number

Number = Literal["auto", 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 20, 24, 32, 48, 64]


class DiffractionMTF(
    module_ports.NyquistReadouts, key="diffraction_mtf", title="Diffraction MTF", group="Optics"
):
    """Blur by diffraction at a circular or annular aperture, computed exactly over the band.

    Aperture and obscuration come from Camera. Without a Camera, the aperture is the focal length
    divided by the F-number, both from Init & Trans. No pupil array is needed. Over a band,
    `weighting` weights each wavelength's OTF by the photons or the energy of a black body, or
    equally, as in Tantalo 1996. The black body's temperature is `source_K`. If `source_K` is empty,
    the temperature is 5800 K (sunlight) for a band that begins below 2.5 µm, and otherwise the
    brightness temperature of the picture's mean radiance. `response`, and a Spectral Response
    before this module, also weight the light, like a detector behind the optics. With `wavelengths`
    set to auto, the module uses as many wavelengths as `tolerance` requires. At each frequency, the
    band is split at the wavelengths where the OTF has a kink, such as its cut-off. A number sets
    how many wavelengths sample the band; 1 uses the band's middle. With auto, a spectral picture is
    blurred band by band, and the MTF shown is the mean weighted by the picture's own light.

    `defocus_waves` is W20 at the rim of the pupil, in waves at the band's middle; the OTF stays
    real and may be negative. `rms_wavefront_waves`, also in waves at the band's middle, applies
    Shannon's factor for small errors of any shape, 1 − (W/0.18)²(1 − 4(ν − 1/2)²). Sources: Goodman
    2005; O'Neill 1956 (annulus, with its erratum); Hopkins 1955 (defocus); Shannon 1994, Handbook
    of Optics I, chapter 35.
    """

    formulas = (
        Formula(
            r"H(\rho)=\sum_j w_j\,H_0(\nu_j),\quad\nu_j=\frac{\lambda_j\,\rho}{D}",
            where="ρ: cycles/mrad; D: aperture, mm; λ_j, w_j: wavelengths (µm) that sample the "
            "band, and their weights, set by the light at each wavelength",
        ),
        Formula(
            r"H_0(\nu)=\frac{2}{\pi}\left(\arccos\nu-\nu\sqrt{1-\nu^2}\right)",
            where="H₀ is 0 for ν ≥ 1; for an annular aperture, H₀ is the overlap of the annulus "
            "with a copy shifted by ν",
            when="clear aperture in focus",
        ),
        Formula(
            r"H_0(\nu)=\frac{4}{\pi}\int_0^{\arccos\nu}\sin^2 t\,\cos\left[8\pi W_{20}\,\nu\,("
            r"\cos t-\nu)\right]dt",
            where="W₂₀: defocus at the rim (defocus_waves), converted to waves at λ_j",
            when="out of focus",
        ),
        Formula(
            r"H_W=1-\left(\frac{W}{0.18}\right)^2\left[1-4\left(\nu-\frac{1}{2}\right)^2\right]",
            where="W: rms_wavefront_waves; H_W multiplies the MTF",
            when="small errors of any shape",
        ),
    )

    aperture_mm: float | None = param(
        None,
        "aperture diameter; empty: from Camera, or focal length divided by the F-number",
        low=0,
        slider=(2, 500),
    )
    obscuration_ratio: float | None = param(
        None,
        "obscuration: inner over outer diameter of the aperture; empty: from Camera, "
        "or no obscuration",
        (0, 1),
        below=True,
        slider=(0, 0.6),
        zero_is_empty=False,
    )
    cut_on_um: module_ports.CutOn = None
    cut_off_um: module_ports.CutOff = None
    weighting: Literal["photons", "energy", "uniform"] = param(
        "photons",
        "weighting of the wavelengths: by photons (as in a photon detector), by energy, or equal",
    )
    source_K: module_ports.LightingSource = None
    response: band_spectrum.DetectorResponse = None
    wavelengths: Number = param(
        "auto",
        "auto: as many wavelengths as the tolerance requires; a number sets how "
        "many sample the band; 1 uses the band's middle",
    )
    tolerance: float = param(
        0.0,
        "largest OTF error allowed with auto; 0 means 1e-13, or 1e-10 with defocus, or "
        "1e-6 with a response of many points",
        (0, 1),
    )
    defocus_waves: float = param(
        0.0, "defocus W20 at the rim of the pupil", (-20, 20), slider=(-2, 2)
    )
    rms_wavefront_waves: float = param(
        0.0, "rms wavefront error of any shape", (0, 0.18), slider=(0, 0.1)
    )
    apply: module_ports.Apply = "multiply"

    panel = (
        Section("Aperture", "aperture_mm obscuration_ratio"),
        Section("Wavefront", "defocus_waves rms_wavefront_waves"),
        Section("Band", "cut_on_um cut_off_um"),
        Section("Weights", "weighting"),
        Section("", "source_K", shown_when=("weighting", ("photons", "energy"))),
        Section("", "response"),
        Section("Wavelengths", "wavelengths"),
        Section("", "tolerance", shown_when=("wavelengths", ("auto",))),
        Section("Output", "apply"),
    )

    def run(
        self, context: Context, magnitude: Magnitude, here: NodeContext, phase: Phase | None = None
    ) -> module_ports.OtfOutputs:
        band, aperture = self._band(context), self.aperture_of(context)
        aperture.check(band[0])
        # Bands have their own light: no black body's over all of them is ever summed up.
        weighting = self.weighting if self._bands(magnitude) is None else "uniform"
        responses = band_spectrum.weighting_responses(
            self.response, here.folder, magnitude, weighting
        )
        spectrum = physics.Spectrum(*band, weighting, responses=responses)
        law = Law.of(
            physics.diffraction_otf,
            aperture=aperture,
            cut_on_um=band[0],
            cut_off_um=band[1],
            weighting=weighting,
            temperature_K=self._temperature(magnitude, band, here.node) or 1.0,
            responses=responses,
            wavelengths=0 if self.wavelengths == "auto" else self.wavelengths,
            tolerance=self._finest(many_bends=physics.has_many_bends(spectrum)),
        )
        # All that the law lets through is below the cutoff of the shortest wavelength taken.
        cutoff = aperture.diameter_mm / band[0]
        blur = self._by_bands(
            Planar(law, radial=True, cutoff=(cutoff, cutoff), label=self.title, node=here.node),
            aperture,
            magnitude,
            band_spectrum.weighting_responses(self.response, here.folder, None, "uniform"),
        )
        return module_ports.otf_outputs(
            self.apply, magnitude, phase, blur=(blur,), label=self.title
        )

    def _by_bands(
        self,
        blur: Planar,
        aperture: physics.Aperture,
        magnitude: Magnitude,
        detector: band_spectrum.Responses,
    ) -> Planar:
        bands = self._bands(magnitude)
        if bands is None:
            return blur
        for wavelength in (min(bands.centres_um), max(bands.centres_um)):
            aperture.check(wavelength)
        one = Law.of(
            physics.diffraction_otf,
            aperture=aperture,
            weighting="uniform",
            temperature_K=1.0,
            wavelengths=1,
            tolerance=self._finest(),
        )
        law = AtWavelength(one, ("cut_on_um", "cut_off_um"))
        if self.weighting == "uniform":
            return replace(blur, by_wavelength=law)
        return band_spectrum.at_each_band(blur, law, bands, self.weighting, detector)

    def _bands(self, magnitude: Magnitude) -> BandStack | None:
        if self.wavelengths != "auto" or magnitude.image is None:
            return None
        return magnitude.image.bands

    def aperture_of(self, context: Context) -> physics.Aperture:
        """The aperture here, else of Camera, else by F-number and focal length."""
        diameter = self.aperture_mm or _of_context(context)
        if diameter is None:
            allowed = "give F-number and focal length on Init & Trans, or a value here or on Camera"
            raise ParameterError("aperture_mm", None, allowed)
        inner = self.obscuration_ratio
        return physics.Aperture(
            diameter,
            context.obscuration_ratio if inner is None else inner,
            self.defocus_waves,
            self.rms_wavefront_waves,
            sum(self._band(context)) / 2,
        )

    def _finest(self, *, many_bends: bool = False) -> float:
        usual = physics.USUAL_WITH_DEFOCUS if self.defocus_waves else physics.FINEST_TOLERANCE
        if many_bends:
            usual = physics.USUAL_WITH_MANY_BENDS
        return max(self.tolerance or usual, physics.FINEST_TOLERANCE)

    def _band(self, context: Context) -> context_defaults.Band:
        return context_defaults.given_band(self.cut_on_um, self.cut_off_um, context.band_um)

    def _temperature(
        self, magnitude: Magnitude, band: context_defaults.Band, node: str
    ) -> float | Recipe | None:
        if self.weighting == "uniform" or self.wavelengths == 1 or band[0] == band[1]:
            return None
        if self._bands(magnitude) is not None:
            return None
        return band_spectrum.source_temperature(self.source_K, magnitude, band, node)

    band = context_defaults.middle_warning

    @warning
    def aperture(self, context: Context) -> Caution | None:
        """The aperture or obscuration differs from the value on Camera or Init & Trans."""
        camera = context.aperture_mm is not None
        where = "on Camera" if camera else "from focal length and F-number on Init & Trans"
        diameter = {"aperture_mm": _of_context(context)}
        return context_defaults.apart(
            self, diameter, where=where, near=context_defaults.F_NUMBER_NEAR
        ) or context_defaults.apart_from_context(
            self, context, "obscuration_ratio", where="on Camera"
        )

    @warning
    def kelvin(self, context: Context, magnitude: Magnitude) -> Caution | None:
        """The picture is in kelvin, and diffraction blurs it as if it were radiance."""
        return band_spectrum.kelvin_caution(magnitude, self._band(context), self.source_K)

    response_unused = band_spectrum.response_warning

    @readout("mm", name="aperture_mm")
    def diameter(self, context: Context) -> float:
        """Diameter of the aperture."""
        return self.aperture_of(context).diameter_mm

    @readout("cyc/mrad")
    def cutoff(self, context: Context) -> float:
        """Cutoff: diameter of the aperture divided by the band's middle wavelength."""
        return self.aperture_of(context).diameter_mm / (sum(self._band(context)) / 2)

    @readout("K", name="weighting_K")
    def weighted_by(self, context: Context, magnitude: Magnitude) -> float | Recipe | None:
        """Temperature of the black body whose spectrum weights the band."""
        return self._temperature(magnitude, self._band(context), self.title)

    @readout()
    def wavelengths_used(
        self, context: Context, magnitude: Magnitude, outputs: module_ports.OtfOutputs
    ) -> int | Step:
        """Number of wavelengths, bands (spectral picture) or panels (response of many points)."""
        bands = self._bands(magnitude)
        if bands is not None:
            return bands.count
        if self.wavelengths != "auto":
            return self.wavelengths
        return 1 if self._has_one_wavelength(context) else _needed(outputs, "count")

    @readout()
    def estimated_error(
        self, context: Context, magnitude: Magnitude, outputs: module_ports.OtfOutputs
    ) -> float | Step | None:
        """Estimated OTF error due to the number of wavelengths; unknown for a fixed number."""
        if self.wavelengths != "auto" or self._bands(magnitude) is not None:
            return None
        return 0.0 if self._has_one_wavelength(context) else _needed(outputs, "error")

    def _has_one_wavelength(self, context: Context) -> bool:
        low, high = self._band(context)
        return low == high


def _of_context(context: Context) -> float | None:
    if context.aperture_mm is not None:
        return context.aperture_mm
    if context.f_number is None or context.focal_length_mm is None:
        return None
    return context.focal_length_mm / context.f_number


def _needed(outputs: module_ports.OtfOutputs, wanted: str) -> Step:
    factor = outputs.mtf.factors[0]
    assert isinstance(factor, Planar)
    bound = dict(factor.law.parameters)
    temperature = bound.pop("temperature_K")
    if not isinstance(temperature, Recipe):
        temperature = Step.of(number, value=temperature)
    del bound["wavelengths"]
    return Step.of(_wavelengths_needed, temperature, node=factor.node, wanted=wanted, **bound)


def _wavelengths_needed(
    work: Work,
    kelvin: float,
    *,
    aperture: physics.Aperture,
    tolerance: float,
    wanted: str,
    **spectrum: Any,
) -> float | int:
    lit = physics.Spectrum(temperature_K=kelvin, **spectrum)
    count, error = physics.wavelengths_needed(aperture, lit, tolerance)
    return count if wanted == "count" else error
