"""The stages of Electronics & Noise as steps."""

from math import hypot
from typing import Any

import numpy as np

from core import kernels
from core.arrays import Array
from core.chain.noise_power import NoisePower
from core.chain.step_lineage import AtStep, Linear, Noise, picture_step
from core.chain.wires import TableData
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, pointwise
from core.evaluation.work import Work
from core.physics.detector.detectivity import band_d_star, cold_shield_half_angle_deg
from core.physics.detector.readout import apply_gain_bias, quantization_rms
from core.physics.noise import noise_equivalent
from core.physics.radiometry.planck import brightness_temperature
from core.physics.radiometry.spectra import find_material
from core.records import dataclass
from nodes.shared.context_defaults import Lens
from nodes.shared.module_ports import TableFigures
from nodes.shared.steps import PictureRange

DetectorFigures = dict[str, float]


def detector_figures(
    work: Work,
    seen: PictureRange,
    *,
    band_um: tuple[float, float],
    material: tuple[str, str],
    d_star: float | None,
    lens: Lens,
    filter_transmission: float,
    area_cm2: float,
    bandwidth_Hz: float,
    background_K: float | None,
    vignetting: float,
) -> DetectorFigures:
    """Background and NETD are those of the scene before the vignetting; the cold shield fits."""
    band = {"cut_on_um": band_um[0], "cut_off_um": band_um[1]}
    background = background_K
    if background is None:
        if seen.mean <= 0:
            raise DataError(
                f"the picture's mean {seen.mean:.6g} is not a valid background radiance: give "
                "background_K"
            )
        background = float(brightness_temperature(radiance=seen.mean / vignetting, **band))
    d_star = d_star or _band_d_star(band_um, material, lens, background)
    throughput = noise_equivalent.g_number(
        f_number=lens.f_number,
        filter_transmission=filter_transmission,
        optics_transmission=lens.transmission,
        obscuration_ratio=lens.obscuration_ratio,
        irradiance=lens.irradiance,
    )
    nep = noise_equivalent.nep_W(area_cm2=area_cm2, bandwidth_Hz=bandwidth_Hz, d_star=d_star)
    ner = noise_equivalent.ner_W_m2_sr(nep_W=nep, area_cm2=area_cm2, g_number=throughput)
    netd = float(
        noise_equivalent.netd_K(noise_radiance=ner / vignetting, background_K=background, **band)
    )
    figures = {"background_K": background, "g_number": throughput, "d_star": d_star}
    return {**figures, "nep_W": nep, "ner": ner, "netd_K": netd}


FIGURES = TableFigures(
    ("bandwidth_Hz", "Hz", "Noise bandwidth."),
    ("g_number", "1/sr", "Optical throughput number G#."),
    ("d_star", "cm √Hz/W", "Specific detectivity over the band."),
    ("nep_W", "W", "Noise-equivalent power of a detector with the mean noise of all."),
    ("ner", "W/m²/sr", "Noise-equivalent radiance of a detector with the mean noise of all."),
    ("netd_detector_K", "K", "NETD of the detectors, from the rms noise over all detectors."),
    ("netd_amplifier_K", "K", "NETD of the amplifier."),
    ("netd_system_K", "K", "NETD of detector and amplifier together."),
    ("snr", "", "SNR: mean signal over rms noise of detector and amplifier."),
    ("quantization_rms", "W/m²/sr", "Quantization noise."),
    ("background_K", "K", "Background temperature for D* and dL/dT."),
)


def figures(
    work: Work,
    seen: PictureRange,
    computed: DetectorFigures,
    *,
    bandwidth_Hz: float,
    amplifier_snr: float | None,
    snr_reference: str,
    variability_percent: float,
) -> TableData:
    """All read-outs of noise, in the order of the panel.

    NEP and NER are of a detector of mean noise; NETD and SNR are of the picture, with the rms over
    all detectors: √(1 + v²) times as much where v is the spread of their noise.
    """
    rms_over_mean = hypot(1.0, variability_percent / 100.0)
    sigma = 0.0
    if amplifier_snr is not None:
        level = abs(seen.mean) if snr_reference == "mean" else seen.high - seen.low
        sigma = float(
            noise_equivalent.amplifier_noise_radiance(reference_radiance=level, snr=amplifier_snr)
        )
        if not np.isfinite(sigma):
            raise ParameterError("amplifier_snr", amplifier_snr, "large enough for finite noise")
    # NETD is noise over dL/dT: the detector's own gives the slope without Planck's integral.
    netd_amplifier = computed["netd_K"] * sigma / computed["ner"]
    netd_detector = computed["netd_K"] * rms_over_mean
    both = {"amplifier_netd_K": netd_amplifier, "detector_netd_K": netd_detector}
    netd_system = noise_equivalent.system_netd_K(**both)
    noise = float(np.hypot(computed["ner"] * rms_over_mean, sigma))
    return FIGURES.table(
        ("background_K", computed["background_K"]),
        ("bandwidth_Hz", bandwidth_Hz),
        *((name, computed[name]) for name in ("g_number", "d_star", "nep_W", "ner")),
        ("amplifier_noise", sigma, "W/m²/sr", "rms noise of the amplifier"),
        ("netd_detector_K", netd_detector),
        ("netd_amplifier_K", netd_amplifier),
        ("netd_system_K", netd_system),
        ("snr", seen.mean / noise),
    )


def _band_d_star(
    band_um: tuple[float, float], material: tuple[str, str], lens: Lens, background_K: float
) -> float:
    (low, high), (region, name) = band_um, material
    if name == "manual":
        raise ParameterError("d_star", None, "give D*, because material is manual", unit="cm √Hz/W")
    d_star = band_d_star(
        material=find_material(region=region, material=name, cut_off_um=high),
        cut_on_um=low,
        cut_off_um=high,
        background_K=background_K,
        half_angle_deg=cold_shield_half_angle_deg(f_number=lens.f_number),
    )
    if d_star <= 0:
        allowed = (
            f"the material does not respond between {low:g} and "
            f"{high:g} µm; choose another material, or set another band"
        )
        raise ParameterError("material", name, allowed)
    return float(d_star)


@pointwise
def in_double(work: Work, pattern: Array) -> Array:
    """A pattern of one line or one sample, whose digits cost nothing."""
    return pattern.astype(np.float64)


@in_blocks()
def value_range(
    work: Work, picture: Array, *, low: float | None, high: float | None
) -> tuple[float, float]:
    """Ends of the quantizer's range; those not given are the picture's own."""
    lowest = float(picture.min()) if low is None else low
    highest = float(picture.max()) if high is None else high
    if lowest > highest:
        name, value = ("range_low", low) if high is None else ("range_high", high)
        allowed = (
            f"give a level within the picture's range, {picture.min():.6g} to {picture.max():.6g}, "
            "or give both range_low and range_high"
        )
        raise ParameterError(name, value, allowed, unit="W/m²/sr")
    return lowest, highest


@in_blocks()
def with_quantization(work: Work, table: TableData, final: Array, before: Array) -> TableData:
    rms = 0.0 if final is before else quantization_rms(original=before, quantized=final)
    return TableData(table.rows + FIGURES.table(("quantization_rms", rms)).rows)


@dataclass(frozen=True)
class ScaledByChance(Linear):
    """The gain error as printed in eq. 4.59: it scales the whole picture."""

    seen: Recipe
    gain_percent: float

    @property
    def by_chance(self) -> str:
        return (
            "gain_model = literal scales the picture by the gain error; use per_pixel or published"
        )

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.scaled(self.gain_percent / 100.0 * work.value(self.seen).mean)


def _read_out_noises(
    at: AtStep,
    picture: Recipe,
    seen: Recipe,
    gain_pattern: Recipe,
    bias_pattern: Recipe,
    figures: Recipe,
    *_: Recipe,
    gain_percent: float,
    bias_percent: float,
    model: str,
    variability_percent: float,
) -> list[Noise]:
    """Errors of gain and bias, constant along the direction of collection, and detector noise."""
    mean = at.work.value(seen).mean
    gain, bias = gain_percent / 100.0, bias_percent / 100.0
    noises = []
    if gain and model != "literal":
        seen_by_each = model == "per_pixel" and not at.uniform
        weight = at.work.value(picture) if seen_by_each else None
        power = _pattern_power(at, gain_pattern, gain, mean, weight)
        noises.append(at.coloured("gain", power, temporal=False))
    if bias and model != "literal":
        power = _pattern_power(at, bias_pattern, bias, mean, None)
        noises.append(at.coloured("bias", power, temporal=False))
    return [*noises, *_detector(at, picture, figures, variability_percent=variability_percent)]


def _pattern_power(
    at: AtStep, pattern: Recipe, spread: float, mean: float, weight: Array | None
) -> NoisePower:
    """Power of unit deviates times the spread, times what each sample weighs or the mean."""
    rows, columns = at.rows, at.columns
    shape = _shape_of(pattern)
    seen = np.full((1, 1), mean) if weight is None else np.asarray(weight, np.float64)
    if shape == (rows, columns):
        variances = spread**2 * np.broadcast_to(seen**2, (rows, columns))
        return NoisePower.white(rows, columns, variances)
    whole = np.broadcast_to(seen, (rows, columns))
    if shape == (1, columns):
        # Each column is multiplied by a deviate of its own: along it stays what it has seen.
        waves = kernels.dct(whole, type=2, axis=0, norm="ortho")
        return NoisePower(rows, columns, spread**2 * np.mean(waves**2, axis=1, keepdims=True))
    waves = kernels.dctn(whole, type=2, norm="ortho")
    return NoisePower(rows, columns, spread**2 * waves**2)


def _shape_of(pattern: Recipe) -> tuple[int, int]:
    assert isinstance(pattern, Step)
    if pattern.inputs:  # in double
        return _shape_of(*pattern.inputs)
    shape: tuple[int, int] = dict(pattern.parameters)["shape"]
    return shape


def _without_gain(picture: Recipe, *_: Recipe, model: str, **how: Any) -> Recipe:
    if model == "literal":
        raise DataError(
            "gain_model = literal multiplies the picture by the gain error, so without a gain "
            "error nothing remains; use per_pixel or published"
        )
    return picture


@picture_step(
    linear=lambda _, seen, *__, model, gain_percent, **___: (
        ScaledByChance(seen, gain_percent) if model == "literal" else Linear()
    ),
    noise=_read_out_noises,
    looks_at=("picture", "seen", "figures"),
    noise_free=_without_gain,
)
@pointwise
def read_out(
    work: Work,
    picture: Array,
    seen: PictureRange,
    gain_pattern: Array,
    bias_pattern: Array,
    figures: DetectorFigures,
    *deviates: Array,
    variability_percent: float,
    **errors: Any,
) -> Array:
    how = {**errors, "mean_radiance": seen.mean}
    read = apply_gain_bias(picture, gain_pattern=gain_pattern, bias_pattern=bias_pattern, **how)
    read += detector_noise(work, figures, *deviates, variability_percent=variability_percent)
    return read


@in_blocks()
def _detector(
    at: AtStep, _picture: Recipe, figures: Recipe, *_: Recipe, variability_percent: float
) -> list[Noise]:
    spread = variability_percent / 100.0
    return [at.white("detector", at.work.value(figures)["ner"] ** 2 * (1.0 + spread**2))]


@picture_step(noise=_detector, looks_at=("figures",))
@pointwise
def with_detector_noise(
    work: Work, picture: Array, figures: DetectorFigures, *deviates: Array, **spread: Any
) -> Array:
    noise = detector_noise(work, figures, *deviates, **spread)
    return np.asarray(picture + noise)


@ends_lineage
@pointwise
def detector_noise(
    work: Work,
    figures: DetectorFigures,
    deviates: Array,
    pattern: Array | None = None,
    *,
    variability_percent: float,
) -> Array:
    sigma: Any = figures["ner"]
    if pattern is not None:
        # A spread wide enough to turn a deviation negative is still a spread: take its size.
        sigma = np.abs(sigma * (1.0 + variability_percent / 100.0 * pattern))
    return np.asarray(deviates * np.asarray(sigma, deviates.dtype))


@in_blocks()
def _amplifier(at: AtStep, picture: Recipe, table: Recipe, deviates: Recipe) -> list[Noise]:
    sigma = at.work.value(table).as_dict()["amplifier_noise"]
    return [at.white("amplifier", sigma**2)]


@picture_step(noise=_amplifier, looks_at=("table",))
@pointwise
def with_amplifier_noise(work: Work, picture: Array, table: TableData, deviates: Array) -> Array:
    sigma: Any = table.as_dict()["amplifier_noise"]
    return np.asarray(picture + deviates * deviates.dtype.type(sigma))
