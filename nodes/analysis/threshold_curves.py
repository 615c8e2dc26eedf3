"""MRTD, MDTD and acquisition ranges of the sensor that a picture has gone through."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from core.arrays import Vector
from core.chain.step_lineage import LevelChange
from core.chain.wires import CurveData, Series, TableData
from core.errors import DataError
from core.evaluation.work import Work
from core.physics.acquisition import mrtd as physics
from core.physics.acquisition import target_acquisition
from core.physics.atmosphere.air_path import AirPath, transmission_at_ranges
from core.physics.noise.noise_components import COMPONENTS, MEANINGS, NoiseVariances
from core.physics.numerics import range_for_probability
from core.physics.radiometry.planck import band_radiance_derivative, brightness_temperature
from core.records import dataclass, field, replace
from core.transfer.factors import Grid
from nodes.analysis import lineage
from nodes.shared.module_ports import TableFigures

Unseen = str
"""Why there are no figures, in their place: the picture is clipped and shows nothing of its scene.
The rest of the network is delivered all the same."""
Model = Literal["ratches_1976", "flir92"]
_HIGHEST = 2.0  # times Nyquist: the samples' own rate, beyond which a picture shows no bars
_SAMPLES = 512
_SIZES = 97
_SMALLEST, _LARGEST = 0.25, 25.0  # side of a target in samples
_MOST = 1e200  # K², above which noise is no number to reckon with
_FINEST = 32.0  # times Nyquist: up to where the spectrum of the smallest target is summed
_LEFT_OUT = 1e-3  # share of any target that a sum which ends before may leave out


@dataclass(frozen=True)
class Sensitivity:
    """Noise of a sensor as temperature differences; spectrum of the temporal noise, if any."""

    mean: float
    background_K: float
    slope: float
    noise: NoiseVariances
    spectrum: Vector | None = field(default=None, compare=False)

    @property
    def noise_K2(self) -> NoiseVariances:  # noqa: N802
        """Variances in K²; one estimated below zero is none."""
        return NoiseVariances(
            *(max(self.noise.variance(name), 0.0) / self.slope / self.slope for name in COMPONENTS)
        )

    @property
    def netd_K(self) -> float:  # noqa: N802
        return float(np.sqrt(max(self.noise_K2.temporal, 0.0)))


Sensed = Sensitivity | Unseen


@dataclass(frozen=True)
class Thresholds:
    """MRTD against frequency, infinite where nothing is resolved; MTF there."""

    frequency: Vector
    mtf_x: Vector
    mtf_y: Vector
    horizontal: Vector
    vertical: Vector
    both_frequency: Vector
    both: Vector


def sensitivity(
    work: Work,
    seen: lineage.ImageNoise,
    *levels: LevelChange,
    band_um: tuple[float, float],
    background_K: float | None,
    gain: float | None = 1.0,
    gain_before: float = 1.0,
) -> Sensed:
    """Noise over the slope dL/dT at the background, by default that of the picture's mean.

    `gain` is what a uniform scene is multiplied by on its way to the picture. Where the picture is
    no longer in proportion to the scene, `levels` are the changes that made it so, `gain_before`
    what the scene was multiplied by before the first.
    """
    band = {"cut_on_um": band_um[0], "cut_off_um": band_um[1]}
    seen.require_known()
    if gain is None:
        raise DataError(
            "the noise cannot be expressed as a temperature difference: gain_model = literal on "
            "Electronics & Noise scales the picture by the gain error. Use gain_model = per_pixel "
            "or published"
        )
    gain *= math.prod(level.gain for level in levels)
    if clipped := unseen(gain, levels, "there is nothing to detect"):
        return clipped
    scene = levels[0].mean / gain_before if levels else seen.mean / gain
    # What is in proportion to the scene, as a radiance at the slope of the response.
    mean = levels[0].signal / levels[0].gain / gain_before if levels else scene
    noise = NoiseVariances(*(seen.total.variance(n) / gain**2 for n in COMPONENTS))
    if background_K is None:
        if not scene > 0.0:
            raise DataError(
                f"the background temperature is unknown: the picture's mean, {seen.mean:.6g}, "
                "gives a background radiance that is not above 0. Give background_K"
            )
        background_K = float(brightness_temperature(radiance=scene, **band))
    slope = float(band_radiance_derivative(temperature_K=background_K, **band))
    if not slope > 0.0:
        raise DataError(
            f"a background of {background_K:.6g} K emits nothing in this band: "
            "give a higher background_K"
        )
    noise_figures = Sensitivity(mean, background_K, slope, noise, seen.spectrum)
    if not noise_figures.noise_K2.total < _MOST:
        raise DataError(
            f"a background of {background_K:.6g} K emits almost nothing in this band, so the noise "
            "cannot be expressed as a temperature difference: give a higher background_K"
        )
    return noise_figures


def thresholds(
    work: Work,
    sensed: Sensed,
    *,
    stages: lineage.Stages,
    grid: Grid,
    model: Model,
    sampled: tuple[bool, bool],
    **seen: float,
) -> Thresholds | Unseen:
    """MRTD up to the samples' own rate, the first zero of the MTF, or Nyquist where `sampled`."""
    if isinstance(sensed, Unseen):
        return sensed
    nyquist_x, nyquist_y = grid.nyquist_x, grid.nyquist_y
    even = np.linspace(0.0, _HIGHEST * max(nyquist_x, nyquist_y), _SAMPLES + 1)[1:]
    frequency = np.union1d(even, (nyquist_x, nyquist_y))  # where sampled curves end
    mtf_x = _to_first_zero(work, stages, lineage.HORIZONTAL, frequency)
    mtf_y = _to_first_zero(work, stages, lineage.VERTICAL, frequency)
    spectrum = sensed.spectrum
    turned = None if spectrum is None else spectrum.T

    def mrtd(
        direction: Literal["horizontal", "vertical"],
        is_sampled: bool,
        across: float,
        along: float,
        **how: Any,
    ) -> Vector:
        how |= seen
        if model == "ratches_1976":
            how |= {"noise_bandwidth_cyc_per_mrad": across, "detector_along_mrad": 0.5 / along}
            return physics.mrtd_ratches_K(frequency=frequency, netd_K=sensed.netd_K, **how)
        how |= {"across_cyc_per_mrad": across, "along_cyc_per_mrad": along, "sampled": is_sampled}
        how |= {"direction": direction, "noise": sensed.noise_K2}
        return physics.mrtd_flir92_K(frequency=frequency, **how)

    nyquist = nyquist_x, nyquist_y
    horizontal = mrtd("horizontal", sampled[0], *nyquist, mtf=mtf_x, spectrum=spectrum)
    vertical = mrtd("vertical", sampled[1], *nyquist[::-1], mtf=mtf_y, spectrum=turned)
    both_frequency, both = physics.mrtd_two_dimensional(
        frequency=frequency, horizontal_K=horizontal, vertical_K=vertical
    )
    return Thresholds(frequency, mtf_x, mtf_y, horizontal, vertical, both_frequency, both)


def _to_first_zero(
    work: Work, stages: lineage.Stages, line: lineage.Line, frequency: Vector
) -> Vector:
    """All stages, zero from the first zero of any factor on: two may share one between samples."""
    total, passed = np.ones(len(frequency)), np.ones(len(frequency), bool)
    for stage in stages:
        for factor in stage.factors:
            work.check()
            values = lineage.stage_along(
                work, replace(stage, factors=(factor,)), "mtf", line, frequency
            )
            passed &= np.logical_and.accumulate(values > 0.0)
            total = total * values
    return np.where(passed, total, 0.0)


def mrtd_curve(work: Work, mrtd: Thresholds | Unseen) -> CurveData:
    if isinstance(mrtd, Unseen):
        return CurveData("MRTD", "frequency (cyc/mrad)", "MRTD (K)", ())
    series = (
        *_shown("horizontal", mrtd.frequency, mrtd.horizontal),
        *_shown("vertical", mrtd.frequency, mrtd.vertical),
        *_shown("2-D", mrtd.both_frequency, mrtd.both),
    )
    return CurveData("MRTD", "frequency (cyc/mrad)", "MRTD (K)", series, log_y=True)


def _shown(label: str, x: Vector, y: Vector) -> tuple[Series, ...]:
    there = np.isfinite(y) & (y > 0.0)
    return (Series(label, x[there], y[there]),) if there.any() else ()


def mdtd_curve(
    work: Work, sensed: Sensed, *, stages: lineage.Stages, grid: Grid, model: Model, **seen: Any
) -> CurveData:
    """MDTD of squares from a quarter of a sample to 25 samples wide."""
    if isinstance(sensed, Unseen):
        return CurveData("MDTD", "target size (mrad)", "MDTD (K)", ())
    widest = max(grid.interval_x_mrad, grid.interval_y_mrad)
    size = np.geomspace(_SMALLEST, _LARGEST, _SIZES) * widest
    # The sums repeat after the inverse of the step: twice the largest target, and its blur.
    step = 0.25 / float(size[-1])
    # Samples of very different sides would need sums of any length. Beyond ξ lies at most
    # 2W ∫ dξ/(πWξ)² = 2/(π²Wξ) of a target, where the transfer function does not exceed 1.
    enough = 2.0 / (np.pi**2 * float(size[0]) * _LEFT_OUT)
    highest = min(_FINEST * max(grid.nyquist_x, grid.nyquist_y), enough)
    count = int(np.ceil(highest / step))
    frequency = step * np.arange(count + 1, dtype=np.float64)
    noise = sensed.noise_K2
    if model == "ratches_1976":
        noise = NoiseVariances(tvh=sensed.netd_K**2)
    mdtd = physics.mdtd_K(
        size_mrad=size,
        frequency=frequency,
        mtf_x=lineage.all_along(work, stages, lineage.HORIZONTAL, frequency),
        mtf_y=lineage.all_along(work, stages, lineage.VERTICAL, frequency),
        noise=noise,
        noise_bandwidth_x_cyc_per_mrad=grid.nyquist_x,
        noise_bandwidth_y_cyc_per_mrad=grid.nyquist_y,
        spectrum=sensed.spectrum,
        **seen,
    )
    series = _shown("square target", size, mdtd)
    return CurveData("MDTD", "target size (mrad)", "MDTD (K)", series, log_y=True, log_x=True)


def unseen(gain: float, levels: Sequence[LevelChange], consequence: str) -> Unseen:
    """Why a picture of this gain does not follow the scene, with the consequence; else empty."""
    if gain > 0.0:
        return ""
    reason = next((level.reason for level in levels if level.reason), "")
    if not reason:
        raise DataError(f"the picture does not change with the scene: {consequence}")
    return f"{reason}: {consequence}"


Nyquists = tuple[float, float]  # across and along
TtpForm = Literal["mrtd", "system_contrast_threshold"]
TASKS = ("detection", "recognition", "identification")
_POINTS = 201
_LEAST = 0.1  # of the easiest task, where the curve ends by itself


@dataclass(frozen=True)
class Task:
    """What is to be acquired, through which air, how hard it is, and on what display.

    `extinction_per_km` holds where the picture has come through no `air`; `n50` are the cycles of
    detection, recognition and identification; `scene_contrast_K` is shown as the display's mean
    luminance; without `range_max_km` the curve ends where the easiest task has become unlikely.
    Over `seconds_per_frame` the eye sees temporal noise as one picture, over `seconds_fixed` fixed
    patterns (0: they do not count).
    """

    size_m: float
    delta_K: float
    extinction_per_km: float
    n50: tuple[float, float, float]
    v50: float
    scene_contrast_K: float
    luminance_cd_m2: float
    display_deg: float
    magnification: float
    range_max_km: float | None
    ttp_threshold: TtpForm
    seconds_per_frame: float
    seconds_fixed: float
    air: tuple[AirPath, ...]
    band_um: tuple[float, float]

    def apparent_K(self, range_m: Any, background_K: float) -> Any:  # noqa: N802
        """What is left of the target's difference at ranges, by the air of its own range."""
        if not self.air:
            return target_acquisition.apparent_difference(
                delta_K=self.delta_K, extinction_per_km=self.extinction_per_km, range_m=range_m
            )
        return self.delta_K * transmission_at_ranges(
            paths=self.air,
            range_m=range_m,
            cut_on_um=self.band_um[0],
            cut_off_um=self.band_um[1],
            background_K=background_K,
        )


Acquired = tuple[Vector, dict[str, Vector], dict[str, float | None]]
"""Ranges in m, the probability at these by task, and by task the range of one half."""


def acquisition(
    work: Work, thresholds: Thresholds | Unseen, noise: Sensed, *, task: Task, grid: Grid
) -> Acquired | Unseen:
    if isinstance(thresholds, Unseen):
        return thresholds
    assert not isinstance(noise, Unseen)

    def johnson(n50: float, range_m: Any) -> Any:
        if len(thresholds.both) < 2:
            return np.zeros_like(range_m)
        cycles = target_acquisition.resolvable_cycles(
            frequency=thresholds.both_frequency,
            mrtd_K=thresholds.both,
            delta_K=task.apparent_K(range_m, noise.background_K),
            target_size_m=task.size_m,
            range_m=range_m,
        )
        return target_acquisition.johnson_probability(cycles=cycles, n50=n50)

    frequency, spectrum, nyquist = (
        thresholds.frequency,
        noise.spectrum,
        (grid.nyquist_x, grid.nyquist_y),
    )
    turned = None if spectrum is None else spectrum.T
    limits = [
        target_acquisition.ttp_values(
            frequency=frequency, ctf=_contrast_threshold(task, noise, frequency, *seen)
        )
        for seen in (
            (thresholds.horizontal, thresholds.mtf_x, nyquist, spectrum),
            (thresholds.vertical, thresholds.mtf_y, nyquist[::-1], turned),
        )
    ]

    def ttp(range_m: Any) -> Any:
        apparent = np.abs(task.apparent_K(range_m, noise.background_K))
        contrast = target_acquisition.thermal_contrast(
            difference_K=apparent, scene_contrast_K=task.scene_contrast_K
        )
        across, along = (limit(contrast, task.size_m**2, range_m) for limit in limits)
        return target_acquisition.ttp_probability(
            value=np.sqrt(across) * np.sqrt(along), v50=task.v50
        )

    def johnson_reach(n50: float, probability: float) -> float | None:
        work.check()
        return range_for_probability(
            probability_at=lambda range_m: johnson(n50, range_m), probability=probability
        )

    by_task = dict(zip(TASKS, task.n50, strict=True))
    half = {name: johnson_reach(n50, 0.5) for name, n50 in by_task.items()}
    work.check()
    half["TTP"] = range_for_probability(probability_at=ttp, probability=0.5)
    if task.range_max_km is not None:
        farthest = 1000.0 * task.range_max_km
    else:
        reach = (johnson_reach(min(task.n50), _LEAST), half["TTP"])
        farthest = max(
            (range_m for range_m in reach if range_m and math.isfinite(range_m)), default=1000.0
        )
    range_m = farthest * np.arange(1, _POINTS + 1) / _POINTS
    curves = {name: johnson(n50, range_m) for name, n50 in by_task.items()}
    return range_m, {**curves, "TTP": ttp(range_m)}, half


def _contrast_threshold(
    task: Task, noise: Sensitivity, frequency: Vector, mrtd: Vector, mtf: Vector, *of_noise: Any
) -> Vector:
    """The published one; or of the eye through the sensor and the MRTD, as the root of squares."""
    resolved = np.isfinite(mrtd)
    seen = np.where(resolved, mtf, 1.0)
    display = {"luminance_cd_m2": task.luminance_cd_m2, "display_deg": task.display_deg}
    if task.ttp_threshold == "mrtd":
        per_deg = frequency * (target_acquisition.CYC_PER_DEG / task.magnification)
        eye = target_acquisition.eye_contrast_threshold(frequency_cyc_per_deg=per_deg, **display)
        hidden = target_acquisition.thermal_contrast(
            difference_K=mrtd, scene_contrast_K=task.scene_contrast_K
        )
        return np.where(resolved, np.hypot(eye / seen, hidden), np.inf)
    threshold = target_acquisition.system_contrast_threshold(
        frequency=frequency,
        mtf=seen,
        magnification=task.magnification,
        relative_noise=_relative_noise(task, noise, frequency, *of_noise),
        **display,
    )
    return np.where(resolved, threshold, np.inf)


def _relative_noise(
    task: Task, noise: Sensitivity, frequency: Vector, nyquist: Nyquists, spectrum: Vector | None
) -> Vector:
    def share(of: Vector | None) -> Vector:
        return physics.perceived_share(
            frequency=frequency,
            across_cyc_per_mrad=nyquist[0],
            along_cyc_per_mrad=nyquist[1],
            magnification=task.magnification,
            luminance_cd_m2=task.luminance_cd_m2,
            spectrum=of,
        )

    variances = noise.noise_K2
    temporal = variances.temporal * task.seconds_per_frame * share(spectrum)
    fixed = variances.fixed * task.seconds_fixed
    total = temporal + fixed * share(None) if fixed else temporal
    return np.asarray(np.sqrt(total) / task.scene_contrast_K, np.float64)


def probability_curve(work: Work, result: Acquired | Unseen) -> CurveData:
    if isinstance(result, Unseen):
        return CurveData("Target acquisition", "range (km)", "probability", ())
    range_m, curves, _ = result
    series = tuple(Series(name, range_m / 1000.0, curve) for name, curve in curves.items())
    return CurveData("Target acquisition", "range (km)", "probability", series)


FIGURES = TableFigures(
    ("snr", "", "Noise-free mean signal divided by temporal noise; left out if there is no "
     "noise."),
    ("netd_K", "K", "Noise-equivalent temperature difference of the temporal noise."),
    ("ner", "W/m²/sr", "Noise-equivalent radiance: rms temporal noise."),
    ("mrtd_x_K", "K", "MRTD for vertical bars at half the Nyquist frequency; left out if the "
     "bars are not resolved.", "mrtd_x_50_percent_nyquist"),
    ("mrtd_y_K", "K", "MRTD for horizontal bars at half the Nyquist frequency; left out if "
     "the bars are not resolved.", "mrtd_y_50_percent_nyquist"),
    ("detection_range_km", "km", "Range at which the probability of detection is one half "
     "(Johnson)."),
    ("recognition_range_km", "km", "Range at which the probability of recognition is one "
     "half (Johnson)."),
    ("identification_range_km", "km", "Range at which the probability of identification is one "
     "half (Johnson)."),
    ("ttp_range_km", "km", "Range at which the probability of success is one half (TTP)."),
)  # fmt: skip


def merit_table(
    work: Work,
    seen: Sensed,
    thresholds: Thresholds | Unseen,
    reached: Acquired | Unseen,
    *,
    grid: Grid,
    unit: str,
    frames: float,
) -> TableData:
    values: dict[str, float | None] = {}
    why = seen if isinstance(seen, Unseen) else ""
    if not isinstance(seen, Unseen):
        ner = math.sqrt(max(seen.noise.temporal, 0.0))
        values |= {"snr": seen.mean / ner if ner > 0.0 else None, "netd_K": seen.netd_K}
        values |= {"ner": ner, "background_K": seen.background_K}
        for name in COMPONENTS:
            values[f"sigma_{name}_K"] = math.sqrt(seen.noise_K2.variance(name))
    if not isinstance(reached, Unseen):
        values |= {f"{task.lower()}_range_km": _km(half) for task, half in reached[2].items()}

    def row(name: str, *unit_and_meaning: str) -> tuple[Any, ...]:
        return name, values.get(name), *unit_and_meaning, why

    rows = [
        row("snr"),
        row("netd_K"),
        row("ner", unit, "rms temporal noise"),
        row("background_K", "K", "background temperature, at which dL/dT is taken"),
        ("frames_integrated", frames, "", "frames averaged by the eye"),
        *(row(f"sigma_{name}_K", "K", MEANINGS[name]) for name in COMPONENTS),
    ]
    for share in (0.25, 0.5, 0.75):
        text = f"{share:g} of Nyquist"
        for axis, nyquist in (("x", grid.nyquist_x), ("y", grid.nyquist_y)):
            name = f"mrtd_{axis}_{round(100 * share)}_percent_nyquist"
            if not isinstance(thresholds, Unseen):
                curve = thresholds.horizontal if axis == "x" else thresholds.vertical
                values[name] = at_frequency(thresholds.frequency, curve, share * nyquist)
            rows.append(row(name, "K", f"MRTD along {axis} at {text}"))
    rows += [row(f"{task}_range_km") for task in (*TASKS, "ttp")]
    return FIGURES.table(*rows)


def _km(range_m: float | None) -> float | None:
    return range_m / 1000.0 if range_m is not None and math.isfinite(range_m) else None


def at_frequency(frequency: Vector, curve: Vector, wanted: float) -> float | None:
    """The curve at a frequency, straight between logarithms; None where nothing is resolved."""
    upper = int(np.searchsorted(frequency, wanted * (1.0 - 1e-12)))
    lower = max(upper - 1, 0)
    if upper >= len(curve) or not np.isfinite(curve[upper]):
        return None
    if frequency[upper] == wanted or not curve[lower] > 0.0:
        return float(curve[upper])
    logs = np.interp(wanted, frequency[lower : upper + 1], np.log(curve[lower : upper + 1]))
    return float(np.exp(logs))
