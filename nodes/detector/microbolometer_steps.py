"""The stages of Microbolometer as steps: lag along a scan and over frames, patterns, noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.linear_change import Filtering, Linear
from core.chain.noise_power import NoisePower
from core.chain.results import TableData, TableRow
from core.chain.step_lineage import AtStep, Noise, picture_step
from core.evaluation.recipes import Recipe, ends_lineage, in_blocks, in_parts, pointwise
from core.evaluation.region import Region
from core.evaluation.work import Work
from core.physics.radiometry.planck import band_radiance_derivative, brightness_temperature
from core.transfer.factors import Edges, Grid, Separable
from core.transfer.line_filter import filter_lines

Array = NDArray[Any]
_LABEL = "Thermal lag"


def _lag_filter(
    picture: Recipe, *, factors: tuple[Separable, ...], grid: Grid, edges: Edges
) -> Filtering:
    return Filtering(factors, grid, edges, label=_LABEL)


def _scanned_part(work: Work, region: Region, picture: Recipe, *, grid: Grid, **how: Any) -> Array:
    wanted = Region(region.top, 0, region.rows, grid.columns)
    lines = filter_lines(work, work.part(picture, wanted), grid=grid, **how)
    return np.ascontiguousarray(lines[:, region.slices[1]])


@picture_step(linear=_lag_filter)
@in_parts(_scanned_part, lambda region, shape: region.rows / shape[0])
def lagged_lines(work: Work, picture: Array, **how: Any) -> Array:
    """The picture with the lag along a scan."""
    return filter_lines(work, picture, **how)


@dataclass(frozen=True)
class FrameLag(Linear):
    """A weighted sum over frames: noise that is new in each is averaged, all else stays."""

    weights: tuple[float, ...]

    def carried(self, work: Work, power: NoisePower, *, temporal: bool) -> NoisePower | None:
        """Temporal noise by the root of the sum of squares of the weights."""
        if not temporal:
            return power
        return power.scaled(float(np.linalg.norm(self.weights)))


def _frame_lag(*frames: Recipe, weights: tuple[float, ...]) -> Linear:
    return FrameLag(weights)


@picture_step(linear=_frame_lag)
@pointwise
def lagged_frames(work: Work, picture: Array, *before: Array, weights: tuple[float, ...]) -> Array:
    """The frame and those before it, the latest first."""
    total = np.multiply(picture, picture.dtype.type(weights[0]))
    for frame, weight in zip(before, weights[1:], strict=True):
        total += frame * frame.dtype.type(weight)
    return np.asarray(total)


def _patterns(
    at: AtStep, picture: Recipe, *_: Recipe, response: float, offset: float
) -> list[Noise]:
    noises = []
    if response:
        seen = np.asarray(at.work.value(picture), np.float64)
        level = np.float64(seen.mean()) if at.uniform else seen
        noises.append(at.white("response", (response * level) ** 2, temporal=False))
    if offset:
        noises.append(at.white("offset", offset**2, temporal=False))
    return noises


@picture_step(noise=_patterns, looks_at=("picture",))
@pointwise
def with_pattern_of_pixels(
    work: Work, picture: Array, *deviates: Array, response: float, offset: float
) -> Array:
    """Unlike responses and offsets of pixels, the same in every frame."""
    number, made = picture.dtype.type, picture.copy()
    if response:
        made *= deviates[0] * number(response) + number(1.0)
    if offset:
        made += deviates[-1] * number(offset)
    return made


def _temporal(at: AtStep, picture: Recipe, *_: Recipe, white: float, flicker: float) -> list[Noise]:
    noises = [at.white("NETD", white**2)] if white else []
    return [*noises, at.white("1/f", flicker**2)] if flicker else noises


@picture_step(noise=_temporal)
@pointwise
def with_temporal_noise(
    work: Work, picture: Array, *deviates: Array, white: float, flicker: float
) -> Array:
    """With white noise, and 1/f noise of each pixel."""
    number, made = picture.dtype.type, picture.copy()
    if white:
        made += deviates[0] * number(white)
    if flicker:
        made += deviates[-1] * number(flicker)
    return made


@ends_lineage
@pointwise
def less(work: Work, picture: Array, other: Array) -> Array:
    """What is added to a picture."""
    return np.asarray(picture - other)


@in_blocks()
@ends_lineage
def figures(
    work: Work,
    picture: Array,
    *,
    band: tuple[float, float],
    white: float,
    flicker: float,
    response: float,
    offset: float,
    kept: float,
) -> TableData:
    """Figures at the mean of the picture."""
    mean = float(np.mean(picture, dtype=np.float64))
    kelvin = slope = None
    if mean > 0.0:
        kelvin = float(brightness_temperature(radiance=mean, cut_on_um=band[0], cut_off_um=band[1]))
        slope = float(
            band_radiance_derivative(cut_on_um=band[0], cut_off_um=band[1], temperature_K=kelvin)
        )
    temporal, pattern = float(np.hypot(white, flicker)), float(np.hypot(response * mean, offset))

    def in_kelvin(noise: float) -> float | None:
        return noise / slope if slope else None

    rows = (
        ("netd_K", in_kelvin(temporal), "K", "temporal noise as a temperature difference"),
        ("white_netd_K", in_kelvin(white), "K", "white noise alone"),
        ("flicker_K", in_kelvin(flicker), "K", "1/f noise alone"),
        ("fixed_pattern_K", in_kelvin(pattern), "K", "unlike responses and offsets of pixels"),
        ("noise_radiance", temporal, "W/m²/sr", "temporal noise as radiance of the scene"),
        ("snr", mean / temporal if temporal else None, "", "mean over temporal noise"),
        ("scene_K", kelvin, "K", "brightness temperature of the mean"),
        ("lag_percent", 100.0 * kept, "%", "share of a change that is left after a frame"),
    )
    return TableData(tuple(TableRow(*row) for row in rows))
