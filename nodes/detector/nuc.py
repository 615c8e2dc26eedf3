"""Non-Uniformity Correction: a camera's fixed pattern taken out by uniform references."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, NamedTuple

import numpy as np

from core.arrays import Array
from core.chain.noise_power import NoisePower
from core.chain.random_fields import Remaking
from core.chain.step_lineage import AtStep, Lineage, Noise, lineage_of, picture_step
from core.chain.wires import Image, Table, TableData, TableRow
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, warning
from core.physics.detector import focal_plane_array
from core.physics.radiometry.planck import band_radiance
from nodes.shared.deviates import SEED_SECTIONS, SeededModule
from nodes.shared.module_ports import TableFigures
from nodes.shared.steps import Carried, OverFrames, even


class CorrectedOutputs(NamedTuple):
    image: Image
    gain: Image
    offset: Image
    table: Table


class Nuc(SeededModule, key="nuc", title="Non-Uniformity Correction", group="Detector"):
    """Correct pixel non-uniformity with uniform references at one or two temperatures.

    Put this module after the camera's modules. A black body that fills the field of view replaces
    the input of the first module that adds noise. The picture of the black body is averaged over
    `reference_frames` frames, each with its own noise; the same average corrects every frame.
    `one_point`: the pattern at `low_K` is subtracted; the residual grows with the scene's
    temperature difference from `low_K`, because the gains differ. `two_point`: gain and offset come
    from a straight line through both references; the residual comes from the noise of the averaged
    references and from nonlinearity. `drift_K` adds the offset drift since the correction: the rms
    over the pixels, expressed as a scene temperature. A pixel with less than a tenth of the mean
    response gets a gain of 1. The frames of a reference share their 1/f noise, but budgets treat
    this noise as independent from frame to frame. Sources: Perry and Dereniak 1993; Schulz and
    Caldwell 1995; Holst 2008.
    """

    formulas = (
        Formula(
            r"L'_i=L_i+\overline{R}_1-R_{1,i}",
            where=(
                "R₁: response of the pixels to the reference at low_K; the bar marks the mean "
                "over the pixels"
            ),
            when="one_point",
        ),
        Formula(
            r"L'_i=g_i\,L_i+\overline{R}_1-g_i\,R_{1,i},\quad g_i=\frac{\overline{R}_2-"
            r"\overline{R}_1}{R_{2,i}-R_{1,i}}",
            where="R₂: response of the pixels to the reference at high_K",
            when="two_point",
        ),
    )

    method: Literal["none", "one_point", "two_point"] = param(
        "two_point", "number of reference sources: none, one or two"
    )
    low_K: float = param(
        290.0,
        "temperature of the reference, or of the cooler one if there are two",
        (1, 1e4),
        slider=(260, 340),
    )
    high_K: float = param(310.0, "temperature of the warmer reference", (1, 1e4), slider=(260, 340))
    reference_frames: int = param(
        16, "number of reference frames averaged", (1, 100000), slider=(1, 64)
    )
    drift_K: float = param(
        0.0,
        "offset drift since the correction: rms over the pixels, as a scene temperature",
        (0, 1e4),
        slider=(0, 1),
    )

    panel = (
        Section("", "method"),
        Section(
            "References",
            "low_K high_K reference_frames",
            shown_when=("method", ("one_point", "two_point")),
        ),
        Section(
            "Since the correction", "drift_K", shown_when=("method", ("one_point", "two_point"))
        ),
        *SEED_SECTIONS,
    )

    def check(self) -> None:
        if self.method != "none" and self.high_K <= self.low_K:
            raise ParameterError("high_K", self.high_K, f"above low_K = {self.low_K:g}")

    def run(self, image: Image, here: NodeContext) -> CorrectedOutputs:
        seen = seen_by_camera(image.recipe)
        if self.method == "none" or seen is None:
            gain, offset = (here.step(even, shape=image.shape, value=value) for value in (1.0, 0.0))
            table = Table(here.step(no_figures))
            return CorrectedOutputs(
                image, image.with_recipe(gain, unit=""), image.with_recipe(offset), table
            )
        band = image.band_um
        if band is None:
            raise DataError(
                "the radiance of the references is unknown, because the picture has no band; set "
                "cut_on_um and cut_off_um on Read Image"
            )
        two, frames = self.method == "two_point", self.reference_frames

        def reference(kelvin: float, turn: int) -> OverFrames:
            """What the camera gives of a uniform radiance in the place of what it has seen."""
            ends = {"cut_on_um": band[0], "cut_off_um": band[1]}
            radiance = float(band_radiance(temperature_K=kelvin, **ends))
            flat = here.step(uniform_like, seen, radiance=radiance)
            remade = Remaking(lambda part: flat if part.key == seen.key else None)
            how: Any = {"node": here.node, "words": "the mean of reference frames"}
            picture = remade.of(image.recipe)
            return OverFrames(mean_frame, picture, frames, -turn * frames, **how)

        low, high = reference(self.low_K, 1), reference(self.high_K, 2)
        gain = here.step(even, shape=image.shape, value=1.0)
        if two:
            gain = here.step(gain_map, low, high)
        offset = here.step(offset_map, low, gain, two=two)
        kelvin = self.high_K - self.low_K
        share = self.drift_K / kelvin
        if self.drift_K:
            deviates = self.deviates(here, "drift", image.shape, fixed=True)
            offset = here.step(drifted, offset, low, high, deviates, share=share)
        how = {"two": two, "frames": frames, "drift_share": share}
        made = here.step(corrected, image.recipe, gain, offset, low, high, **how)
        return CorrectedOutputs(
            image.with_recipe(made),
            image.with_recipe(gain, unit=""),
            image.with_recipe(offset),
            Table(here.step(figures, low, high, kelvin=kelvin, unit=image.unit)),
        )

    @warning
    def nothing(self, image: Image) -> Caution | None:
        """No node before this one adds a fixed pattern, so nothing is corrected."""
        if self.method == "none" or seen_by_camera(image.recipe) is not None:
            return None
        return Caution(
            "there is nothing to correct: no node before this one adds a fixed pattern",
            "move this node after the camera's modules, such as Focal Plane",
        )

    figures = TableFigures(
        ("pattern_low", None, "Rms non-uniformity at the cooler reference, uncorrected."),
        ("pattern_high", None, "Rms non-uniformity at the warmer reference, uncorrected."),
        ("response_per_kelvin", "", "Mean response between the references, in the picture's unit "
         "per kelvin."),
        ("weak_pixels", "", "Number of pixels whose response is too small to correct."),
        unit_of="image",
    )  # fmt: skip


@ends_lineage
def gain_map(work: Work, low: Array, high: Array) -> Array:
    return focal_plane_array.two_point_gain(low=low, high=high).astype(work.policy.dtype)


@ends_lineage
def offset_map(work: Work, low: Array, gain: Array, *, two: bool) -> Array:
    if two:
        return focal_plane_array.two_point_offset(low=low, gain=gain).astype(work.policy.dtype)
    return focal_plane_array.one_point_offset(low=low).astype(work.policy.dtype)


@ends_lineage
def drifted(
    work: Work, offset: Array, low: Array, high: Array, deviates: Array, *, share: float
) -> Array:
    size = share * float(np.mean(high) - np.mean(low))
    return np.asarray(offset + deviates * deviates.dtype.type(size))


def figures(work: Work, low: Array, high: Array, *, kelvin: float, unit: str) -> TableData:
    rise = float(np.mean(high) - np.mean(low))
    weak = np.count_nonzero(~((high - low) > focal_plane_array.LEAST_RESPONSE * rise))
    return Nuc.figures.table(
        ("pattern_low", float(np.std(low))),
        ("pattern_high", float(np.std(high))),
        ("response_per_kelvin", rise / kelvin, f"{unit}/K", "mean response between the references"),
        ("weak_pixels", int(weak)),
        unit=unit,
    )


def no_figures(work: Work) -> TableData:
    names = ("pattern_low", "pattern_high", "response_per_kelvin", "weak_pixels")
    return TableData(
        tuple(TableRow(name, None, "", "no reference source is used") for name in names)
    )


def _left(at: AtStep, *images: Recipe, two: bool, frames: int, drift_share: float) -> list[Noise]:
    """What the pattern on a straight line through both references leaves, and their noise."""
    picture, gain, offset, *references = images
    cool, warm = (np.asarray(at.work.value(one), np.float64) for one in references)
    start, rise = float(cool.mean()), float(warm.mean() - cool.mean())
    noises = []
    if rise:
        # As corrected: a pattern is no distance from the reference.
        seen, factor, added = (at.work.value(one) for one in (picture, gain, offset))
        samples = np.asarray(seen * factor + added, np.float64)
        place = (np.float64(samples.mean()) if at.uniform else samples) - start
        place = np.broadcast_to(place / rise, samples.shape)
        temporal = sum(noise.power.variance for noise in at.before if noise.temporal)
        of_mean = temporal / frames
        if two:
            power = of_mean * ((1.0 - place) ** 2 + place**2)
            noises.append(at.white("references", power, temporal=False))
        else:
            noises.append(at.white("reference", of_mean, temporal=False))
            differing = place * ((warm - cool) - rise)
            shown = NoisePower.of_pattern(differing)
            # The references' own noise is no difference of gains.
            whole = shown.variance
            known = max(whole - 2.0 * of_mean * float(np.mean(place**2)), 0.0)
            shown = shown.scaled((known / whole) ** 0.5) if whole else shown
            noises.append(at.coloured("gain", shown, temporal=False))
    if drift_share:
        noises.append(at.white("drift", (drift_share * rise) ** 2, temporal=False))
    return noises


@picture_step(
    linear=lambda *_, **__: Carried(fixed=None),  # what is left the step adds itself
    noise=_left,
    looks_at=("picture", "gain", "offset", "low", "high"),
    noise_free=lambda picture, *_, **__: picture,
)
@pointwise
def corrected(
    work: Work, picture: Array, gain: Array, offset: Array, low: Array, high: Array, **_: Any
) -> Array:
    return np.asarray(picture * gain + offset, work.policy.dtype)


# What a camera gives of a uniform reference: its own recipe, with the scene replaced.


def seen_by_camera(picture: Recipe) -> Recipe | None:
    """The picture that enters the first node that adds noise to samples; None without one."""
    way = list(_samples(picture))
    noisy = {step.node for step, lineage in way if lineage.noise is not None}
    entered = [lineage.picture for step, lineage in way if step.node in noisy]
    return entered[-1] if entered else None


def _samples(recipe: Recipe) -> Iterator[tuple[Recipe, Lineage]]:
    while isinstance(recipe, Step):
        lineage = lineage_of(recipe)
        if lineage is None or lineage.picture is None:
            return
        yield recipe, lineage
        recipe = lineage.picture


@in_blocks()
@ends_lineage
def uniform_like(work: Work, picture: Array, *, radiance: float) -> Array:
    uniform: Array = work.empty(picture.shape)
    uniform.fill(radiance)
    return uniform


def mean_frame(frames: Iterator[Array]) -> Array:
    total, count = np.array(next(frames), np.float64), 1
    for picture in frames:
        total, count = total + picture, count + 1
    return np.asarray(total / count)
