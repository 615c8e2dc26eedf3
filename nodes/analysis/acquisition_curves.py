"""Probability against range that a target is acquired, and the figures of merit as a table."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import CurveData, Series, TableData, TableRow
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.physics.acquisition.eye import (
    CYC_PER_DEG,
    eye_contrast_threshold,
    system_contrast_threshold,
)
from core.physics.acquisition.mrtd import perceived_share
from core.physics.acquisition.target_acquisition import (
    TtpThreshold,
    apparent_difference,
    johnson_probability,
    resolvable_cycles,
    thermal_contrast,
    ttp_probability,
)
from core.physics.atmosphere.air_path import AirPath, transmission_at_ranges
from core.physics.noise.noise_components import COMPONENTS
from core.physics.numerics import range_for_probability
from core.transfer.factors import Grid
from nodes.analysis.threshold_curves import Sensitivity, Thresholds, Unseen

Vector = NDArray[np.float64]
TtpForm = Literal["mrtd", "system_contrast_threshold"]
TASKS = ("detection", "recognition", "identification")
_POINTS = 201
_LEAST = 0.1  # of the easiest task, where the curve ends by itself
_MEANINGS = {
    "tvh": "random noise",
    "vh": "fixed pattern, pixel by pixel",
    "v": "fixed pattern, row by row",
    "h": "fixed pattern, column by column",
    "t": "frame-to-frame flicker",
    "tv": "row flicker",
    "th": "column flicker",
}


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
    ttp_threshold: TtpForm = "mrtd"
    seconds_per_frame: float = 0.0
    seconds_fixed: float = 0.0
    air: tuple[AirPath, ...] = ()
    band_um: tuple[float, float] = (8.0, 12.0)

    def apparent_K(self, range_m: Any, background_K: float) -> Any:  # noqa: N802
        """What is left of the target's difference at ranges, by the air of its own range."""
        if not self.air:
            return apparent_difference(
                delta_K=self.delta_K, extinction_per_km=self.extinction_per_km, range_m=range_m
            )
        return self.delta_K * transmission_at_ranges(
            paths=self.air,
            range_m=range_m,
            cut_on_um=self.band_um[0],
            cut_off_um=self.band_um[1],
            background_K=background_K,
        )


@dataclass(frozen=True)
class Acquisition:
    """Probabilities against range by task, and the ranges of one half in m."""

    range_m: Vector
    johnson: tuple[Vector, ...]
    ttp: Vector
    johnson_ranges: tuple[float | None, ...]
    ttp_range: float | None


@ends_lineage
def acquisition(
    work: Work,
    thresholds: Thresholds | Unseen,
    noise: Sensitivity | Unseen,
    *,
    task: Task,
    grid: Grid,
) -> Acquisition | Unseen:
    if isinstance(thresholds, Unseen):
        return thresholds
    assert not isinstance(noise, Unseen)

    def johnson(n50: float, range_m: Any) -> Any:
        if len(thresholds.both) < 2:
            return np.zeros_like(range_m)
        cycles = resolvable_cycles(
            frequency=thresholds.both_frequency,
            mrtd_K=thresholds.both,
            delta_K=task.apparent_K(range_m, noise.background_K),
            target_size_m=task.size_m,
            range_m=range_m,
        )
        return johnson_probability(cycles=cycles, n50=n50)

    spectrum = noise.spectrum
    turned = None if spectrum is None else spectrum.T
    limits = [
        TtpThreshold(thresholds.frequency, _contrast_threshold(task, noise, thresholds, *seen))
        for seen in (
            (thresholds.horizontal, thresholds.mtf_x, grid.nyquist_x, grid.nyquist_y, spectrum),
            (thresholds.vertical, thresholds.mtf_y, grid.nyquist_y, grid.nyquist_x, turned),
        )
    ]

    def ttp(range_m: Any) -> Any:
        apparent = np.abs(task.apparent_K(range_m, noise.background_K))
        contrast = thermal_contrast(difference_K=apparent, scene_contrast_K=task.scene_contrast_K)
        across, along = (limit.value(contrast, task.size_m**2, range_m) for limit in limits)
        return ttp_probability(value=np.sqrt(across) * np.sqrt(along), v50=task.v50)

    def johnson_reach(n50: float, probability: float) -> float | None:
        work.check()
        return range_for_probability(
            probability_at=lambda range_m: johnson(n50, range_m), probability=probability
        )

    half = tuple(johnson_reach(n50, 0.5) for n50 in task.n50)
    work.check()
    ttp_half = range_for_probability(probability_at=ttp, probability=0.5)
    if task.range_max_km is not None:
        farthest = 1000.0 * task.range_max_km
    else:
        reach = (johnson_reach(min(task.n50), _LEAST), ttp_half)
        farthest = max(
            (range_m for range_m in reach if range_m and math.isfinite(range_m)), default=1000.0
        )
    range_m = farthest * np.arange(1, _POINTS + 1) / _POINTS
    return Acquisition(
        range_m, tuple(johnson(n50, range_m) for n50 in task.n50), ttp(range_m), half, ttp_half
    )


def _contrast_threshold(
    task: Task,
    noise: Sensitivity,
    thresholds: Thresholds,
    mrtd: Vector,
    mtf: Vector,
    across: float,
    along: float,
    spectrum: Vector | None,
) -> Vector:
    """The published one, of the eye through MTF and noise; or by the MRTD; as far as is sampled.

    By the MRTD it is the root of the squares of the eye's threshold through the sensor, and of its
    noise.
    """
    frequency, resolved = thresholds.frequency, np.isfinite(mrtd)
    seen = np.where(resolved, mtf, 1.0)
    display = {"luminance_cd_m2": task.luminance_cd_m2, "display_deg": task.display_deg}
    if task.ttp_threshold == "mrtd":
        per_deg = frequency * (CYC_PER_DEG / task.magnification)
        eye = eye_contrast_threshold(frequency_cyc_per_deg=per_deg, **display)
        hidden = thermal_contrast(difference_K=mrtd, scene_contrast_K=task.scene_contrast_K)
        return np.where(resolved, np.hypot(eye / seen, hidden), np.inf)
    threshold = system_contrast_threshold(
        frequency=frequency,
        mtf=seen,
        magnification=task.magnification,
        relative_noise=_relative_noise(task, noise, frequency, across, along, spectrum),
        **display,
    )
    return np.where(resolved, threshold, np.inf)


def _relative_noise(
    task: Task,
    noise: Sensitivity,
    frequency: Vector,
    across: float,
    along: float,
    spectrum: Vector | None,
) -> Vector:
    def share(of: Vector | None) -> Vector:
        return perceived_share(
            frequency=frequency,
            across_cyc_per_mrad=across,
            along_cyc_per_mrad=along,
            magnification=task.magnification,
            luminance_cd_m2=task.luminance_cd_m2,
            spectrum=of,
        )

    variances = noise.noise_K2
    temporal = variances.temporal * task.seconds_per_frame * share(spectrum)
    fixed = variances.fixed * task.seconds_fixed
    total = temporal + fixed * share(None) if fixed else temporal
    return np.asarray(np.sqrt(total) / task.scene_contrast_K, np.float64)


@ends_lineage
def probability_curve(work: Work, result: Acquisition | Unseen) -> CurveData:
    if isinstance(result, Unseen):
        return result.curve("Target acquisition", "range (km)", "probability")
    km = result.range_m / 1000.0
    series = [
        Series(task, km, probability)
        for task, probability in zip(TASKS, result.johnson, strict=True)
    ]
    series.append(Series("TTP", km, result.ttp))
    return CurveData("Target acquisition", "range (km)", "probability", tuple(series))


@ends_lineage
def merit_table(
    work: Work,
    seen: Sensitivity | Unseen,
    thresholds: Thresholds | Unseen,
    reached: Acquisition | Unseen,
    *,
    grid: Grid,
    unit: str,
    frames: float,
) -> TableData:
    values: dict[str, float | None] = {}
    why = seen.reason if isinstance(seen, Unseen) else ""
    if not isinstance(seen, Unseen):
        ner = math.sqrt(max(seen.noise.temporal, 0.0))
        values |= {"snr": seen.mean / ner if ner > 0.0 else None, "netd_K": seen.netd_K}
        values |= {"ner": ner, "background_K": seen.background_K}
        for name in COMPONENTS:
            values[f"sigma_{name}_K"] = math.sqrt(seen.noise_K2.variance(name))
    if not isinstance(reached, Unseen):
        for task, range_m in zip(TASKS, reached.johnson_ranges, strict=True):
            values[f"{task}_range_km"] = _km(range_m)
        values["ttp_range_km"] = _km(reached.ttp_range)

    def row(name: str, unit: str, meaning: str) -> TableRow:
        return TableRow(name, values.get(name), unit, meaning, why)

    rows = [
        row("snr", "", "mean signal divided by temporal noise"),
        row("netd_K", "K", "temporal noise as a temperature difference"),
        row("ner", unit, "rms temporal noise"),
        row("background_K", "K", "background temperature for dL/dT"),
        TableRow("frames_integrated", frames, "", "frames averaged by the eye"),
        *(row(f"sigma_{name}_K", "K", _MEANINGS[name]) for name in COMPONENTS),
    ]
    for share in (0.25, 0.5, 0.75):
        text = f"{share:g} of Nyquist"
        for axis, nyquist in (("x", grid.nyquist_x), ("y", grid.nyquist_y)):
            name = f"mrtd_{axis}_{round(100 * share)}_percent_nyquist"
            if not isinstance(thresholds, Unseen):
                curve = thresholds.horizontal if axis == "x" else thresholds.vertical
                values[name] = at_frequency(thresholds.frequency, curve, share * nyquist)
            rows.append(row(name, "K", f"MRTD along {axis} at {text}"))
    rows += [
        row(f"{t}_range_km", "km", f"range at which the {t} probability is one half (Johnson)")
        for t in TASKS
    ]
    rows.append(
        row("ttp_range_km", "km", "range at which the probability of success is one half (TTP)")
    )
    return TableData(tuple(rows))


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
