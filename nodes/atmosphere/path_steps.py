"""The steps of Atmospheric Path: what the path does to the band, the picture behind it, figures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.linear_change import LevelChange, Linear
from core.chain.noise_power import NoisePower
from core.chain.results import TableData, TableRow
from core.chain.step_lineage import picture_step
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, pointwise
from core.evaluation.work import Work
from core.physics.atmosphere.air_path import AirPath, PathBand
from core.physics.radiometry.planck import brightness_temperature

Array = NDArray[Any]
Band = tuple[float, float]
Row = tuple[float, ...]
_LISTED = 21  # wavelengths in the table


@in_blocks()
@ends_lineage
def scene_temperature(work: Work, samples: Array, *, factor: float, band_um: Band) -> float:
    """Brightness temperature of a picture's mean; `factor` makes W/m²/sr of its samples."""
    mean = factor * float(np.mean(samples, dtype=np.float64))
    if not (math.isfinite(mean) and mean > 0.0):
        raise DataError(
            f"a picture of mean radiance {mean:g} W/m²/sr has no brightness temperature to weight "
            "the transmission by: give source_K"
        )
    low, high = band_um
    return float(brightness_temperature(radiance=mean, cut_on_um=low, cut_off_um=high))


@ends_lineage
def path_over_band(
    work: Work, *scene_K: float, air: AirPath, band_um: Band | None, source_K: float
) -> PathBand:
    """Transmission and path radiance of the band, weighted by the scene or the source."""
    if band_um is None:  # a path that is grey and adds nothing
        return PathBand(math.exp(-float(air.depth(1.0))), 0.0)
    return air.over_band(*band_um, source_K=scene_K[0] if scene_K else source_K)


@ends_lineage
def path_over_bands(work: Work, means: Array, *, weights: Row, gain: Row, offset: Row) -> PathBand:
    """The same of a picture in bands: weighted by the light in each."""
    added = float(np.dot(weights, offset))
    if min(gain) == max(gain):
        return PathBand(gain[0], added)
    light = np.maximum(means * np.array(weights), 0.0)
    total = float(light.sum())
    if not total > 0.0:
        raise DataError("the picture has no light in its bands to weight the transmission by")
    return PathBand(min(float(light @ np.array(gain)) / total, 1.0), added)


@dataclass(frozen=True)
class ThroughAir(Linear):
    """Dimmed alike at all frequencies; what the air adds is the same all over."""

    before: Recipe
    over: Recipe

    @property
    def level(self) -> Recipe:
        """The transmission, about the mean."""
        return Step.of(dimming, Step.of(mean_radiance, self.before), self.over)

    @property
    def before_camera(self) -> bool:
        """True: behind it is the camera."""
        return True

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        """Dimmed, where the scene has any."""
        return power.scaled(work.value(self.over).transmission)


@in_blocks()
@ends_lineage
def mean_radiance(work: Work, samples: Array) -> float:
    """Mean of the picture before the path."""
    return float(np.mean(samples, dtype=np.float64))


@ends_lineage
def dimming(work: Work, mean: float, over: PathBand) -> LevelChange:
    """What is left of the scene."""
    return LevelChange(over.transmission, mean, over.transmission * mean)


def _through(image: Recipe, over: Recipe, **_: float) -> ThroughAir:
    return ThroughAir(image, over)


@picture_step(linear=_through, looks_at=("over",))
@pointwise
def through_air(work: Work, image: Array, over: PathBand, *, factor: float) -> Array:
    """τ·L + L_path; `factor` makes W/m²/sr of the samples."""
    number = work.policy.dtype.type
    made = np.multiply(image, number(over.transmission), dtype=work.policy.dtype)
    made += number(over.path_radiance / factor)
    return made


@ends_lineage
def path_table(
    work: Work,
    over: PathBand,
    *scene_K: float,
    air: AirPath,
    band_um: Band | None,
    source_K: float | None,
) -> TableData:
    """Figures of the band, then transmission and path radiance over it."""
    depth = over.optical_depth
    weighted_by = None if air.is_grey else (scene_K[0] if scene_K else source_K)
    rows = [
        TableRow("transmission", over.transmission, "", "mean over the band"),
        TableRow("path_radiance", over.path_radiance, "W/m²/sr", "added by the air, in the band"),
        TableRow(
            "optical_depth",
            depth if math.isfinite(depth) else None,
            "",
            "−ln of the transmission; none where nothing passes",
        ),
        TableRow("range_m", air.range_m, "m", "for which this holds"),
        TableRow("weighted_by_K", weighted_by, "K", "black body that weights the transmission"),
    ]
    places = np.empty(0) if band_um is None else np.linspace(*band_um, _LISTED)
    values = zip(places, np.exp(-air.depth(places)), air.added(places), strict=True)
    for place, passed, added in values:
        at = f"at {place:.4g} µm"
        rows.append(TableRow(f"transmission_{place:.6g}_um", float(passed), "", at))
        rows.append(TableRow(f"path_radiance_{place:.6g}_um", float(added), "W/m²/sr/µm", at))
    return TableData(tuple(rows))
