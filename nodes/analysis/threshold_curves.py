"""MRTD and MDTD of the sensor that a picture has gone through, from its transfer and its noise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.step_lineage import LevelChange
from core.chain.wires import CurveData, Series
from core.errors import DataError
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.physics.acquisition.mrtd import (
    Window,
    mdtd_K,
    mrtd_flir92_K,
    mrtd_ratches_K,
    mrtd_two_dimensional,
)
from core.physics.noise.noise_components import COMPONENTS, NoiseVariances
from core.physics.radiometry.planck import band_radiance_derivative, brightness_temperature
from core.transfer.factors import Grid
from nodes.analysis.lineage import (
    HORIZONTAL,
    VERTICAL,
    ImageNoise,
    Line,
    Stage,
    all_along,
    stage_along,
)

Vector = NDArray[np.float64]
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


@dataclass(frozen=True)
class Observer:
    """How bars and targets are looked at.

    The sensor does not sample along a scan. `frames` are averaged by the eye, over a target's
    `window` or up to `eye_limit_mrad`.
    """

    model: Model
    sampled_x: bool
    sampled_y: bool
    snr_threshold: float
    frames: float
    window: Window
    eye_limit_mrad: float | None


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


@ends_lineage
def sensitivity(
    work: Work,
    seen: ImageNoise,
    *levels: LevelChange,
    band_um: tuple[float, float],
    background_K: float | None,
    gain: float | None = 1.0,
    gain_before: float = 1.0,
) -> Sensitivity | Unseen:
    """Noise over the slope dL/dT at the background, by default that of the picture's mean.

    `gain` is what a uniform scene is multiplied by on its way to the picture. Where the picture is
    no longer in proportion to the scene, `levels` are the changes that made it so, `gain_before`
    what the scene was multiplied by before the first.
    """
    band = {"cut_on_um": band_um[0], "cut_off_um": band_um[1]}
    if seen.unknown:
        raise DataError(
            f"the noise before {', '.join(seen.unknown)} cannot be computed for this picture: "
            "connect the picture as the sensor samples it"
        )
    if gain is None:
        raise DataError(
            "gain_model = literal scales the picture by the gain error, so its noise is not a "
            "temperature difference: use gain_model = per_pixel or published"
        )
    gain *= math.prod(level.gain for level in levels)
    clipped = unseen(gain, levels, "there is nothing to detect")
    if clipped is not None:
        return clipped
    scene = levels[0].mean / gain_before if levels else seen.mean / gain
    # What is in proportion to the scene, as a radiance at the slope of the response.
    mean = levels[0].signal / levels[0].gain / gain_before if levels else scene
    noise = NoiseVariances(*(seen.total.variance(n) / gain**2 for n in COMPONENTS))
    if background_K is None:
        if not scene > 0.0:
            raise DataError(
                f"the picture's mean {seen.mean:.6g} is not a possible background radiance: give "
                "background_K"
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


@ends_lineage
def thresholds(
    work: Work,
    noise_figures: Sensitivity | Unseen,
    *,
    stages: tuple[Stage, ...],
    grid: Grid,
    observer: Observer,
) -> Thresholds | Unseen:
    """MRTD up to the samples' own rate, or the first zero of the MTF, or Nyquist."""
    if isinstance(noise_figures, Unseen):
        return noise_figures
    nyquist_x, nyquist_y = grid.nyquist_x, grid.nyquist_y
    frequency = np.linspace(0.0, _HIGHEST * max(nyquist_x, nyquist_y), _SAMPLES + 1)[1:]
    mtf_x = _to_first_zero(work, stages, HORIZONTAL, frequency)
    mtf_y = _to_first_zero(work, stages, VERTICAL, frequency)
    spectrum = noise_figures.spectrum
    turned = None if spectrum is None else spectrum.T
    seen = {"snr_threshold": observer.snr_threshold, "frames": observer.frames}
    directions: tuple[Literal["horizontal", "vertical"], ...] = ("horizontal", "vertical")
    horizontal, vertical = (
        mrtd_ratches_K(
            frequency=frequency,
            mtf=mtf,
            netd_K=noise_figures.netd_K,
            noise_bandwidth_cyc_per_mrad=across,
            detector_along_mrad=0.5 / along,
            spectrum=of_noise,
            **seen,
        )
        if observer.model == "ratches_1976"
        else mrtd_flir92_K(
            frequency=frequency,
            mtf=mtf,
            noise=noise_figures.noise_K2,
            across_cyc_per_mrad=across,
            along_cyc_per_mrad=along,
            direction=direction,
            sampled=sampled,
            spectrum=of_noise,
            **seen,
        )
        for direction, mtf, across, along, sampled, of_noise in (
            (directions[0], mtf_x, nyquist_x, nyquist_y, observer.sampled_x, spectrum),
            (directions[1], mtf_y, nyquist_y, nyquist_x, observer.sampled_y, turned),
        )
    )
    both_frequency, both = mrtd_two_dimensional(
        frequency=frequency, horizontal_K=horizontal, vertical_K=vertical
    )
    return Thresholds(frequency, mtf_x, mtf_y, horizontal, vertical, both_frequency, both)


def _to_first_zero(work: Work, stages: tuple[Stage, ...], line: Line, frequency: Vector) -> Vector:
    """All stages, zero from the first zero of any factor on: two may share one between samples."""
    total, passed = np.ones(len(frequency)), np.ones(len(frequency), bool)
    for stage in stages:
        for factor in stage.factors:
            work.check()
            values = stage_along(work, replace(stage, factors=(factor,)), "mtf", line, frequency)
            passed &= np.logical_and.accumulate(values > 0.0)
            total = total * values
    return np.where(passed, total, 0.0)


@ends_lineage
def mrtd_curve(work: Work, mrtd: Thresholds | Unseen) -> CurveData:
    if isinstance(mrtd, Unseen):
        return mrtd.curve("MRTD", "frequency (cyc/mrad)", "MRTD (K)")
    series = (
        *_shown("horizontal", mrtd.frequency, mrtd.horizontal),
        *_shown("vertical", mrtd.frequency, mrtd.vertical),
        *_shown("2-D", mrtd.both_frequency, mrtd.both),
    )
    return CurveData("MRTD", "frequency (cyc/mrad)", "MRTD (K)", series, log_y=True)


def _shown(label: str, x: Vector, y: Vector) -> tuple[Series, ...]:
    there = np.isfinite(y) & (y > 0.0)
    return (Series(label, x[there], y[there]),) if there.any() else ()


@ends_lineage
def mdtd_curve(
    work: Work,
    noise_figures: Sensitivity | Unseen,
    *,
    stages: tuple[Stage, ...],
    grid: Grid,
    observer: Observer,
) -> CurveData:
    """MDTD of squares from a quarter of a sample to 25 samples wide."""
    if isinstance(noise_figures, Unseen):
        return noise_figures.curve("MDTD", "target size (mrad)", "MDTD (K)")
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
    noise = noise_figures.noise_K2
    if observer.model == "ratches_1976":
        noise = NoiseVariances(tvh=noise_figures.netd_K**2)
    mdtd = mdtd_K(
        size_mrad=size,
        frequency=frequency,
        mtf_x=all_along(work, stages, HORIZONTAL, frequency),
        mtf_y=all_along(work, stages, VERTICAL, frequency),
        noise=noise,
        snr_threshold=observer.snr_threshold,
        noise_bandwidth_x_cyc_per_mrad=grid.nyquist_x,
        noise_bandwidth_y_cyc_per_mrad=grid.nyquist_y,
        frames=observer.frames,
        window=observer.window,
        eye_limit_mrad=observer.eye_limit_mrad,
        spectrum=noise_figures.spectrum,
    )
    series = _shown("square target", size, mdtd)
    return CurveData("MDTD", "target size (mrad)", "MDTD (K)", series, log_y=True, log_x=True)


# What stands in place of figures where a picture is clipped and shows nothing of its scene.


@dataclass(frozen=True)
class Unseen:
    """Why there are no figures: the rest of the network is delivered all the same."""

    reason: str

    def curve(self, title: str, x_label: str, y_label: str) -> CurveData:
        return CurveData(title, x_label, y_label, ())


def unseen(gain: float, levels: Sequence[LevelChange], consequence: str) -> Unseen | None:
    """Why a picture does not follow the scene, and what cannot be had of it; None where it does.

    `gain` is that from the scene to the picture, of whose `levels` one may have the reason.
    """
    if gain > 0.0:
        return None
    reason = next((level.reason for level in levels if level.reason), "")
    if not reason:
        raise DataError(f"the picture does not change with the scene: {consequence}")
    return Unseen(f"{reason}: {consequence}")
