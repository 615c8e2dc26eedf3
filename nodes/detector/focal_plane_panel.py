"""The panel of Focal Plane, and what its parameters come to."""

from pathlib import Path
from typing import Literal

from core.chain.wires import Context, Image
from core.errors import ParameterError
from core.modules.declaration import NodeContext, Section, param
from core.physics.detector import focal_plane_array, photon_conversion
from core.physics.detector.detectivity import ResponseCurve
from core.physics.detector.focal_plane_array import ChargeGain, excess_noise_factor
from core.records import replace
from nodes.detector.focal_plane_figures import Collection, ReadOut
from nodes.detector.spectral_response import lit_windows
from nodes.files.curve_tables import read_wavelengths
from nodes.shared.context_defaults import given_band, lens, of_context, pixel_of
from nodes.shared.deviates import SEED_SECTIONS, SeededModule

_ALL = 0.0, 1e6  # µm


class FocalPlanePanel(SeededModule):
    integration_time_s: float = param(
        0.001, "integration time (with TDI: of each stage)", (0, 1e4), above=True, slider=(0, 0.05)
    )
    tdi_stages: int = param(
        1, "number of TDI stages (time delay and integration)", (1, 10000), slider=(1, 128)
    )
    frames_averaged: int = param(1, "number of frames averaged", (1, 1000000), slider=(1, 64))
    quantum_efficiency: float = param(
        0.7, "electrons per photon within the band", (0, 1), above=True
    )
    quantum_efficiency_percent: float | None = param(
        None, "quantum efficiency in per cent; if given, it replaces quantum_efficiency", (0, 100)
    )
    responsivity_A_per_W: float | None = param(
        None,
        "current responsivity; if given, it replaces quantum_efficiency",
        (0, 1e6),
        slider=(0, 10),
    )
    responsivity_um: float | None = param(
        None,
        "wavelength of responsivity_A_per_W; the quantum efficiency at this wavelength is used "
        "over the whole band",
        (0, 1e3),
        slider=(0, 14),
    )
    response: Path | None = param(
        None,
        "CSV file of wavelength (µm) and quantum efficiency; if given, it replaces "
        "quantum_efficiency",
    )
    cut_on_um: float | None = param(
        None, "shortest wavelength of the cold filter; empty: the image's band", low=0
    )
    cut_off_um: float | None = param(
        None, "longest wavelength of the cold filter; empty: the image's band", low=0
    )
    photon_weighting: Literal["scene", "source", "middle"] = param(
        "scene",
        "spectrum used to convert radiance to photons: a black body at the scene's "
        "temperature or at source_K, or the band's middle wavelength",
    )
    source_K: float = param(
        5800.0, "temperature of the light source", (0, 1e6), above=True, slider=(1000, 6500)
    )
    optics_transmission: float = param(
        1.0, "transmission of the optics, without the obscuration", (0, 1), above=True
    )
    optics_K: float | None = param(
        None, "temperature of the optics; empty: no emission", (0, 1e4), slider=(200, 340)
    )
    cold_shield_efficiency: float = param(
        1.0, "fraction of the housing's radiation that the cold shield blocks", (0, 1)
    )
    housing_K: float | None = param(
        None,
        "temperature of the housing outside the cold shield; empty: no emission",
        (0, 1e4),
        slider=(200, 340),
    )
    dark_current_e_per_s: float = param(0.0, "dark current per pixel", (0, 1e15), slider=(0, 1e7))
    dark_current_A_per_cm2: float = param(
        0.0,
        "dark current per unit of pixel area, instead of dark_current_e_per_s",
        (0, 1e6),
        slider=(0, 1e-6),
    )
    dark_reference_K: float | None = param(
        None,
        "temperature at which the dark current is given; empty: the detector's temperature",
        (0, 1e3),
        slider=(60, 320),
    )
    dark_doubling_K: float | None = param(
        None,
        "temperature rise that doubles the dark current; empty: no change with temperature",
        (0, 1e3),
        slider=(2, 15),
    )
    rule_07: bool = param(False, "compute the dark current of HgCdTe with Rule 07")
    detector_K: float | None = param(
        None,
        "temperature of the detector, for Rule 07 and dark_doubling_K",
        (0, 1e3),
        slider=(60, 200),
    )
    material_cutoff_um: float | None = param(
        None, "cutoff wavelength of the detector material, for Rule 07", (0, 100), slider=(2, 16)
    )
    full_well_e: float | None = param(
        None, "electrons that a pixel can hold; empty: unlimited", low=0, slider=(0, 1e7)
    )
    register_well_e: float | None = param(
        None,
        "electrons that the read-out can hold, after binning and charge gain; empty: unlimited",
        low=0,
        slider=(0, 1e7),
    )
    charge_gain: ChargeGain = param(
        "none",
        "gain before the read-out: in a photoconductor (QWIP), an EMCCD register or an "
        "avalanche diode",
    )
    charge_gain_factor: float = param(
        1.0,
        "mean number of output electrons per input electron",
        (0, 1e5),
        above=True,
        slider=(0.1, 1000),
    )
    excess_noise_factor: float | None = param(
        None,
        "factor by which the charge gain raises the variance of the electrons; empty: computed",
        (1, 1e5),
        slider=(1, 4),
    )
    register_stages: int = param(536, "stages of the EM register", (1, 100000), slider=(100, 1000))
    ionization_ratio: float = param(
        0.0,
        "k: ratio of the lower to the higher ionization rate; 0: only one type of carrier ionizes",
        (0, 1),
    )
    nonlinearity_percent: float = param(
        0.0,
        "signal loss at the full well, relative to a linear response; the number of electrons "
        "lost grows with the square of the signal",
        (0, 25),
        slider=(0, 5),
    )
    read_noise_e: float = param(0.0, "read noise", (0, 1e12), slider=(0, 1000))
    prnu_percent: float = param(
        0.0, "PRNU: rms spread of the response between pixels", (0, 100), slider=(0, 5)
    )
    dsnu_e: float = param(
        0.0, "DSNU: rms spread of the dark level between pixels", (0, 1e12), slider=(0, 2000)
    )
    bad_pixel_percent: float = param(
        0.0, "share of dead and hot pixels, some of them clustered", (0, 100), slider=(0, 1)
    )
    binning: Literal["charge", "digital"] = param(
        "charge",
        "quantity that binning sums: the pixels' charge before read noise, or their "
        "digital numbers",
    )
    binning_x: int = param(1, "number of pixels summed horizontally", (1, 1024), slider=(1, 8))
    binning_y: int = param(1, "number of pixels summed vertically", (1, 1024), slider=(1, 8))
    bits: int = param(0, "bits of the converter; 0: no converter", (0, 24), unit="bit")
    gain_e_per_dn: float | None = param(
        None,
        "electrons per digital number; empty: the full well maps to the highest number",
        low=0,
        slider=(0, 1000),
    )
    gain_dB: float = param(
        0.0,
        "gain setting of the camera; 20 dB divides gain_e_per_dn by 10",
        (-120, 120),
        slider=(0, 48),
    )
    offset_dn: float = param(
        0.0, "digital number at zero electrons", (-(2.0**24), 2.0**24), slider=(0, 1000)
    )
    reference_radiance: float | None = param(
        None,
        "spectral radiance at which snr_at_reference is computed; empty: no snr_at_reference",
        low=0,
        unit="W/m²/sr/µm",
        slider=(0, 300),
    )
    units: Literal["dn", "electrons", "radiance"] = param(
        "dn", "unit of the output; with bits above 0, the output is digitized in every unit"
    )

    panel = (
        Section("Exposure", "integration_time_s tdi_stages frames_averaged", page="Light"),
        Section("Quantum efficiency",
                "quantum_efficiency quantum_efficiency_percent responsivity_A_per_W "
                "responsivity_um response cut_on_um cut_off_um", page="Light"),
        Section("Radiance to photons", "photon_weighting source_K", page="Light"),
        Section("SNR", "reference_radiance", page="Light"),
        Section("Optics", "optics_transmission optics_K", page="Thermal"),
        Section("Housing", "cold_shield_efficiency housing_K", page="Thermal"),
        Section("Dark current",
                "dark_current_e_per_s dark_current_A_per_cm2 dark_reference_K "
                "dark_doubling_K rule_07 detector_K material_cutoff_um", page="Thermal"),
        Section("Charge gain", "charge_gain", page="Gain"),
        Section("", "charge_gain_factor excess_noise_factor", page="Gain",
                shown_when=("charge_gain", ("photoconductive", "em_register", "avalanche"))),
        Section("", "register_stages", page="Gain", shown_when=("charge_gain", ("em_register",))),
        Section("", "ionization_ratio", page="Gain", shown_when=("charge_gain", ("avalanche",))),
        Section("Binning", "binning binning_x binning_y", page="Gain"),
        Section("Well", "full_well_e register_well_e nonlinearity_percent", page="Read-out"),
        Section("Noise", "read_noise_e prnu_percent dsnu_e bad_pixel_percent", page="Read-out"),
        Section("Numbers", "bits gain_e_per_dn gain_dB offset_dn units", page="Read-out"),
        *SEED_SECTIONS,
    )  # fmt: skip

    def check(self) -> None:
        low, high = self.cut_on_um, self.cut_off_um
        if low is not None and high is not None and low >= high:
            raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}")
        for needed, given, why in (
            ("full_well_e", self.nonlinearity_percent > 0,
             "nonlinearity_percent refers to the full well"),
            ("housing_K", self.cold_shield_efficiency < 1,
             "with a cold_shield_efficiency below 1, radiation from the housing reaches the "
             "detector"),
            ("detector_K", self.rule_07 or self.dark_doubling_K,
             "rule_07 and dark_doubling_K need the detector's temperature"),
            ("material_cutoff_um", self.rule_07, "rule_07 needs the material's cutoff wavelength"),
            ("dark_reference_K", self.dark_doubling_K,
             "dark_doubling_K scales the dark current from dark_reference_K"),
            ("dark_doubling_K", self.dark_reference_K,
             "without dark_doubling_K, the dark current is known only at dark_reference_K"),
            ("responsivity_um", self.responsivity_A_per_W,
             "responsivity_A_per_W needs a wavelength"),
            ("responsivity_A_per_W", self.responsivity_um,
             "responsivity_um is used only with responsivity_A_per_W"),
        ):  # fmt: skip
            if given and getattr(self, needed) is None:
                raise ParameterError(needed, None, f"{why}; give a number")
        forms = ("response", "responsivity_A_per_W", "quantum_efficiency_percent")
        typed = [name for name in forms if getattr(self, name) is not None]
        if len(typed) > 1:
            allowed = f"must be empty if {typed[0]} is given"
            raise ParameterError(typed[1], getattr(self, typed[1]), allowed)
        self._efficiency()
        self._excess_factor()
        if self.dark_current_e_per_s and self.dark_current_A_per_cm2:
            allowed = f"0 if dark_current_e_per_s = {self.dark_current_e_per_s:g} is given"
            current = self.dark_current_A_per_cm2
            raise ParameterError("dark_current_A_per_cm2", current, allowed)
        if self.bits and self.gain_e_per_dn is None and self._well_e() is None:
            allowed = "with bits above 0, gain_e_per_dn (e-/DN) or full_well_e (e-) must be given"
            raise ParameterError("gain_e_per_dn", None, allowed, unit="")

    @property
    def pixels(self) -> int:
        return self.binning_x * self.binning_y

    @property
    def sums_charge(self) -> bool:
        return self.pixels > 1 and self.binning == "charge"

    def delivered(self) -> ReadOut:
        """The read-out of a whole bin, for its figures: patterns and digital sums are in it."""
        count = self.pixels
        prnu, dsnu = self.prnu_percent / count**0.5, self.dsnu_e * count**0.5
        reading = replace(self.read_out(), prnu_percent=prnu, dsnu_e=dsnu)
        if self.sums_charge:
            return reading
        well = reading.full_well_e
        return replace(
            reading,
            read_noise_e=reading.read_noise_e * count**0.5,
            full_well_e=None if well is None else well * count,
            offset_dn=reading.offset_dn * count,
            numbers_summed=count,
        )

    def read_out(self) -> ReadOut:
        """Noise, well and numbers of what is read, in electrons before the charge gain."""
        gain, charge, well = self.gain_e_per_dn, self._gain(), self._well_e()
        per_dn = 1.0 if gain is None else gain / charge
        if gain is None and self.bits and well is not None:
            per_dn = focal_plane_array.gain_to_fill_e_per_dn(full_well_e=well, bits=self.bits)
        return ReadOut(
            read_noise_e=self.read_noise_e / charge,
            excess_factor=self._excess_factor(),
            frames=self.frames_averaged,
            prnu_percent=self.prnu_percent,
            dsnu_e=self.dsnu_e,
            nonlinearity_percent=self.nonlinearity_percent,
            full_well_e=well,
            gain_e_per_dn=per_dn / 10.0 ** (self.gain_dB / 20.0),
            offset_dn=self.offset_dn,
            bits=self.bits,
        )

    def _gain(self, *, in_pixel: bool = False) -> float:
        """Charge gain before the read-out, or that within the pixel: a register's comes after."""
        used = self.charge_gain != "none" and not (in_pixel and self.charge_gain == "em_register")
        return self.charge_gain_factor if used else 1.0

    def _excess_factor(self) -> float:
        computed = excess_noise_factor(
            charge_gain=self.charge_gain,
            factor=self._gain(),
            register_stages=self.register_stages,
            ionization_ratio=self.ionization_ratio,
        )
        if self.charge_gain == "none" or self.excess_noise_factor is None:
            return computed
        return self.excess_noise_factor

    @property
    def pixel_well_e(self) -> float | None:
        """Electrons before the gain that fill a pixel."""
        return None if self.full_well_e is None else self.full_well_e / self._gain(in_pixel=True)

    def _well_e(self) -> float | None:
        """Electrons before the gain that fill pixels or read-out, whichever comes first."""
        pixel, register = self.pixel_well_e, self.register_well_e
        wells = [] if pixel is None else [pixel * (self.pixels if self.sums_charge else 1)]
        wells += [] if register is None else [register / self._gain()]
        return min(wells, default=None)

    def collection(self, image: Image, context: Context, here: NodeContext) -> Collection:
        band = image.band_um or context.band_um
        low, high = given_band(self.cut_on_um, self.cut_off_um, band)
        points = self._points(here)
        efficiency = photon_conversion.QuantumEfficiency(low, high, self._efficiency(), points)
        exposure = focal_plane_array.exposure_m2_s(
            **pixel_of(context),
            integration_time_s=self.integration_time_s,
            tdi_stages=self.tdi_stages,
        )
        optics = lens(context, optics_transmission=self.optics_transmission)
        housing = focal_plane_array.housing_sr(
            solid_angle_sr=optics.solid_angle_sr, cold_shield_efficiency=self.cold_shield_efficiency
        )
        weighting = self.photon_weighting if image.bands is None else "spectrum"
        passed = image.responses
        if image.vignetting not in (0.0, 1.0):  # as a grey filter
            passed += (ResponseCurve("file", points=tuple((um, image.vignetting) for um in _ALL)),)
        windows = () if image.bands is None else lit_windows(image.bands)
        light = weighting, band or (low, high), efficiency, self.source_K
        weights = photon_conversion.PhotonWeights(*light, passed, windows)
        return Collection(
            weights=weights,
            scene_m2_s_sr=exposure * optics.solid_angle_sr,
            housing_m2_s_sr=exposure * housing,
            optics_transmission=optics.transmission,
            optics_K=self.optics_K,
            housing_K=self.housing_K,
            dark_e=focal_plane_array.dark_electrons(
                dark_current_e_per_s=self._dark_current(context),
                integration_time_s=self.integration_time_s,
                tdi_stages=self.tdi_stages,
            ),
            vignetting=image.vignetting,
        )

    def _efficiency(self) -> float:
        if self.responsivity_A_per_W is not None and self.responsivity_um is not None:
            return photon_conversion.efficiency_of_responsivity(
                responsivity_A_per_W=self.responsivity_A_per_W,
                wavelength_um=self.responsivity_um,
                gain=self._gain(in_pixel=True),
            )
        percent = self.quantum_efficiency_percent
        return self.quantum_efficiency if percent is None else percent / 100.0

    def _points(self, here: NodeContext) -> tuple[tuple[float, float], ...]:
        if self.response is None:
            return ()
        path = here.folder / self.response
        return read_wavelengths(path, what="quantum efficiency", low=0.0, high=1.0)

    def _dark_current(self, context: Context) -> float:
        pitch_x = of_context("detector_x_um", context)
        area_um2 = pitch_x * of_context("detector_y_um", context)
        kelvin = self.detector_K
        if self.rule_07 and kelvin is not None and self.material_cutoff_um is not None:
            return focal_plane_array.rule_07_e_per_s(
                cutoff_um=self.material_cutoff_um, detector_K=kelvin, area_um2=area_um2
            )
        current = self.dark_current_e_per_s
        if self.dark_current_A_per_cm2:
            density = self.dark_current_A_per_cm2
            current = focal_plane_array.current_e_per_s(
                dark_current_A_per_cm2=density, area_um2=area_um2
            )
            current /= self._gain(in_pixel=True)
        if kelvin is None or self.dark_reference_K is None or self.dark_doubling_K is None:
            return current
        return current * focal_plane_array.dark_factor(
            detector_K=kelvin, reference_K=self.dark_reference_K, doubling_K=self.dark_doubling_K
        )
