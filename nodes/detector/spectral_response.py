"""Spectral Response: what a detector or a filter lets count of every wavelength."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.chain.band_stack import AttenuatedBands, BandStack, Row
from core.chain.engine import PlannedNode
from core.chain.step_lineage import LevelChange, picture_step
from core.chain.wires import Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.modules.preview import Axis, Curve, Mark, Plot, Preview, brief
from core.physics.detector.detectivity import ResponseCurve
from core.physics.detector.photon_conversion import (
    SHORTEST_THERMAL_UM,
    QuantumEfficiency,
)
from core.physics.radiometry.planck import PHOTON_ENERGY_J_UM, brightness_temperature
from core.physics.radiometry.spectra import SUNLIGHT_K
from nodes.files.curve_tables import read_wavelengths
from nodes.shared.context_defaults import Band, unit_warning
from nodes.shared.module_ports import ImageOutput, WeightingSource
from nodes.shared.steps import AboutMean, mean_of


class SpectralResponse(
    Module, key="spectral_response", title="Spectral Response", group="Detector"
):
    """Weight every wavelength by the response of a detector material, a filter or a window.

    Each band of a spectral picture is multiplied by the mean response in that band. A Focal Plane
    after this module counts the remaining photons; its NETD refers to the scene before the response
    is applied. The response weights only light from the scene, not radiation from optics and
    housing. A picture with one band is multiplied by the mean response over the band, weighted by
    the radiance of a black body. The temperature of the black body is `source_K`. If `source_K` is
    empty, the temperature is 5800 K (sunlight) for a band that begins below 2.5 µm, and otherwise
    the picture's mean brightness temperature. `file`: a CSV file of wavelength (µm) and response,
    interpolated linearly and 0 outside its points. `gaussian`: `width_um` is the full width at half
    maximum. Enter a response per watt here, without conversion. Enter a response per photon as
    `response` in Focal Plane.
    """

    formulas = (
        Formula(
            r"L'_b=L_b\,\overline{R}_b,\quad\overline{R}_b=\frac{1}{\Delta\lambda_b}\int_b R("
            r"\lambda)\,d\lambda",
            where="R: the response; b: a band",
            when="a picture in bands",
        ),
        Formula(
            r"L'=L\;\frac{\int R\,L_B(\lambda,T)\,d\lambda}{\int L_B(\lambda,T)\,d\lambda}",
            where="L_B: spectrum of a black body at source_K; if source_K is empty, at the mean "
            "brightness temperature, or at 5800 K (sunlight) for a band that begins below 2.5 µm",
            when="a picture of one band",
        ),
    )

    shape: Literal["file", "rectangle", "gaussian"] = param(
        "rectangle", "shape of the spectral response; file: read from the CSV file in path"
    )
    path: Path | None = param(None, "CSV file of wavelength (µm) and response (0 to 1)")
    centre_um: float | None = param(
        None,
        "centre wavelength of the response; empty: the middle of the picture's band",
        (0, 1000),
        slider=(0.4, 14),
    )
    width_um: float | None = param(
        None,
        "width of the response (Gaussian: full width at half maximum); empty: the picture's band",
        (0, 1000),
        slider=(0.01, 5),
    )
    peak: float = param(1.0, "largest response", (0, 1))
    source_K: WeightingSource = None

    panel = (
        Section("", "shape"),
        Section("File", "path", shown_when=("shape", ("file",))),
        Section("Form", "centre_um width_um peak", shown_when=("shape", ("rectangle", "gaussian"))),
        Section("Band", "source_K"),
    )

    def check(self) -> None:
        if self.shape == "file" and self.path is None:
            raise ParameterError("path", None, "give a CSV file of wavelength (µm) and response")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        node, band = here.node, image.band_um
        if band is None:
            raise DataError(
                "the image has no band to apply the response to: set cut_on_um and cut_off_um on "
                "Read Image"
            )
        response = self.response(band, here)
        if response.is_one_over(*band):
            return ImageOutput(image)
        if not response.integral(*band) > 0.0:
            low, high = response.ends_um
            allowed = (
                f"the response, {low:g} to {high:g} µm, must be above 0 within the picture's band, "
                f"{band[0]:g} to {band[1]:g} µm"
            )
            if self.shape == "file":
                raise ParameterError("path", str(self.path), allowed)
            raise ParameterError("centre_um", self.centre_um, allowed)
        passed = (*image.responses, response)
        if image.bands is not None:
            pairs = zip(image.bands.centres_um, image.bands.widths_um, strict=True)
            gain = tuple(response.mean(c - w / 2, c + w / 2) for c, w in pairs)
            stack = AttenuatedBands.of(image.bands, gain=gain, node=node)
            made = stack.picture(stack.whole)
            return ImageOutput(image.with_recipe(made, bands=stack, responses=passed))
        source = self.source_K
        if source is None and band[0] < SHORTEST_THERMAL_UM:
            source = SUNLIGHT_K
        counted = here.step(
            mean_response, image.recipe, response=response, band_um=band, source_K=source
        )
        dimmed = here.step(weighted, image.recipe, counted)
        return ImageOutput(image.with_recipe(dimmed, responses=passed))

    def response(self, band: Band, here: NodeContext) -> ResponseCurve:
        """The response as the parameters have it; a middle and width left empty are the band's."""
        if self.shape != "file":
            centre = self.centre_um or sum(band) / 2
            return ResponseCurve(self.shape, centre, self.width_um or band[1] - band[0], self.peak)
        assert self.path is not None
        points = read_wavelengths(here.folder / self.path, what="response", low=0.0, high=1.0)
        return ResponseCurve("file", points=points)

    def response_over_band(self, planned: PlannedNode, here: NodeContext) -> DrawnResponse | None:
        band = planned.inputs["image"].band_um
        if band is None:
            return None
        curve = self.response(band, here)
        knots = [place for place, _ in curve.points] or list(curve.ends_um)
        return drawn_response("response", band, band, knots, curve)

    def preview(self, planned: PlannedNode, work: Work, here: NodeContext) -> Preview | None:
        response = self.response_over_band(planned.sound(), here)
        if response is None:
            return None
        return response_preview(response, planned.inputs["image"], work)

    unit = unit_warning("weighting over wavelength")

    @warning
    def source(self, image: Image) -> Caution | None:
        """A source temperature is given but not used: the picture has several bands."""
        if self.source_K is None or image.bands is None:
            return None
        return Caution(
            f"source_K = {self.source_K:g} K is not used: the picture has {image.bands.count} "
            "bands, each with its own response",
            "leave source_K empty",
        )

    @readout()
    def mean_of_band(self, image: Image, outputs: ImageOutput) -> Recipe | float:
        """Mean response over the picture's band, weighted by the spectrum of the light."""
        made = outputs.image.recipe
        if made is image.recipe:
            return 1.0
        if image.bands is None:
            assert isinstance(made, Step)
            return made.inputs[1]
        assert isinstance(outputs.image.bands, AttenuatedBands)
        light: Any = {"weights": image.bands.whole, "gain": outputs.image.bands.gain}
        return Step.of(_share, image.bands.means(), **light)


def mean_response(
    work: Work, samples: Array, *, response: ResponseCurve, band_um: Band, source_K: float | None
) -> float:
    low, high = band_um
    if source_K is None:
        mean = float(np.mean(samples, dtype=np.float64))
        if not mean > 0.0:
            raise DataError(
                f"a picture with mean {mean:g} has no brightness temperature, which is needed to "
                "weight the response: give source_K"
            )
        source_K = float(brightness_temperature(radiance=mean, cut_on_um=low, cut_off_um=high))
    return response.mean_of_body(low, high, source_K=source_K)


@picture_step(
    linear=lambda image, counted: AboutMean(Step.of(_level, Step.of(mean_of, image), counted))
)
@pointwise
def weighted(work: Work, image: Array, counted: float) -> Array:
    return np.multiply(image, work.policy.dtype.type(counted), dtype=work.policy.dtype)


def _level(work: Work, mean: float, counted: float) -> LevelChange:
    return LevelChange(counted, mean, counted * mean)


def _share(
    work: Work, means: Array, *, weights: tuple[float, ...], gain: tuple[float, ...]
) -> float | None:
    light = np.maximum(means * np.array(weights), 0.0)
    total = float(light.sum())
    return float(light @ np.array(gain)) / total if total > 0.0 else None


# A response over wavelength as it is drawn, over the mean spectrum of the picture it is for.

_POINTS = 241
_BESIDE = 1e-9  # of a wavelength, on both sides of where a response may jump
_ROOM = 1.12  # above a response of 1 stands what the spectrum's peak is
_HIGHEST = 0.9  # share of the axis that the spectrum's peak takes
_WIDER = 0.03  # of the band, on both sides

DrawnResponse = tuple[str, Band, Array, Array]
"""What is drawn, the wavelengths shown (the picture's band, the response beside it), the curve."""


def drawn_response(
    name: str, band: Band, own: Band, knots: list[float], response: Any
) -> DrawnResponse:
    """The curve of a response between `own` ends that jumps or bends at `knots`."""
    low, high = min(band[0], own[0]), max(band[1], own[1])
    ends = np.array([*own, *knots])
    ends = ends[(ends >= low) & (ends <= high)]
    beside = np.concatenate([ends * (1 - _BESIDE), ends, ends * (1 + _BESIDE)])
    places = np.unique(np.concatenate([np.linspace(low, high, _POINTS), beside]))
    return name, (low, high), places, np.asarray(response.at(places))


def response_preview(response: DrawnResponse, image: Image, work: Work) -> Preview:
    name, (low, high), wavelength_um, values = response
    curves = [Curve(wavelength_um, values, name="response", width=2.0)]
    marks: tuple[Mark, ...] = ()
    lit = wavelength_um[values > 0.0]
    words = f"{name} 0"
    if len(lit):
        most, ends = float(values.max()), f"from {brief(lit[0])} to {brief(lit[-1])} µm"
        words = f"{name} up to {brief(most)} {ends}"
    if image.bands is not None:
        unit = f"{image.unit}/µm" if image.bands.density else image.unit
        means = np.asarray(work.value(image.bands.means()), np.float64)
        where = int(means.argmax())
        centres, peak = np.array(image.bands.centres_um), means[where]
        highest = f"{brief(peak)} {unit}".rstrip()
        words += (
            f"; mean spectrum of {len(means)} bands, highest at {brief(centres[where])} µm: "
            f"{highest}"
        )
        if peak > 0.0:
            heights = means * (_HIGHEST / peak)
            curves.append(Curve(centres, heights, 1, name="scene", fill="below"))
            marks = (Mark(centres[where], _HIGHEST, highest, 1),)
    beside = _WIDER * (high - low)
    across = Axis(low - beside, high + beside, "wavelength (µm)")
    along = Axis(0.0, _ROOM, name, reach=1.0)
    return Preview(words, (Plot(across, along, tuple(curves), marks),))


# Focal Plane on a picture in bands: the photons of each that the detector counts.

_TOUCHING = 1e-9  # of the wavelength


def counted_weights(bands: BandStack, efficiency: QuantumEfficiency) -> Row:
    """Weights that make counted photons, s⁻¹ m⁻² sr⁻¹, of radiances per µm.

    λ_b/(hc)·∫ QE dλ over the part of each band that the filter lets through: the radiance of a band
    is the same all over it, and so is the energy of its photons.
    """
    if not bands.density:
        raise DataError(
            "photons cannot be counted: the picture's bands are not in radiance per µm; set the "
            "unit on Read Image"
        )
    weights = tuple(
        centre / PHOTON_ENERGY_J_UM * efficiency.integral(centre - width / 2, centre + width / 2)
        for centre, width in zip(bands.centres_um, bands.widths_um, strict=True)
    )
    if not any(weights):
        low, high = bands.band_um
        allowed = f"the filter must pass some of the picture's bands, {low:g} to {high:g} µm"
        raise ParameterError("cut_on_um", efficiency.cut_on_um, allowed)
    return weights


def lit_windows(bands: BandStack) -> tuple[tuple[float, float], ...]:
    """Parts of a picture's band in which its bands lie; none where they touch all over it."""
    pairs = zip(bands.centres_um, bands.widths_um, strict=True)
    ends = sorted((centre - width / 2, centre + width / 2) for centre, width in pairs)
    windows = [ends[0]]
    for low, high in ends[1:]:
        if abs(low - windows[-1][1]) <= _TOUCHING * low:
            windows[-1] = windows[-1][0], high
        else:
            windows.append((low, high))
    return tuple(windows) if len(windows) > 1 else ()


def counted_photons(image: Image, efficiency: QuantumEfficiency) -> Recipe:
    assert image.bands is not None
    return image.bands.picture(counted_weights(image.bands, efficiency))


def radiance_per_photon(image: Image, efficiency: QuantumEfficiency, node: str) -> Recipe:
    bands = image.bands
    assert bands is not None
    weights = counted_weights(bands, efficiency)
    return Step.of(_ratio, bands.means(), node=node, radiance=bands.whole, photons=weights)


def _ratio(work: Work, means: NDArray[Any], *, radiance: Row, photons: Row) -> float:
    counted = float(np.dot(means, photons))
    if not counted > 0.0:
        raise DataError(
            "the picture has no light in the bands to which the detector responds; check "
            "cut_on_um, cut_off_um and the response"
        )
    return float(np.dot(means, radiance)) / counted
