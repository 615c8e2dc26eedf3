"""Figures of a focal plane in electrons, from the mean of its picture."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from core.chain.step_lineage import LevelChange
from core.chain.wires import TableData
from core.errors import DataError
from core.evaluation.work import Work
from core.modules.parameters import Caution
from core.modules.preview import Bar, Bars, Preview, Stack, brief, electrons, kelvin
from core.physics.detector import focal_plane_array, photon_conversion
from core.physics.radiometry.planck import band_radiance, band_radiance_derivative
from core.records import dataclass, replace
from nodes.shared.module_ports import TableFigures
from nodes.shared.steps import PictureRange

SNR_AT_PERCENT = (1, 3, 10, 30, 90)
_TOLERANCE = {"single": 1e-8, "double": 2e-14}  # of electrons, below the samples' rounding


@dataclass(frozen=True)
class Collection:
    """What makes the mean number of electrons of a radiance.

    `scene_m2_s_sr` is area, time and solid angle of the exit pupil, stages included, and
    `housing_m2_s_sr` the same of the housing past the cold shield; optics and housing of None K
    emit nothing. `vignetting` is the mean illumination, which is among the responses too.
    """

    weights: photon_conversion.PhotonWeights
    scene_m2_s_sr: float
    housing_m2_s_sr: float
    optics_transmission: float
    optics_K: float | None
    housing_K: float | None
    dark_e: float
    vignetting: float

    def of_pixels(self, count: int) -> Collection:
        return replace(
            self,
            scene_m2_s_sr=self.scene_m2_s_sr * count,
            housing_m2_s_sr=self.housing_m2_s_sr * count,
            dark_e=self.dark_e * count,
        )

    @cached_property
    def optics_e(self) -> float:
        if self.optics_K is None:
            return 0.0
        photons = float(self.weights.efficiency.photon_radiance(self.optics_K))
        return self.scene_m2_s_sr * (1.0 - self.optics_transmission) * photons

    @cached_property
    def housing_e(self) -> float:
        if self.housing_K is None:
            return 0.0
        return self.housing_m2_s_sr * float(self.weights.efficiency.photon_radiance(self.housing_K))

    @property
    def per_photon(self) -> float:
        return self.scene_m2_s_sr * self.optics_transmission


@dataclass(frozen=True)
class ReadOut:
    """Noise, well and numbers, in electrons before the charge gain."""

    read_noise_e: float
    excess_factor: float
    frames: int
    prnu_percent: float
    dsnu_e: float
    nonlinearity_percent: float
    full_well_e: float | None
    gain_e_per_dn: float
    offset_dn: float
    bits: int
    numbers_summed: int = 1

    @property
    def response(self) -> dict[str, Any]:
        """How electrons are bent, where the well is known."""
        bent = self.nonlinearity_percent
        return {"full_well_e": self.full_well_e, "nonlinearity_percent": bent}

    @property
    def top_dn(self) -> float:
        """The last number, of all that are summed; infinite without a converter."""
        return self.numbers_summed * (2.0**self.bits - 1.0) if self.bits else np.inf

    @property
    def saturation_e(self) -> float:
        """Electrons at which the picture is clipped: the full well, or the last number before."""
        well = np.inf if self.full_well_e is None else self.full_well_e
        return float(min(well, (self.top_dn - self.offset_dn) * self.gain_e_per_dn))


@dataclass(frozen=True)
class ElectronLevels:
    """Electrons of a picture, and of its mean: those of the scene, and what is collected beside.

    `scene_K` is the brightness temperature of the mean, where that means anything; `slope`
    electrons per W/m²/sr there. Of a picture that comes as photons counted, whose spectrum is
    known, `radiance_per_photon` is the mean radiance over their mean.
    """

    conversion: photon_conversion.SmoothRatio
    seen: PictureRange
    scene_K: float | None
    signal_e: float
    slope: float
    radiance_per_photon: float | None
    electrons_per_K: float | None
    collection: Collection

    @property
    def pedestal_e(self) -> float:
        return self.collection.optics_e + self.collection.housing_e + self.collection.dark_e

    @property
    def total_e(self) -> float:
        return max(self.signal_e + self.pedestal_e, 0.0)

    @property
    def brightest_e(self) -> float:
        scene = self.conversion.times(np.array([self.seen.high]))
        return max(float(scene[0]) + self.pedestal_e, 0.0)


def electron_levels(
    work: Work, seen: PictureRange, per_photon: float | None = None, *, collection: Collection
) -> ElectronLevels:
    """What the picture's radiances, or the photons of it that are counted, are in electrons."""
    weights = collection.weights
    conversion = photon_conversion.conversion_between(
        weights=weights,
        electrons_per_photon=collection.per_photon,
        low=seen.low,
        high=seen.high,
        tolerance=_TOLERANCE[work.policy.precision],
    )
    kelvin = None
    if weights.is_thermal and seen.mean > 0.0:
        kelvin = weights.temperature(seen.mean)
    if seen.mean > 0.0:
        known = None if kelvin is None else np.array([kelvin])
        ratio = weights.per_radiance(np.array([seen.mean]), temperature_K=known)
        signal = collection.per_photon * float(ratio[0]) * seen.mean
        slope = collection.per_photon * weights.slope(seen.mean, temperature_K=kelvin)
    else:
        signal = float(conversion.times(np.array([seen.mean]))[0])
        slope = float(conversion.times(np.array([seen.high or 1.0]))[0]) / (seen.high or 1.0)
    per_kelvin = None if kelvin is None else slope * weights.per_kelvin(kelvin)
    return ElectronLevels(
        conversion, seen, kelvin, signal, slope, per_photon, per_kelvin, collection
    )


def scene_level(work: Work, levels: ElectronLevels) -> LevelChange:
    """The change from radiance to electrons, for what follows differences through it.

    Of photons counted it is the change from the black body's radiance in the band that gives as
    many, behind the vignetting: its slope by temperature is theirs.
    """
    per_photon, kelvin = levels.radiance_per_photon, levels.scene_K
    if per_photon is None:
        return LevelChange(levels.slope, levels.seen.mean, levels.signal_e)
    if kelvin is None or levels.electrons_per_K is None:
        mean = levels.seen.mean * per_photon
        return LevelChange(levels.slope / per_photon, mean, levels.signal_e, "", levels.slope)
    low, high = levels.collection.weights.band_um
    body = {"temperature_K": kelvin, "cut_on_um": low, "cut_off_um": high}
    radiance = levels.collection.vignetting * float(band_radiance(**body))
    slope = levels.collection.vignetting * float(band_radiance_derivative(**body))
    gain = levels.electrons_per_K / slope
    return LevelChange(gain, radiance, levels.signal_e, "", levels.slope)


def bent_level(work: Work, levels: ElectronLevels, **response: float) -> LevelChange:
    slope = focal_plane_array.bent_slope(electrons=levels.total_e, **response)
    return LevelChange(slope, levels.total_e, levels.signal_e * slope)


def radiance_level(work: Work, levels: ElectronLevels) -> LevelChange:
    gain = 1.0 / levels.slope if levels.slope > 0.0 else 0.0
    gain *= levels.radiance_per_photon or 1.0
    return LevelChange(gain, levels.total_e, levels.signal_e * gain)


def _bent(electrons: float, reading: ReadOut) -> float:
    if reading.full_well_e is None:
        return electrons
    return focal_plane_array.bent_response(electrons=electrons, **reading.response)


def mean_clipped(levels: ElectronLevels, reading: ReadOut) -> Caution | None:
    """Why the read-out's mean does not follow the scene, and what to change; None where it does."""
    mean_e, well = _bent(levels.total_e, reading), reading.full_well_e
    number, top_dn = mean_e / reading.gain_e_per_dn + reading.offset_dn, reading.top_dn
    if well is not None and (mean_e > well or _bent_slope(levels.total_e, reading) == 0.0):
        return Caution(
            f"the picture's mean reaches {100.0 * mean_e / well:.4g} % of the full well and is "
            "clipped",
            "lower integration_time_s, tdi_stages or the picture's radiance, or raise full_well_e",
        )
    if number > top_dn:
        return Caution(
            f"the picture's mean gives {number:.5g} DN, above the converter's maximum of "
            f"{top_dn:.0f} DN, and is clipped",
            "raise gain_e_per_dn or bits, or lower gain_dB or offset_dn",
        )
    if number < 0.0 and np.isfinite(top_dn):
        return Caution(
            f"the picture's mean gives {number:.5g} DN, below the converter's minimum of 0 DN, and "
            "is clipped",
            "raise offset_dn",
        )
    return None


def _bent_slope(electrons: float, reading: ReadOut) -> float:
    """Rise of the response there; 0 where it has been bent until it is flat."""
    if reading.full_well_e is None:
        return 1.0
    return focal_plane_array.bent_slope(electrons=electrons, **reading.response)


def overflow_caution(work: Work, levels: ElectronLevels, *, reading: ReadOut) -> Caution | None:
    """A picture whose mean, or brightest, is clipped; noise and unlike pixels are left out."""
    clipped = mean_clipped(levels, reading)
    if clipped is not None:
        return replace(clipped, message=f"{clipped.message}: NETD, SNR and NEI are left out")
    saturation = reading.saturation_e
    if levels.brightest_e > saturation:
        return Caution(
            f"the brightest pixels saturate: they reach {levels.brightest_e:.4g} e- and are "
            f"clipped at {saturation:.4g} e-; SNR and noise refer to the mean level; "
            "saturated_pixels counts clipped pixels",
            "lower integration_time_s, or raise full_well_e, gain_e_per_dn or bits",
        )
    return None


def reference_caution(work: Work, found: TableData) -> Caution | None:
    (row,) = (row for row in found.rows if row.name == "snr_at_reference")
    if not row.reason:
        return None
    return Caution(
        f"{row.reason}: snr_at_reference is left out",
        "lower reference_radiance or integration_time_s, or check full_well_e, gain_e_per_dn "
        "and bits",
    )


def clipping_level(work: Work, levels: ElectronLevels, *, reading: ReadOut) -> LevelChange:
    """What a read-out that ends does to small differences about the mean: nothing, or all."""
    clipped = mean_clipped(levels, reading)
    if clipped is None:
        return LevelChange(1.0, levels.total_e, levels.signal_e)
    return LevelChange(0.0, levels.total_e, 0.0, clipped.message)


FIGURES = TableFigures(
    ("signal_e", "e-", "Electrons from the scene, at the picture's mean."),
    ("optics_e", "e-", "Electrons from the optics' own emission."),
    ("housing_e", "e-", "Electrons from the housing past the cold shield."),
    ("dark_e", "e-", "Electrons from the dark current."),
    ("well_fill_percent", "%", "Fraction of the full well filled by all electrons."),
    ("shot_noise_e", "e-", "Shot noise of all electrons."),
    ("excess_noise_e", "e-", "Excess noise of the charge gain."),
    ("read_noise_e", "e-", "Read noise after frame averaging."),
    ("quantization_noise_e", "e-", "Quantization noise of the converter."),
    ("temporal_noise_e", "e-", "Temporal noise: shot, excess, read and quantization noise "
     "together."),
    ("fixed_pattern_e", "e-", "Fixed-pattern noise: PRNU and DSNU together."),
    ("responsivity_e_per_K", "e-/K", "Responsivity: electrons per kelvin of scene temperature, "
     "for a thermal scene."),
    ("netd_K", "K", "NETD: temporal noise over responsivity, for a thermal scene."),
    ("snr", "", "SNR: signal over temporal noise."),
    ("snr_at_reference", "", "SNR at reference_radiance: signal over temporal noise."),
    ("nei_photons_per_cm2", "1/cm²", "Noise-equivalent irradiance: photons per cm² and "
                                     "exposure whose signal equals the temporal noise."),
    ("dynamic_range_dB", "dB", "Dynamic range: saturation (full well or highest DN) over the "
     "temporal dark noise."),
    ("emva_dynamic_range_dB", "dB", "Dynamic range according to EMVA 1288: saturation over "
     "the sensitivity threshold."),
    ("sensitivity_threshold_photons", "photons", "Sensitivity threshold according to EMVA "
     "1288: photons per pixel at which the SNR is 1."),
    ("snr_max_dB", "dB", "Maximum SNR according to EMVA 1288: at saturation, with shot noise "
     "alone."),
    ("gain_e_per_dn", "e-/DN", "Electrons per digital number."),
    ("mean_dn", "DN", "Mean signal of the picture, in digital numbers."),
    ("photon_weighting", "", "Spectrum used to count photons: scene, source or middle."),
    ("weighting_worth_percent", "%", ("Largest minus smallest signal over the choices "
                                     "of photon_weighting, relative to signal_e.")),
    # The figures of the mean, for which no sample is made.
    table=lambda outputs: outputs.table.recipe.inputs[0],
)  # fmt: skip


def figures(
    work: Work,
    levels: ElectronLevels,
    *,
    reading: ReadOut,
    area_cm2: float,
    reference_radiance: float | None = None,
) -> TableData:
    """All figures at the mean of the picture, in the order of the panel.

    Signal, well fill and dark current are of the electrons collected; noise, pattern and
    responsivity are those behind the nonlinearity.
    """
    total, frames = levels.total_e, reading.frames
    slope = _bent_slope(total, reading)
    shot, read, rounding, temporal = _noises(total, reading)
    excess = shot * (reading.excess_factor - 1.0) ** 0.5
    clipped = mean_clipped(levels, reading)
    why = "" if clipped is None else clipped.message
    responsivity, netd = levels.electrons_per_K if clipped is None else None, None
    if responsivity is not None:
        responsivity *= slope
        of_K = {"temporal_e": temporal, "responsivity_e_per_K": responsivity}
        netd = _finite(focal_plane_array.netd_of_electrons_K(**of_K))
    well, decibels, too_dark = reading.full_well_e, None, ""
    fill = None if well is None else 100.0 * total / well
    saturation = reading.saturation_e
    collected = levels.collection
    dark = collected.dark_e * reading.excess_factor / frames
    dark_noise = math.hypot(read, rounding, focal_plane_array.shot_noise_e(electrons=dark))
    if collected.dark_e >= saturation:
        too_dark = f"{collected.dark_e:.4g} dark electrons reach saturation at {saturation:.4g} e-"
    elif 0.0 < saturation < np.inf:
        ends = {"full_well_e": saturation, "dark_noise_e": dark_noise}
        decibels = _finite(focal_plane_array.dynamic_range_dB(**ends))
    snr = _snr(levels, reading)
    efficiency = _efficiency(levels)
    nei = None
    if efficiency > 0.0 and clipped is None:
        nei = focal_plane_array.nei_photons_per_cm2(
            temporal_e=temporal / slope, quantum_efficiency=efficiency, area_cm2=area_cm2
        )
    pattern = focal_plane_array.fixed_pattern_e(
        electrons=total, prnu_percent=reading.prnu_percent, dsnu_e=reading.dsnu_e
    )
    threshold = None
    if efficiency:
        threshold = (dark_noise + 0.5 * reading.excess_factor / frames) / efficiency
    return FIGURES.table(
        ("signal_e", levels.signal_e),
        ("optics_e", collected.optics_e),
        ("housing_e", collected.housing_e),
        ("dark_e", collected.dark_e),
        ("well_fill_percent", fill),
        ("shot_noise_e", shot),
        ("excess_noise_e", excess),
        ("read_noise_e", read),
        ("quantization_noise_e", rounding),
        ("temporal_noise_e", temporal),
        ("fixed_pattern_e", slope * pattern),
        ("responsivity_e_per_K", responsivity, why),
        ("netd_K", netd, why),
        ("snr", snr, why),
        *_at_reference(levels, reading, reference_radiance),
        ("nei_photons_per_cm2", nei, why),
        ("dynamic_range_dB", decibels, too_dark),
        *_emva(levels, reading, efficiency, threshold),
        ("gain_e_per_dn", reading.gain_e_per_dn),
        ("mean_dn", _bent(total, reading) / reading.gain_e_per_dn + reading.offset_dn),
        ("scene_K", levels.scene_K, "K", "brightness temperature of the picture's mean"),
        ("quantum_efficiency", efficiency, "", "electrons per photon, averaged over the band"),
        ("photon_weighting", collected.weights.used),
        *_worth(levels),
    )


def _noises(total_e: float, reading: ReadOut) -> tuple[float, float, float, float]:
    shot = focal_plane_array.shot_noise_e(electrons=total_e, frames_averaged=reading.frames)
    shot *= _bent_slope(total_e, reading)
    read = reading.read_noise_e / reading.frames**0.5
    step = reading.gain_e_per_dn * reading.numbers_summed**0.5
    rounding = focal_plane_array.quantization_noise_e(gain_e_per_dn=step) if reading.bits else 0.0
    counted = shot * reading.excess_factor**0.5
    temporal = focal_plane_array.temporal_noise_e(
        shot_e=counted, read_e=read, quantization_e=rounding
    )
    return shot, read, rounding, temporal


def _snr(levels: ElectronLevels, reading: ReadOut) -> float | None:
    """Signal over temporal noise; None where the picture is clipped, or without noise."""
    signal, temporal = levels.signal_e, _noises(levels.total_e, reading)[3]
    if reading.nonlinearity_percent:
        signal = _bent(levels.total_e, reading) - _bent(levels.pedestal_e, reading)
    return signal / temporal if temporal and mean_clipped(levels, reading) is None else None


def _at_reference(
    levels: ElectronLevels, reading: ReadOut, radiance: float | None
) -> Iterator[tuple[Any, ...]]:
    """Signal and SNR of a uniform scene of a spectral radiance, W/m²/sr/µm; empty without one."""
    signal, snr, why = None, None, ""
    if radiance is not None:
        collected = levels.collection
        signal = collected.per_photon * collected.weights.flat_photons * radiance
        there = replace(levels, signal_e=signal)
        snr, clipped = _snr(there, reading), mean_clipped(there, reading)
        if clipped is not None:
            why = clipped.message.replace("the picture's mean", "reference_radiance")
    yield "reference_e", signal, "e-", "signal at reference_radiance"
    yield "snr_at_reference", snr, why


def _emva(
    levels: ElectronLevels, reading: ReadOut, efficiency: float, threshold: float | None
) -> Iterator[tuple[Any, ...]]:
    """SNR_max = √µe.sat and µp.min, and the SNR from dark to bright scenes of this spectrum.

    Source: EMVA Standard 1288, release 4.0 Linear (2021).
    """
    room = reading.saturation_e - levels.pedestal_e
    most = radiance = None
    if 0.0 < room < np.inf:
        most = math.sqrt(reading.saturation_e * reading.frames / reading.excess_factor)
        share = room / levels.signal_e if levels.signal_e > 0.0 else math.inf
        radiance = _finite(levels.seen.mean * (levels.radiance_per_photon or 1.0) * share)
    yield "snr_max", most, "", "SNR at saturation with shot noise alone (EMVA 1288)"
    yield "snr_max_dB", 20.0 * math.log10(most) if most else None
    yield "sensitivity_threshold_photons", threshold
    ratio = None
    if threshold and reading.saturation_e < np.inf:
        ratio = 20.0 * math.log10(reading.saturation_e / (threshold * efficiency))
    yield "emva_dynamic_range_dB", ratio
    yield "saturation_radiance", radiance, "W/m²/sr", "radiance that saturates the pixels"
    for percent in SNR_AT_PERCENT:
        lit = replace(levels, signal_e=room * percent / 100.0)
        snr = None if most is None else _snr(lit, reading)
        yield f"snr_at_{percent}_percent", snr, "", f"SNR at {percent} % of saturation_radiance"


def _worth(levels: ElectronLevels) -> Iterator[tuple[Any, ...]]:
    """What each other weighting would make of the signal, and by how much they differ."""
    known: list[float] = []
    collected = levels.collection
    known_spectrum = collected.weights.used == "spectrum"
    for weighting in photon_conversion.WEIGHTINGS:
        signal: float | None = None
        weights = replace(collected.weights, weighting=weighting)
        if levels.seen.mean > 0.0 and weights.used == weighting and not known_spectrum:
            try:
                ratio = weights.per_radiance(np.array([levels.seen.mean]))
            except DataError:  # a source too cold to be one, which is not the one that is used
                pass
            else:
                signal = collected.per_photon * float(ratio[0]) * levels.seen.mean
                known.append(signal)
        meaning = f"signal if photon_weighting is {weighting}"
        yield f"signal_by_{weighting}_e", signal, "e-", meaning
    worth = None
    if len(known) > 1 and levels.signal_e > 0.0:
        worth = 100.0 * (max(known) - min(known)) / levels.signal_e
    yield "weighting_worth_percent", worth


def _efficiency(levels: ElectronLevels) -> float:
    weights = levels.collection.weights
    efficiency = weights.efficiency
    if not efficiency.points:
        return efficiency.value
    seen = weights.used in ("scene", "spectrum") and levels.scene_K is not None
    kelvin = levels.scene_K if seen else weights.source_K
    if weights.used == "middle" or kelvin is None:
        return efficiency.mean()
    whole = float(replace(efficiency, value=1.0, points=()).photon_radiance(kelvin))
    return float(efficiency.photon_radiance(kelvin)) / whole if whole > 0.0 else 0.0


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


# The preview: the well as a bar, filled by what brings electrons, and a bar for every noise.

_BAR_LINES = 1.4  # of text, a noise's bar
_SOURCES = (
    ("scene", "signal_e"),
    ("optics", "optics_e"),
    ("housing", "housing_e"),
    ("dark", "dark_e"),
)
_NOISES = (
    ("shot", "shot_noise_e"),
    ("read", "read_noise_e"),
    ("rounding", "quantization_noise_e"),
    ("fixed pattern", "fixed_pattern_e"),
)


def budget_preview(figures: Mapping[str, Any], full_well_e: float | None) -> Preview:
    """Where a pixel's electrons come from, and its noise by source, at the picture's mean."""
    per_K, netd_K, snr = (figures[key] for key in ("responsivity_e_per_K", "netd_K", "snr"))
    total = max(sum(figures[key] for _, key in _SOURCES), 0.0)
    filled = f"{electrons(total)}, no full well entered"
    if full_well_e:
        filled = f"{electrons(total)}: {brief(100 * (total / full_well_e))} % of the well"

    def noise(size: float) -> str:
        text = electrons(size)
        return f"{text}, {kelvin(size / per_K)}" if per_K else text

    sources = tuple(
        Bar(name, figures[key], electrons(figures[key]), colour)
        for colour, (name, key) in enumerate(_SOURCES)
    )
    bars = [
        Bar(name, figures[key], noise(figures[key]), colour)
        for colour, (name, key) in enumerate(_NOISES, len(_SOURCES))
    ]
    excess, more = figures["excess_noise_e"], 0.0
    if excess:
        bars.insert(1, Bar("excess", excess, noise(excess), bars[0].colour))
        more = _BAR_LINES
    temporal = figures["temporal_noise_e"]
    words = [filled, *(f"{bar.name} noise {bar.value}" for bar in bars)]
    words.append(f"total temporal noise {noise(temporal)}")
    merit = f"SNR {brief(snr)}" if snr is not None else ""
    if netd_K is not None:
        merit = f"NETD {kelvin(netd_K)}"
    well = Stack(sources, full_well_e, filled, merit, excess=total > (full_well_e or math.inf))
    all_bars = (*bars, Bar("temporal", temporal, noise(temporal), "faint_text"))
    parts = (well, Bars(all_bars, 6.9 + more))
    return Preview("; ".join([*words, merit] if merit else words), parts, more_lines=more)
