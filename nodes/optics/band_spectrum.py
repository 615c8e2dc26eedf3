"""By what light a band's wavelengths are weighted, where no spectrum is on the wire."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Magnitude
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.modules.caution import Caution
from core.physics.electrons.photon_conversion import SHORTEST_THERMAL_UM
from core.physics.radiometry.planck import brightness_temperature
from core.physics.radiometry.sunlight import SUNLIGHT_K
from core.spectrum.band_stack import BandStack, Row
from nodes.shared.shared_warnings import Band, is_radiance

_KELVIN = ("K", "kelvin")


def source_temperature(
    source_K: float | None, magnitude: Magnitude, band: Band, node: str
) -> float | Recipe:
    """Temperature of the black body whose light weights the band, or a recipe of it.

    `source_K` where it is given; below 2.5 µm sunlight's 5800 K; else that of the black body which
    gives the picture's mean radiance, or its mean where the picture is in kelvin.

    Raises
    ------
    ParameterError
        For a thermal band without a picture, or of one that is neither radiance nor kelvin.
    """
    if source_K is not None:
        return source_K
    if band[0] < SHORTEST_THERMAL_UM:
        return SUNLIGHT_K
    image = magnitude.image
    if image is None:
        raise ParameterError(
            "source_K", None, "a temperature, as no picture comes in whose mean would give one",
            unit="K",
        )  # fmt: skip
    if image.unit.strip() in _KELVIN:
        return Step.of(mean_kelvin, image.recipe, node=node)
    if not is_radiance(image.unit):
        raise ParameterError(
            "source_K",
            None,
            f"a temperature, as the picture in {image.unit or 'no unit'!r:.40} is no radiance in "
            "W/m²/sr, or weighting uniform",
            unit="K",
        )
    # Of the picture's own band, whose radiance it holds.
    low, high = image.band_um or band
    return Step.of(mean_brightness, image.recipe, node=node, cut_on_um=low, cut_off_um=high)


@ends_lineage
def mean_kelvin(work: Work, samples: NDArray[Any]) -> float:
    """Mean of a picture in kelvin."""
    mean = float(np.mean(samples, dtype=np.float64))
    if not (math.isfinite(mean) and mean > 0.0):
        raise DataError(f"a picture of mean {mean:g} K has no light: give source_K")
    return mean


@ends_lineage
def mean_brightness(
    work: Work, samples: NDArray[Any], *, cut_on_um: float, cut_off_um: float
) -> float:
    """Temperature of the black body of a picture's mean radiance."""
    mean = float(np.mean(samples, dtype=np.float64))
    if not (math.isfinite(mean) and mean > 0.0):
        raise DataError(
            f"a picture of mean radiance {mean:g} has no brightness temperature: give source_K, or "
            "weighting uniform"
        )
    band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    return float(brightness_temperature(radiance=mean, **band))


@ends_lineage
def number(work: Work, *, value: float) -> float:
    """A number as a value of its own."""
    return value


def photon_weights(bands: BandStack, weighting: str) -> Row:
    """Weights of a picture's bands: by their photons, or their energy."""
    if weighting == "energy":
        return bands.whole
    return tuple(w * c for w, c in zip(bands.whole, bands.centres_um, strict=True))


def kelvin_caution(magnitude: Magnitude, band: Band, source_K: float | None) -> Caution | None:
    """A picture in kelvin, whose mean weights the band while its samples are filtered."""
    image = magnitude.image
    if image is None or source_K is not None or band[0] < SHORTEST_THERMAL_UM:
        return None
    if image.unit.strip() not in _KELVIN:
        return None
    return Caution(
        "the picture is in kelvin: its mean weights the band, and temperatures are blurred as if "
        "they were radiance",
        "take To Radiance before Init & Trans",
    )
