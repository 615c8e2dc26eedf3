"""By what light a band's wavelengths are weighted, where no spectrum is on the wire."""

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from core.chain.band_stack import BandStack, Row, over_bands
from core.chain.wires import Magnitude
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Caution, Param, warning
from core.physics.detector.detectivity import ResponseCurve
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM
from core.physics.radiometry.planck import brightness_temperature
from core.physics.radiometry.spectra import SUNLIGHT_K
from core.records import replace
from core.transfer.factors import Planar, WavelengthLaw
from nodes.files.curve_tables import read_wavelengths
from nodes.shared.context_defaults import Band, is_radiance

Responses = tuple[ResponseCurve, ...]
DetectorResponse = Annotated[
    Path | None,
    Param(
        "CSV file of wavelength (µm) and detector response, which also weights the light; "
        "empty: equal at all wavelengths"
    ),
]
_KELVIN = ("K", "kelvin")


def weighting_responses(
    path: Path | None, folder: Path, magnitude: Magnitude | None, weighting: str
) -> Responses:
    """Filters before and the detector behind weight the light; uniform, the detector alone."""
    before: Responses = ()
    if magnitude is not None and magnitude.image is not None and weighting != "uniform":
        before = magnitude.image.responses
    if path is None:
        return before
    points = read_wavelengths(folder / path, what="response", low=0.0, high=1.0)
    return (*before, ResponseCurve("file", points=points))


def source_temperature(
    source_K: float | None, magnitude: Magnitude, band: Band, node: str
) -> float | Recipe:
    """Temperature of the black body whose light weights the band, or a recipe of it.

    `source_K` where it is given; below 2.5 µm sunlight's 5800 K; else that of the black body which
    gives the picture's mean radiance, or its mean where the picture is in kelvin.
    """
    if source_K is not None:
        return source_K
    if band[0] < SHORTEST_THERMAL_UM:
        return SUNLIGHT_K
    image = magnitude.image
    if image is None:
        allowed = "there is no picture to derive the temperature from; give a value"
        raise ParameterError("source_K", None, allowed)
    if image.unit.strip() in _KELVIN:
        return Step.of(mean_kelvin, image.recipe, node=node)
    if not is_radiance(image.unit):
        allowed = (
            f"the picture's unit is {image.unit or 'unknown'!r:.40}, not W/m²/sr; set weighting to "
            "uniform, or give a temperature"
        )
        raise ParameterError("source_K", None, allowed)
    # Of the picture's own band, whose radiance it holds.
    low, high = image.band_um or band
    return Step.of(mean_brightness, image.recipe, node=node, cut_on_um=low, cut_off_um=high)


@in_blocks()
def mean_kelvin(work: Work, samples: NDArray[Any]) -> float:
    mean = float(np.mean(samples, dtype=np.float64))
    if not (math.isfinite(mean) and mean > 0.0):
        raise DataError(f"a picture with a mean of {mean:g} K emits no light: give source_K")
    return mean


@in_blocks()
def mean_brightness(
    work: Work, samples: NDArray[Any], *, cut_on_um: float, cut_off_um: float
) -> float:
    mean = float(np.mean(samples, dtype=np.float64))
    if not (math.isfinite(mean) and mean > 0.0):
        raise DataError(
            f"a picture with mean radiance {mean:g} has no brightness temperature: give "
            "source_K, or set weighting to uniform"
        )
    band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
    return float(brightness_temperature(radiance=mean, **band))


def photon_weights(bands: BandStack, weighting: str, detector: Responses = ()) -> Row:
    """Weights of a picture's bands: by their photons, or their energy, and what is detected."""
    weights = bands.whole
    if weighting != "energy":
        weights = tuple(w * c for w, c in zip(weights, bands.centres_um, strict=True))
    for response in detector:
        pairs = zip(bands.centres_um, bands.widths_um, strict=True)
        passed = (response.mean(c - w / 2, c + w / 2) for c, w in pairs)
        weights = tuple(weight * share for weight, share in zip(weights, passed, strict=True))
    return weights


def at_each_band(
    factor: Planar, law: WavelengthLaw, bands: BandStack, weighting: str, detector: Responses = ()
) -> Planar:
    """Each band of the picture at its own wavelength; the mean is weighted by their light."""
    factor = replace(factor, by_wavelength=law)
    weights = photon_weights(bands, weighting, detector)
    return over_bands(factor, bands, weights)


def kelvin_caution(magnitude: Magnitude, band: Band, source_K: float | None) -> Caution | None:
    """A picture in kelvin, whose mean weights the band while its samples are filtered."""
    image = magnitude.image
    if image is None or source_K is not None or band[0] < SHORTEST_THERMAL_UM:
        return None
    if image.unit.strip() not in _KELVIN:
        return None
    return Caution(
        "temperatures are blurred as if they were radiance: the picture is in kelvin, and its "
        "mean temperature weights the band",
        "put To Radiance before Init & Trans",
    )


@warning
def response_warning(module: Any) -> Caution | None:
    """A response is entered, but it has no effect with a single wavelength."""
    if module.response is None or module.wavelengths != 1:
        return None
    return Caution(
        "the response is not used: a single wavelength represents the band", "use more wavelengths"
    )
